#pragma once

#include <array>
#include <optional>
#include <vector>

#include "hwsim/memory_line.h"

namespace hwsim {

/// Some lines of memory in a row.
struct LineRun {
    uint32_t first = 0, count = 0;

    bool operator==(const LineRun&) const = default;
};

/// Which lines of the device's memory are free. A plain value, kept by the host.
struct LineSpace {
    static constexpr uint32_t most = leaf_lines(Reference::most_records); // lines of a run

    uint32_t next = 0, end = 0;                           // never used so far
    std::array<std::vector<uint32_t>, most + 1> returned; // by length
};

/// A run of so many free lines, or none if the memory is full. A longer one that was returned is
/// broken up before the memory counts as full.
std::optional<LineRun> take(LineSpace& space, uint32_t count);

void give_back(LineSpace& space, const LineRun& run);

} // namespace hwsim
