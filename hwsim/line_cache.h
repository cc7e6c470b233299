#pragma once

#include <vector>

#include "hwsim/memory_line.h"

namespace hwsim {

/// A direct mapped cache of lines. What is in it has been checked.
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

/// The line, or null if it is not there.
inline const Line* looked_up(LineCache& cache, uint32_t address) {
    const LineCache::Entry& entry = entry_of(cache, address);
    return entry.valid && entry.address == address ? &entry.line : nullptr;
}

inline void fill(LineCache& cache, uint32_t address, const Line& line) {
    entry_of(cache, address) = {true, address, line};
}

/// The memory has another line there now.
inline void invalidate(LineCache& cache, uint32_t address) {
    LineCache::Entry& entry = entry_of(cache, address);
    if (entry.address == address) entry.valid = false;
}

} // namespace hwsim
