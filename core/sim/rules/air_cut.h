#pragma once

#include <optional>

#include "core/sim/finding.h"

namespace core {

/// Flutes that keep farther than this from the stock are in the air, mm; nearer they may be on a
/// spring pass.
constexpr double air_gap = 0.5;

/// Motions of one tool in a row, rapids between them not counted, that feed through nothing but
/// air. A plain value.
struct AirSeries {
    std::optional<BlockIndex> begin;
    double way = 0.0; // mm
    size_t blocks = 0;
    std::optional<BlockIndex> last;
};

/// A feed of this length that kept away from the stock.
void add_air(AirSeries& series, BlockIndex block, double way);

/// Ends a series, and gives the finding `air-cut` about it, with its first block, if it is longer
/// than the ways in and out of a cut by a tool of this diameter. Its severity is left open.
std::optional<Finding> end_air(AirSeries& series, double diameter);

} // namespace core
