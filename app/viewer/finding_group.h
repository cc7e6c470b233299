#pragma once

#include <array>
#include <string>
#include <vector>

#include "app/viewer/block_row.h"

namespace app::viewer {

/// Findings of one rule about one pair, in blocks that follow one another but for such that do not
/// move.
struct FindingStretch {
    size_t first = 0, last = 0;      // blocks
    size_t count = 0;                // blocks that have the finding
    size_t worst = 0;                // the block where most is missing
    std::optional<double> clearance; // there, mm; empty where the finding is about none
    double shortfall = 0.0;          // there, mm
    std::string message, cure;       // there
};

/// All findings of one rule about one pair of bodies.
struct FindingGroup {
    std::string rule;
    std::array<std::string, 2> pair; // empty if it is about none
    core::Severity severity = core::Severity::off;
    std::vector<FindingStretch> stretches; // in order; empty if it is about the program as a whole
    size_t worst = 0;                      // of the stretches
    size_t count = 0;                      // blocks
    std::string message, cure;             // of one about the program as a whole
};

/// The findings of a program, grouped: the most severe groups first, then those where most is
/// missing, then in the order of the program.
std::vector<FindingGroup> grouped(const std::vector<BlockRow>& rows,
                                  const std::vector<core::Finding>& findings);

/// A stretch among all groups.
struct StretchPlace {
    size_t group = 0, stretch = 0;

    bool operator==(const StretchPlace&) const = default;
};

/// The first stretch that holds a block.
std::optional<StretchPlace> stretch_at(const std::vector<FindingGroup>& groups, size_t block);

/// The stretch behind or before another one, as they are listed; from the first or last one on
/// without another. Empty at the end of the list.
std::optional<StretchPlace> stretch_beside(const std::vector<FindingGroup>& groups,
                                           const std::optional<StretchPlace>& from, bool forward);

} // namespace app::viewer
