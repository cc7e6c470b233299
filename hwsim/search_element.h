#pragma once

#include "hwsim/line_cache.h"
#include "hwsim/memory_unit.h"
#include "hwsim/search_thread.h"

namespace hwsim {

/// What an element counts, from reset on.
struct ElementCounts {
    uint64_t busy = 0;
    uint64_t node_hits = 0, node_misses = 0, record_hits = 0, record_misses = 0;
    uint64_t wait_memory = 0, wait_port = 0, wait_retire = 0;

    bool operator==(const ElementCounts&) const = default;
};

/// A processing element: a few searches that share a box unit, a pair unit, two caches and one
/// request to the memory. Each thread does one thing a cycle, if nobody else has what it needs;
/// who is asked first goes round.
struct SearchElement {
    std::vector<SearchThread> threads;
    uint32_t acting = 0;  // a bit for each thread that has something to do
    uint32_t busy = 0;    // that has a search
    uint32_t waiting = 0; // for the memory
    uint32_t done = 0;    // whose answer waits
    uint8_t first = 0;    // is asked first
    BoxUnit box;
    PairUnit pair;
    LineCache nodes, records;
    ReadRequest request; // output: stays until it is granted
    ElementCounts counts;

    bool operator==(const SearchElement&) const = default;
};

SearchElement search_element(const DeviceConfig& config);

/// What an element sees in a cycle.
struct ElementInput {
    uint8_t number = 0; // its own
    uint64_t cycle = 0;
    uint32_t run = 0;                       // of the device: counts stops
    bool granted = false;                   // its request was taken in
    const ReadResponse* response = nullptr; // if it is for this element
    bool forget = false;                    // a line of memory was written
    uint32_t forgotten = 0;                 // its address
};

/// One rising clock edge.
void tick(SearchElement& element, const DeviceConfig& config, const ElementInput& in);

/// A thread without a search, if there is one.
std::optional<uint8_t> idle_thread(const SearchElement& element);

/// Gives a thread its search; releases one that is done.
void begin(SearchElement& element, uint8_t thread, const Query& query, uint64_t cycle);
void release(SearchElement& element, uint8_t thread);

/// Drops all searches and what is under way.
void flush(SearchElement& element);

} // namespace hwsim
