#pragma once

#include "hwsim/box_unit.h"
#include "hwsim/pair_unit.h"

namespace hwsim {

/// What a thread is about to do, or waits for.
enum class Phase : uint8_t {
    idle,
    divide,    // decide what of the pair is divided
    open,      // read the node: needs the node cache
    test,      // needs the box unit
    tested,    // waits for the box unit
    pop,       // take the next pair from the stack
    take_tool, // read a line of the tool's leaf: needs the record cache
    take_work, // and one of the work's
    compare,   // needs the pair unit
    drain,     // waits for the last pairs
    ask,       // needs the element's port to the memory
    wait,      // for the memory
    done,      // waits until everything before it is retired
};

/// One search of a processing element, as far as it has come. All of it is registers, but for the
/// stack, which is a memory.
struct SearchThread {
    Phase phase = Phase::idle;
    Phase after_line = Phase::idle; // open, take_tool or take_work: what a line is read for
    uint8_t stack_size = 0;
    uint8_t tool_line = 0, work_line = 0; // of the leaves, from 0
    uint8_t tool_place = 0, work_place = 0;
    uint8_t in_pair_unit = 0;
    Division division = Division::none;
    uint64_t started = 0; // cycle
    Query query;
    Answer answer;
    SearchPair pair;
    Halves halves;
    Records tools{}, works{};
    FixedVec offset{};
    std::array<SearchPair, 64> stack{};

    bool operator==(const SearchThread&) const = default;
};

void start(SearchThread& thread, const Query& query, uint64_t cycle);

/// The line that the thread wants to read, in phases open, take_tool and take_work.
uint32_t wanted_line(const SearchThread& thread);

/// Whether a line is of the work's model, else the tool's.
bool wants_work(const SearchThread& thread);

/// Decides what comes next for the thread's pair.
void divide(SearchThread& thread, uint64_t cycle, uint32_t search_limit);

/// Goes on with the line that it wanted.
void take_line(SearchThread& thread, const Line& line);

/// Goes on with what the box unit found.
void take_tests(SearchThread& thread, const BoxUnit::Output& tests, uint32_t stack_depth);

/// Takes the next pair from the stack; done when there is none.
void pop(SearchThread& thread);

/// The pair of records that goes into the pair unit next. Moves on to the one after it.
PairUnit::Output next_records(SearchThread& thread, uint8_t number);

/// Takes what the pair unit found.
void take_distance(SearchThread& thread, const PairUnit::Output& distance);

/// Ends the search without an answer.
void stop(SearchThread& thread, Stop reason, uint32_t line);

} // namespace hwsim
