#pragma once

#include <optional>
#include <span>

#include "core/geom/gjk.h"

namespace core {

struct CutModel;

/// A scan line of a stock: which one, of which family.
struct LineId {
    int axis = 0, u = 0, v = 0;
};

/// Which bounds of the distance are asked for. Of one that is not, a search tells what it happens
/// to know.
enum class StockBound : uint8_t { both, lower, upper };

/// What a search against a stock should decide, and what it may spend.
struct StockGoal {
    double limit = 50.0; // mm: beyond it nobody asks
    StockBound bound = StockBound::both;
    double enough = 0.0;         // mm: of an upper bound no greater, no lesser one is looked for
    double threshold = 0.0;      // mm: the interval is narrowed until it lies on one side of this
    double finest = 0.03;        // mm: squares are not divided below this side
    size_t work_limit = 100'000; // squares that may be worked out afresh
    std::optional<LineId>
        first_line; // looked at before all others; the last answer is a good guess
};

/// How far a shape is from a stock that is being cut.
struct StockSeparation {
    Separation separation;      // `upper` from matter on a scan line, `lower` from the outer model
    std::optional<LineId> line; // that gave `upper`
    size_t refined = 0;         // squares worked out afresh
    size_t box_tests = 0;       // pairs of boxes compared
    size_t shape_tests = 0;     // exact distances of convex shapes
};

/// The distance from convex shapes, taken together, to a stock.
///
/// Result: lower <= distance to the stock as cut by the logged sweeps <= upper. `upper` is infinite
///         when no matter on a scan line is nearer than `goal.limit`, `lower` at most the limit.
///         While the interval spans `goal.threshold` the columns that are too near are divided and
///         worked out afresh; it may still span it when the work or the finest square is reached.
/// Source: the column and corner rule, see README.md beside this file.
StockSeparation separation(std::span<const ConvexShape> shapes, const CutModel& stock,
                           const StockGoal& goal = {});

} // namespace core
