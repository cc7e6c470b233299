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

/// What the path unit answers: how a pair is divided, and the offsets of two samples.
struct PathAnswer {
    bool valid = false;
    uint8_t thread = 0;
    Division division = Division::none;
    std::array<FixedVec, 2> offset{};

    bool operator==(const PathAnswer&) const = default;
};

/// Chooses the part of a pair to divide, and computes the offsets of two samples of the path, with
/// six multipliers of 13 x 25 bits.
///
/// Stages: ways and lengths, products, sums, offsets, their difference, comparison.
using PathUnit = Pipeline<PathAnswer, 6>;

/// What the gap unit answers: the squared distance of a half of a division, or of two records.
struct GapAnswer {
    bool valid = false;
    uint8_t thread = 0;
    bool of_records = false;
    uint8_t half = 0;                          // of the division
    bool in_range = true;                      // otherwise the half leaves the range
    uint32_t tool_record = 0, work_record = 0; // names
    uint64_t squared = 0;

    bool operator==(const GapAnswer&) const = default;
};

/// The squared distance of a swept volume and a box, or of two records, with three multipliers of
/// 24 x 24 bits and one of 25 x 25.
///
/// Stages: 4 for the gaps, 3 for their squares and the sum, 13 of the root with two bits each, less
/// the radius, at least 0, 2 for the square, sum. For spheres the sum is of three squares, and that
/// of the height is not added.
using GapUnit = Pipeline<GapAnswer, 25>;

/// What a thread does next, or waits for.
enum class Phase : uint8_t {
    idle,
    divide,    // the part of the pair to divide: needs the path unit
    dividing,  // waits for the path unit
    open,      // reads a node: needs the port of the caches
    middle,    // the offsets at the middle of the path: needs the path unit
    halving,   // waits for the path unit
    test,      // needs the gap unit, once for each half
    tested,    // waits for the gap unit
    pop,       // the next pair of the stack: needs its port
    popped,    // the pair has been read
    take_tool, // reads a line of the tool's leaf: needs the port of the caches
    take_work, // reads a line of the work's leaf
    compare,   // needs the gap unit for each pair of records
    drain,     // waits for the last of them
    look,      // waits for the cache
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
    uint8_t in_gap_unit = 0; // pairs of records
    uint8_t next_half = 0;   // to test
    bool is_stale = false;   // the line was written after it was requested
    Division division = Division::none;
    uint64_t started = 0; // cycle
    Query query;
    Answer answer;
    SearchPair pair;
    SplitPairs halves;
    std::array<bool, 2> in_range{};   // the halves
    std::array<FixedVec, 2> offset{}; // at the first and the last sample of `pair`
    std::array<FixedVec, 2> middle{}; // at the last of its first half, the first of its second
    Records tools{}, works{};
    std::array<SearchPair, 64> stack{};

    bool operator==(const SearchThread&) const = default;
};

void start(SearchThread& thread, const Query& query, uint64_t cycle);

/// The line that the thread reads, and whether it belongs to the work model, else to the tool
/// model.
uint32_t requested_line(const SearchThread& thread);
bool needs_work(const SearchThread& thread);

/// The question to the path unit in phases divide and middle; none if the search takes too long.
PathAnswer ask_path_unit(SearchThread& thread, uint8_t number, uint64_t cycle,
                         const DeviceConfig& config);

/// Continues with the answer of the path unit.
void accept_path(SearchThread& thread, const PathAnswer& answer);

/// Continues with the line that was read.
void accept_line(SearchThread& thread, const Line& line, Volumes volumes);

/// The question to the gap unit in phases test and compare.
GapAnswer ask_gap_unit(SearchThread& thread, uint8_t number, Volumes volumes);

/// Takes an answer of the gap unit.
void accept_gap(SearchThread& thread, const GapAnswer& answer, uint32_t stack_depth);

/// Continues with the pair that was taken from the stack.
void accept_popped(SearchThread& thread);

/// Ends the search without an answer.
void stop(SearchThread& thread, Stop reason, uint32_t line);

/// Counters of an element since reset.
struct ElementCounts {
    uint64_t busy = 0;
    uint64_t node_hits = 0, node_misses = 0, record_hits = 0, record_misses = 0;
    uint64_t wait_memory = 0, wait_port = 0, wait_retire = 0;

    bool operator==(const ElementCounts&) const = default;
};

/// A line that is read from a cache: the output of its memory.
struct CacheRead {
    bool valid = false;
    bool hit = false;
    uint8_t thread = 0;
    Line line;

    bool operator==(const CacheRead&) const = default;
};

/// A line of the memory was written: what its place in each cache held.
struct Snoop {
    bool in_nodes = false, in_records = false;
    uint32_t address = 0;

    bool operator==(const Snoop&) const = default;
};

/// A processing element: several searches that share a path unit, a gap unit, the memories of
/// caches and stacks with one read port each, and one request to the main memory. Each thread does
/// one step per cycle if the unit that it needs is free; the priority rotates.
struct SearchElement {
    std::vector<SearchThread> threads;
    uint32_t acting = 0;  // bit set of the threads that can act
    uint32_t busy = 0;    // with a search
    uint32_t waiting = 0; // for the memory
    uint32_t done = 0;    // with an answer to retire
    uint8_t first = 0;    // has priority
    PathUnit path;
    GapUnit gap;
    LineCache nodes, records;
    CacheRead looked;
    Snoop snoop;
    ReadRequest request; // output: held until granted
    ElementCounts counts;

    bool operator==(const SearchElement&) const = default;
};

SearchElement search_element(const DeviceConfig& config);

/// A search for a thread of an element: an output of the permit unit.
struct SearchStart {
    bool valid = false;
    uint8_t element = 0, thread = 0;
    Query query;

    bool operator==(const SearchStart&) const = default;
};

/// A thread whose answer was taken: an output of the permit unit.
struct ThreadRelease {
    bool valid = false;
    uint8_t element = 0, thread = 0;

    bool operator==(const ThreadRelease&) const = default;
};

/// The inputs of an element: outputs of other units before the edge. Pointers are null unless their
/// object is for this element.
struct ElementInput {
    uint8_t number = 0; // its own
    uint64_t cycle = 0;
    uint32_t run = 0;     // of the device: counts stops
    bool flush = false;   // drop everything
    bool granted = false; // its request was accepted
    const ReadResponse* response = nullptr;
    const SearchStart* start = nullptr;
    const ThreadRelease* release = nullptr;
    bool forget = false;    // a line of memory was written
    uint32_t forgotten = 0; // its address
};

/// One rising clock edge.
void tick(SearchElement& element, const DeviceConfig& config, const ElementInput& in);

} // namespace hwsim
