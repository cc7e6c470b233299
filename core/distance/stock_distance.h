#pragma once

#include <algorithm>
#include <optional>
#include <span>

#include "core/dbm/dbm.h"
#include "core/geom/gjk.h"

namespace core {

class KeptSquares;
struct CutModel;

/// The bounds of the distance to compute. The other one is valid but not tight.
enum class StockBound : uint8_t { both, lower, upper };

/// What a search against a stock should decide, and its budget.
struct StockGoal {
    double limit = 50.0; // mm: larger distances do not matter
    StockBound bound = StockBound::both;
    double enough = 0.0;      // mm: an upper bound of at most this need not be improved
    double known_lower = 0.0; // mm: a lower bound that is known if only `upper` is computed
    // mm: beyond this lower bound, `upper` may be that of the lines along Z alone, if it is close
    // to `lower` (are_close).
    double exact_within = infinity;
    bool along_z_only = false;   // search the lines along Z alone for `upper`
    double coarse_below = 0.0;   // mm: a lower bound below this may be given as 0
    double threshold = 0.0;      // mm: the interval is narrowed until it does not contain this
    double finest = 0.03;        // mm: squares are not divided below this side
    size_t work_limit = 100'000; // squares that may be recomputed
    // Squares that may be recomputed once a square of the finest side is too near: `lower` cannot
    // reach the threshold any more, but material nearer than the threshold may still be found.
    size_t futile_limit = 100'000;
    KeptSquares* kept = nullptr; // of this stock, if several searches share what they recompute
    std::optional<LineId> first_line; // searched first; the last answer is a good guess
    // Where the interval would have to be narrowed, the line along Z through this point of the
    // stock is recomputed first.
    std::optional<Vec3> first_place = {};
};

/// Whether bounds beyond `exact_within` are so close that lines along X and Y need not be searched
/// for a smaller upper one: within an eighth of `lower`, and within half the spacing of lines or
/// 3 % of `lower`.
inline bool are_close(double lower, double upper, double exact_within, double spacing) {
    return lower > exact_within
           && upper - lower <= std::min(std::max(0.5 * spacing, 0.03 * lower), 0.125 * lower);
}

/// The distance of a shape from a stock that is being cut.
struct StockSeparation {
    Separation separation;      // `upper` to material on a scan line, `lower` to the outer model
    std::optional<LineId> line; // that gave `upper`
    size_t refined = 0;         // recomputed squares
    size_t futile = 0;          // those of them that count against StockGoal::futile_limit
    size_t box_tests = 0;       // pairs of boxes compared
    size_t shape_tests = 0;     // exact distances of convex shapes
};

/// The distance from several convex shapes to a stock.
///
/// Result:  lower <= distance to the stock as cut by the logged sweeps <= upper. `upper` is
///          infinite if no material on a scan line is within `goal.limit`; `lower` is at most the
///          limit. Beyond `exact_within`, `upper` may be that of the lines along Z. While the
///          interval contains `goal.threshold`, columns that are too near are divided and
///          recomputed; it may still contain it when a limit of the goal or the finest square is
///          reached.
/// Source:  the column and corner rule, see README.md.
StockSeparation separation(std::span<const ConvexShape> shapes, const CutModel& stock,
                           const StockGoal& goal = {});

} // namespace core
