#pragma once

#include <vector>

#include "hwsim/memory_line.h"
#include "hwsim/memory_unit.h"
#include "hwsim/search.h"

namespace hwsim {

/// A direct-mapped cache of lines whose check words were verified.
struct LineCache {
    struct Entry {
        bool valid = false;
        uint32_t address = 0;
        Line line;
        bool operator==(const Entry&) const = default;
    };
    std::vector<Entry> entries; // a power of two

    bool operator==(const LineCache&) const = default;
};

inline LineCache::Entry& entry_of(LineCache& cache, uint32_t address) {
    return cache.entries[address & (cache.entries.size() - 1)];
}

/// The line, or null if it is not in the cache.
inline const Line* cached_line(LineCache& cache, uint32_t address) {
    const LineCache::Entry& entry = entry_of(cache, address);
    return entry.valid && entry.address == address ? &entry.line : nullptr;
}

inline void fill(LineCache& cache, uint32_t address, const Line& line) {
    entry_of(cache, address) = {true, address, line};
}

/// The line in memory has changed.
inline void invalidate(LineCache& cache, uint32_t address) {
    LineCache::Entry& entry = entry_of(cache, address);
    if (entry.address == address) entry.valid = false;
}

/// Tests both halves of a division: swept volume against box, twice, as a pipeline.
///
/// Latency:    15 cycles: the offsets, then as in the pair unit, with the same arithmetic.
/// Throughput: one division a cycle, no stall.
struct BoxUnit {
    static constexpr uint32_t latency = 15;

    struct Output {
        bool valid = false;
        uint8_t thread = 0;
        std::array<bool, 2> in_range{};
        std::array<uint64_t, 2> squared{};
        bool operator==(const Output&) const = default;
    };
    /// The halves stay with their thread; only results travel. Stages rotate instead of their
    /// contents: `next` is where an input enters and the oldest result leaves.
    std::array<Output, latency> stage{};
    uint32_t next = 0;

    const Output& output() const { return stage[next]; }
    bool operator==(const BoxUnit&) const = default;
};

/// The input of the first stage: both halves, either of which may be missing.
BoxUnit::Output box_question(uint8_t thread, const SplitPairs& halves, const Segment& segment);

/// One rising clock edge.
void tick(BoxUnit& unit, const BoxUnit::Output& in);

/// The squared distance of two records, as a pipeline.
///
/// Latency:    14 cycles: gaps, squares, 9 of the root (3 bits each), less the radius, squares,
/// sum. Throughput: one pair a cycle, no stall.
struct PairUnit {
    static constexpr size_t latency = 14;

    struct Output {
        bool valid = false;
        uint8_t thread = 0;
        uint32_t tool_record = 0, work_record = 0;
        uint64_t squared = 0;
        bool operator==(const Output&) const = default;
    };
    /// Stages rotate instead of their contents: `next` is where the next pair enters and the oldest
    /// leaves.
    std::array<Output, latency> stage{};
    uint32_t next = 0;

    const Output& output() const { return stage[next]; }
    bool operator==(const PairUnit&) const = default;
};

/// One rising clock edge.
void tick(PairUnit& unit, const PairUnit::Output& in);

/// What a thread does next, or waits for.
enum class Phase : uint8_t {
    idle,
    divide,    // select the part of the pair to divide
    open,      // read the node: needs the node cache
    test,      // needs the box unit
    tested,    // waits for the box unit
    pop,       // take the next pair from the stack
    take_tool, // read a line of the tool's leaf: needs the record cache
    take_work, // read a line of the work's leaf
    compare,   // needs the pair unit
    drain,     // waits for the last pairs
    ask,       // needs the element's port to the memory
    wait,      // for the memory
    done,      // waits until everything before it is retired
};

/// One search of a processing element. All of it is registers, except the stack, which is a memory.
struct SearchThread {
    Phase phase = Phase::idle;
    Phase after_line = Phase::idle; // open, take_tool or take_work: the purpose of reading a line
    uint8_t stack_size = 0;
    uint8_t tool_line = 0, work_line = 0; // of the leaves, from 0
    uint8_t tool_record_index = 0, work_record_index = 0;
    uint8_t in_pair_unit = 0;
    Division division = Division::none;
    uint64_t started = 0; // cycle
    Query query;
    Answer answer;
    SearchPair pair;
    SplitPairs halves;
    Records tools{}, works{};
    FixedVec offset{};
    std::array<SearchPair, 64> stack{};

    bool operator==(const SearchThread&) const = default;
};

void start(SearchThread& thread, const Query& query, uint64_t cycle);

/// The line that the thread reads in phases open, take_tool and take_work.
uint32_t requested_line(const SearchThread& thread);

/// Whether that line belongs to the work model, else to the tool model.
bool needs_work(const SearchThread& thread);

/// Decides the next step for the pair of the thread.
void divide(SearchThread& thread, uint64_t cycle, uint32_t search_limit);

/// Continues with the line that was read.
void accept_line(SearchThread& thread, const Line& line);

/// Continues with the result of the box unit.
void accept_tests(SearchThread& thread, const BoxUnit::Output& tests, uint32_t stack_depth);

/// Takes the next pair from the stack; the search is done if it is empty.
void pop(SearchThread& thread);

/// The next pair of records for the pair unit; advances to the one after it.
PairUnit::Output next_records(SearchThread& thread, uint8_t number);

/// Takes the result of the pair unit.
void accept_distance(SearchThread& thread, const PairUnit::Output& distance);

/// Ends the search without an answer.
void stop(SearchThread& thread, Stop reason, uint32_t line);

/// Counters of an element since reset.
struct ElementCounts {
    uint64_t busy = 0;
    uint64_t node_hits = 0, node_misses = 0, record_hits = 0, record_misses = 0;
    uint64_t wait_memory = 0, wait_port = 0, wait_retire = 0;

    bool operator==(const ElementCounts&) const = default;
};

/// A processing element: several searches that share a box unit, a pair unit, two caches and one
/// request to the memory. Each thread does one step per cycle if the unit that it needs is free;
/// the priority rotates.
struct SearchElement {
    std::vector<SearchThread> threads;
    uint32_t acting = 0;  // bit set of the threads that can act
    uint32_t busy = 0;    // with a search
    uint32_t waiting = 0; // for the memory
    uint32_t done = 0;    // with an answer to retire
    uint8_t first = 0;    // has priority
    BoxUnit box;
    PairUnit pair;
    LineCache nodes, records;
    ReadRequest request; // output: held until granted
    ElementCounts counts;

    bool operator==(const SearchElement&) const = default;
};

SearchElement search_element(const DeviceConfig& config);

/// The inputs of an element in a cycle.
struct ElementInput {
    uint8_t number = 0; // its own
    uint64_t cycle = 0;
    uint32_t run = 0;                       // of the device: counts stops
    bool granted = false;                   // its request was accepted
    const ReadResponse* response = nullptr; // null unless for this element
    bool forget = false;                    // a line of memory was written: invalidate it
    uint32_t forgotten = 0;                 // its address
};

/// One rising clock edge.
void tick(SearchElement& element, const DeviceConfig& config, const ElementInput& in);

/// A thread without a search, if any.
std::optional<uint8_t> idle_thread(const SearchElement& element);

/// Starts a search on a thread; release() frees one that is done.
void begin(SearchElement& element, uint8_t thread, const Query& query, uint64_t cycle);
void release(SearchElement& element, uint8_t thread);

/// Drops all searches and pending requests.
void flush(SearchElement& element);

} // namespace hwsim
