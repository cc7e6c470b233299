#include "core/distance/stock_distance.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/dbm/cut_model.h"
#include "core/distance/shape_outline.h"

namespace core {
namespace {

/// Differences below this are ignored, mm: material that is closer than the best so far by less
/// than this is skipped, and the bound allows for it.
constexpr double same = 1e-7;

/// Up to sixteen boxes that may be within a limit.
class NearBoxes {
public:
    void add(double bound, size_t index, double limit) {
        if (bound < limit) near_[count_++] = {bound, index};
    }

    /// Calls `act` for those still within the limit, nearest first.
    template <typename Limit, typename Act>
    void in_order(const Limit& limit, const Act& act) {
        std::sort(near_.begin(), near_.begin() + static_cast<std::ptrdiff_t>(count_),
                  [](const Near& a, const Near& b) {
                      return a.bound != b.bound ? a.bound < b.bound : a.index < b.index;
                  });
        for (size_t i = 0; i < count_ && near_[i].bound < limit(); ++i) act(near_[i].index);
    }

private:
    struct Near {
        double bound;
        size_t index;
    };
    std::array<Near, 16> near_;
    size_t count_ = 0;
};

/// A box as a convex shape for the general search; a flat one in two directions, such as material
/// on a line, as a segment.
ConvexShape convex_body(const Aabb& box) {
    const Vec3 size = box.size();
    const int flat = int(size.x == 0.0) + int(size.y == 0.0) + int(size.z == 0.0);
    return flat >= 2 ? convex_segment(box.min, box.max) : convex(box);
}

/// Four neighbouring lines along Z, or columns: their extents along X, Y and Z.
struct LineRow {
    using Values = std::array<double, TileBoxes::block_side>;

    Values u0{}, u1{}, bottom, top;
    double v0 = 0.0, v1 = 0.0;

    /// `slot`: of the first line in the tile.
    LineRow(const ScanTile& tile, size_t slot) {
        const auto four = [slot](const std::array<double, ScanTile::lines>& values) {
            Values result;
            std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(slot), result.size(),
                        result.begin());
            return result;
        };
        bottom = four(tile.layers[0].lower);
        top = four(tile.layers[0].upper);
        for (size_t k = 1; k < tile.layers.size(); ++k)
            for (size_t i = 0; i < top.size(); ++i)
                top[i] = std::max(top[i], tile.layers[k].upper[slot + i]);
    }
};

/// An upright cylinder along a straight path, widened to the box around the path seen from above:
/// it contains the sweep and is compared with a box in a few operations.
class Tube {
public:
    explicit Tube(const UprightSweep& sweep)
        : path_(Aabb{glm::min(sweep.from, sweep.from + sweep.by),
                     glm::max(sweep.from, sweep.from + sweep.by)}),
          radius_(std::max(sweep.element.r0, sweep.element.r1)),
          margin_(sweep.element.margin) {
        path_.min.z += sweep.element.z0;
        path_.max.z += sweep.element.z1;
        constexpr double short_path = 1.0; // mm
        is_tight_ = sweep.element.r0 == sweep.element.r1
                    && std::min(std::abs(sweep.by.x), std::abs(sweep.by.y)) <= short_path;
    }

    /// Whether its bound is about as good as that of the sweep.
    bool is_tight() const { return is_tight_; }

    /// A lower bound of the distance from the sweep to a box.
    double bound(const Aabb& box) const {
        const auto apart = [&](int axis) {
            return std::max(
                {0.0, box.min[axis] - path_.max[axis], path_.min[axis] - box.max[axis]});
        };
        const double x = apart(0), y = apart(1), z = apart(2);
        const double across = std::max(0.0, std::sqrt(x * x + y * y) - radius_);
        return std::max(0.0, std::sqrt(across * across + z * z) - margin_);
    }

    /// Adds to `near` the lines of a row that may be nearer than `limit`, which is positive.
    void add_near(const LineRow& row, double limit,
                  std::array<bool, TileBoxes::block_side>& near) const {
        const double y = std::max({0.0, row.v0 - path_.max.y, path_.min.y - row.v1});
        const double square = (limit + margin_) * (limit + margin_);
        for (size_t i = 0; i < near.size(); ++i) {
            const double x = std::max({0.0, row.u0[i] - path_.max.x, path_.min.x - row.u1[i]});
            const double z = std::max({0.0, row.bottom[i] - path_.max.z, path_.min.z - row.top[i]});
            const double across = std::max(0.0, std::sqrt(x * x + y * y) - radius_);
            near[i] = near[i] || across * across + z * z < square;
        }
    }

private:
    Aabb path_; // of the axis; along Z, of the whole cylinder
    double radius_, margin_;
    bool is_tight_ = false;
};

/// One search: several shapes against one stock.
class StockSearch {
public:
    StockSearch(std::span<const ConvexShape> shapes, const CutModel& stock, const StockGoal& goal)
        : shapes_(shapes), stock_(stock), goal_(goal) {
        for (const ConvexShape& shape : shapes) {
            outlines_.push_back(outline(shape));
            whole_.extend(outlines_.back().box);
            is_exact_ = is_exact_ && outlines_.back().exact;
            if (!outlines_.back().straight) continue;
            tubes_.emplace_back(outlines_.back().sweep);
            are_tubes_tight_ = are_tubes_tight_ && tubes_.back().is_tight();
        }
        if (tubes_.size() < outlines_.size()) tubes_.clear();
    }

    StockSeparation run() {
        if (goal_.first_line) search_line(*goal_.first_line);
        if (goal_.bound != StockBound::lower) search_lines(2);
        keep_promise();
        lower_ = 0.0;
        if (goal_.bound != StockBound::upper) search_columns();
        // Only now it is known how close the bounds are.
        if (goal_.bound != StockBound::lower && !is_narrow()) {
            search_lines(0);
            search_lines(1);
            keep_promise();
        }
        if (goal_.bound == StockBound::lower) search_lines_of_nearest_cell();
        const auto is_open = [&] {
            return goal_.bound != StockBound::upper && lower_ < goal_.threshold && !decided_near();
        };
        if (goal_.first_place && is_open()) search_line_through(*goal_.first_place);
        if (is_open()) refine_columns();
        result_.separation = upper_.upper < goal_.limit ? upper_ : Separation{};
        result_.separation.lower = std::max(0.0, std::min({lower_, upper_.upper, goal_.limit}));
        return result_;
    }

private:
    /// Whether the lines along X and Y need not be searched, because the bounds are close enough.
    bool is_narrow() const {
        const double lower = goal_.bound == StockBound::upper ? goal_.known_lower : lower_;
        if (goal_.along_z_only || lower >= goal_.limit) return true;
        return upper_.upper < goal_.limit
               && are_close(lower, upper_.upper, goal_.exact_within, stock_.lines.grid.spacing);
    }

    /// A lower bound of the distance to a box; tight only where it may be below `limit`.
    double box_bound(const Aabb& box, double limit) {
        ++result_.box_tests;
        double bound = quick_bound(box);
        if (bound >= limit) return bound;
        bound = infinity;
        for (const ShapeOutline& mine : outlines_)
            bound = std::min(bound, distance_bound(mine, box, limit));
        return bound;
    }

    /// A lower bound of the distance to a box in a few operations.
    double quick_bound(const Aabb& box) const {
        if (tubes_.empty()) return distance(whole_, box);
        double bound = infinity;
        for (const Tube& tube : tubes_) bound = std::min(bound, tube.bound(box));
        return bound;
    }

    /// box_bound() for boxes around material of many lines, which need not be tight.
    double rough_bound(const Aabb& box, double limit) {
        if (tubes_.empty() || !are_tubes_tight_) return box_bound(box, limit);
        ++result_.box_tests;
        return quick_bound(box);
    }

    /// rough_bound() for a box with a gap around lines along `axis`.
    double rough_bound(const Aabb& box, const BoxGap& gap, int axis, double limit) {
        const double whole = rough_bound(box, limit);
        if (whole >= limit || gap.empty()) return whole;
        Aabb below = box, above = box;
        below.max[axis] = gap.from;
        above.min[axis] = gap.to;
        return std::min(rough_bound(below, limit), rough_bound(above, limit));
    }

    /// Distance of the nearest shape to a box, tight only where it is below `limit`, and only up to
    /// `enough`.
    Separation nearest(const Aabb& box, double limit, double enough = -infinity) {
        Separation best;
        double lower = infinity;
        for (size_t i = 0; i < shapes_.size() && best.upper >= enough; ++i) {
            const ShapeOutline& mine = outlines_[i];
            const double bound =
                mine.exact ? distance(mine.box, box) : distance_bound(mine, box, limit);
            if (bound >= limit) {
                lower = std::min(lower, bound);
                continue;
            }
            ++result_.shape_tests;
            const SeparationGoal goal{.tolerance = same, .limit = limit, .enough = enough};
            const Separation found = mine.exact
                                         ? core::separation(mine.sweep, box, goal)
                                         : core::separation(shapes_[i], convex_body(box), goal);
            lower = std::min(lower, found.lower);
            if (found.upper < best.upper) best = found;
        }
        best.lower = lower;
        return best;
    }

    /// Calls `act` for the tiles with material that may be within `limit`, roughly nearest first.
    template <typename Limit, typename Act>
    void for_near_tiles(const TileBoxes& tiles, int axis, const Limit& limit, const Act& act) {
        if (!tiles.above.empty())
            for_tiles_below(tiles, axis, tiles.above.size() - 1, 0, limit, act);
    }

    /// for_near_tiles() for the tiles under one box of a level.
    template <typename Limit, typename Act>
    void for_tiles_below(const TileBoxes& tiles, int axis, size_t level, size_t index,
                         const Limit& limit, const Act& act) {
        const std::vector<Aabb>& boxes = level == 0 ? tiles.boxes : tiles.above[level - 1].boxes;
        const int across = level == 0 ? tiles.u_tiles : tiles.above[level - 1].u_count;
        NearBoxes near;
        const LineRange range = below(tiles, level, index);
        for (int v = range.v_first; v < range.v_last; ++v) {
            for (int u = range.u_first; u < range.u_last; ++u) {
                const size_t part =
                    static_cast<size_t>(v) * static_cast<size_t>(across) + static_cast<size_t>(u);
                if (boxes[part].empty()) continue;
                const BoxGap gap = level == 0 ? tiles.gaps[part] : BoxGap{};
                near.add(rough_bound(boxes[part], gap, axis, limit()), part, limit());
            }
        }
        near.in_order(limit, [&](size_t part) {
            if (level == 0)
                act(part);
            else
                for_tiles_below(tiles, axis, level - 1, part, limit, act);
        });
    }

    double line_limit() const {
        const double found = std::min(upper_.upper, promised_.bound);
        if (found <= goal_.enough) return -infinity;
        // Contact and overlap differ, however small the difference.
        const double reach = std::min(goal_.limit, found);
        return reach > same ? reach - same : reach;
    }

    /// Calls `act` for the ranges of lines in a tile that may be within `limit`.
    template <typename Limit, typename Act>
    void for_blocks(const ScanLines& lines, const TileBoxes& tiles, size_t tile, const Limit& limit,
                    const Act& act) {
        NearBoxes near;
        for (size_t block = 0; block < TileBoxes::blocks_per_tile; ++block) {
            const Aabb& box = tiles.blocks[tile * TileBoxes::blocks_per_tile + block];
            const BoxGap& gap = tiles.block_gaps[tile * TileBoxes::blocks_per_tile + block];
            if (!box.empty())
                near.add(rough_bound(box, gap, lines.axis(), limit()), block, limit());
        }
        near.in_order(limit, [&](size_t block) { act(lines_of_block(lines, tiles, tile, block)); });
    }

    /// Calls `act` for those lines along Z, or columns, of a block that may be within `limit`.
    template <typename Limit, typename Act>
    void for_near_lines(const ScanLines& lines, const LinePositions& positions,
                        const LineRange& range, const Limit& limit, const Act& act) {
        const ScanTile* tile = lines.tile(lines.tile_of(range.u_first, range.v_first));
        const size_t wide = positions.cells ? 1 : 0;
        const auto count = static_cast<size_t>(range.u_last - range.u_first);
        for (int v = range.v_first; v < range.v_last; ++v) {
            const double within = limit();
            if (tile == nullptr || within <= 0.0) return;
            std::array<bool, TileBoxes::block_side> near{};
            if (tubes_.empty()) {
                near.fill(true);
            } else {
                LineRow row(*tile, ScanLines::slot_of(range.u_first, v));
                const double* const u = positions.u + range.u_first;
                std::copy_n(u, count, row.u0.begin());
                std::copy_n(u + wide, count, row.u1.begin());
                row.v0 = positions.v[v], row.v1 = positions.v[v + int(wide)];
                for (const Tube& tube : tubes_) tube.add_near(row, within, near);
            }
            for (size_t i = 0; i < count; ++i)
                if (near[i]) act(range.u_first + static_cast<int>(i), v);
        }
    }

    void search_lines(int axis) {
        const auto family = static_cast<size_t>(axis);
        const ScanLines& lines = stock_.lines.families[family];
        const TileBoxes& tiles = stock_.line_boxes[family];
        const auto limit = [&] { return line_limit(); };
        for_near_tiles(tiles, axis, limit, [&](size_t tile) {
            for_blocks(lines, tiles, tile, limit, [&](const LineRange& range) {
                if (axis == 2) {
                    const LinePositions positions{stock_.positions[0].data(),
                                                  stock_.positions[1].data()};
                    for_near_lines(lines, positions, range, limit, [&](int u, int v) {
                        search_line({axis, u, v});
                    });
                    return;
                }
                for (int v = range.v_first; v < range.v_last; ++v)
                    for (int u = range.u_first; u < range.u_last; ++u) search_line({axis, u, v});
            });
        });
    }

    void search_line(const LineId& id) {
        const double before = line_limit();
        if (before <= 0.0) return;
        const Aabb near = whole_.grown(before);
        const auto& [axis, u, v] = id;
        const Vec3 a = point_on_line(stock_.lines.grid, axis, u, v, near.min[axis]);
        if (distance_squared(a, near) > 0.0) return;
        for (const Interval& matter : stock_.lines.families[static_cast<size_t>(axis)].line(u, v)) {
            if (matter.upper < near.min[axis] || matter.lower > near.max[axis]) continue;
            Vec3 lower = a, upper = a;
            lower[axis] = matter.lower, upper[axis] = matter.upper;
            offer_matter({lower, upper});
        }
        if (line_limit() < before) result_.line = id;
    }

    /// The line along Z through a point, recomputed.
    void search_line_through(const Vec3& point) {
        const auto cell = [&](size_t axis) {
            const std::vector<double>& corners = stock_.corners[axis];
            const int count = axis == 0 ? stock_.columns.u_count() : stock_.columns.v_count();
            const auto last = corners.begin() + count + 1;
            const auto next =
                std::upper_bound(corners.begin(), last, point[static_cast<int>(axis)]);
            return static_cast<int>(next - corners.begin()) - 1;
        };
        const int i = cell(0), j = cell(1);
        if (i < 0 || j < 0 || i >= stock_.columns.u_count() || j >= stock_.columns.v_count())
            return;
        offer_line(fresh_line(stock_, i, j, point.x, point.y), point.x, point.y);
    }

    /// Material on a recomputed line along Z.
    void offer_line(const IntervalList& line, double x, double y) {
        for (const Interval& matter : line)
            offer_matter({{x, y, matter.lower}, {x, y, matter.upper}});
        keep_promise();
    }

    /// Material known to exist.
    void offer_matter(const Aabb& matter) {
        const double bound = box_bound(matter, line_limit());
        if (bound >= line_limit()) return;
        // The bound is up to 1e-7 too low: where that matters, the distance is computed at once.
        if (is_exact_ && bound > goal_.enough + same)
            promised_ = {bound, matter}; // the witness is computed once, at the end
        else
            measure(matter, line_limit());
    }

    void measure(const Aabb& matter, double limit) {
        const Separation found = nearest(matter, limit);
        if (found.upper < upper_.upper) upper_ = found;
    }

    /// Measures the nearest line for which only a bound was computed.
    void keep_promise() {
        if (promised_.bound == infinity) return;
        const Promise line = std::exchange(promised_, {});
        measure(line.matter, std::min(goal_.limit, upper_.upper));
    }

    void search_columns() {
        lower_ = std::min(goal_.limit, upper_.upper); // a larger bound is useless
        // Ties are skipped, and the bound is lowered by the tolerance; not at the limit.
        const auto limit = [&] {
            if (lower_ < goal_.coarse_below) return 0.0;
            return lower_ < goal_.limit ? lower_ - same : lower_;
        };
        for_near_tiles(stock_.column_boxes, 2, limit, [&](size_t tile) {
            for_columns(tile, limit, [&](int i, int j, const Square& square) {
                const double bound = bound_of(square, stock_.columns.line(i, j), limit());
                if (bound < lower_) nearest_cell_ = {i, j};
                lower_ = std::min(lower_, bound);
            });
        });
        lower_ = std::max(0.0, limit());
    }

    /// Material near the nearest column, as the start of the next search.
    void search_lines_of_nearest_cell() {
        const auto [i, j] = nearest_cell_;
        const ScanLines& lines = stock_.lines.families[2];
        for (int v = std::max(j - 1, 0); v <= std::min(j, lines.v_count() - 1); ++v)
            for (int u = std::max(i - 1, 0); u <= std::min(i, lines.u_count() - 1); ++u)
                search_line({2, u, v});
        keep_promise();
    }

    template <typename Limit, typename Act>
    void for_columns(size_t tile, const Limit& limit, const Act& act) {
        for_blocks(stock_.columns, stock_.column_boxes, tile, limit, [&](const LineRange& range) {
            const LinePositions corners{stock_.corners[0].data(), stock_.corners[1].data(), true};
            for_near_lines(stock_.columns, corners, range, limit, [&](int i, int j) {
                if (!stock_.columns.line(i, j).empty()) act(i, j, cell_square(stock_, i, j));
            });
        });
    }

    /// A lower bound of the distance to the boxes of a column, or at least `limit`.
    double bound_of(const Square& square, const LineView& column, double limit) {
        double bound = infinity;
        for (const Interval& heights : column)
            bound = std::min(bound, bound_of(square, heights, limit));
        return bound;
    }

    double bound_of(const Square& square, const Interval& heights, double limit,
                    double enough = -infinity) {
        const Aabb box{{square.x0, square.y0, heights.lower},
                       {square.x1, square.y1, heights.upper}};
        const double bound = box_bound(box, limit);
        if (bound >= limit) return bound;
        return is_exact_ ? bound - same : nearest(box, limit, enough).lower;
    }

    /// Material at this distance or farther does not matter to the refinement.
    double near_enough() const { return goal_.threshold + same; }

    void refine_columns() {
        // Every column that is skipped here, wholly or in part, is at least this far away.
        refined_lower_ = near_enough();
        const auto limit = [&] { return near_enough(); };
        for_near_tiles(stock_.column_boxes, 2, limit, [&](size_t tile) {
            for_columns(tile, limit,
                        [&](int i, int j, const Square& square) { refine_cell(i, j, square); });
        });
        lower_ = std::max(lower_, std::min(refined_lower_ - same, goal_.limit));
    }

    bool decided_near() const { return upper_.upper < goal_.threshold; }

    /// Whether dividing more squares is useless or has used up its budget.
    bool ends_refining() const {
        return decided_near() || result_.refined >= goal_.work_limit
               || result_.futile > goal_.futile_limit;
    }

    void refine_cell(int i, int j, const Square& square) {
        const Near near = near_part(square, stock_.columns.line(i, j), ends_refining());
        if (near.bound >= near_enough()) return;
        if (ends_refining()) {
            refined_lower_ = std::min(refined_lower_, near.bound);
            return;
        }
        if (keeps_whole(square, near)) return;
        if (KeptSquare* const kept = goal_.kept ? goal_.kept->of_cell(i, j) : nullptr)
            return refine(*kept);
        const CellSweeps sweeps = sweeps_near_cell(stock_, i, j);
        SquareCuts cuts(stock_, sweeps, square, near.heights);
        refine(cuts);
    }

    /// The part of a column that is too near, and its bound; tight only if that is kept.
    struct Near {
        double bound = infinity;
        Interval heights{infinity, -infinity};
    };

    template <typename Column>
    Near near_part(const Square& square, const Column& column, bool is_last) {
        // The bound of a square that is divided does not matter.
        const double enough = is_last || is_finest(square) ? -infinity : near_enough();
        Near near;
        for (const Interval& matter : column) {
            const double bound = bound_of(square, matter, near_enough(), enough);
            if (bound >= near_enough()) continue;
            near.bound = std::min(near.bound, bound);
            near.heights.lower = std::min(near.heights.lower, matter.lower);
            near.heights.upper = std::max(near.heights.upper, matter.upper);
        }
        // Material above or below the shapes by more than the threshold does not matter.
        const double slack = near_enough() + 10.0 * same;
        near.heights.lower = std::max(near.heights.lower, whole_.min.z - slack);
        near.heights.upper = std::min(near.heights.upper, whole_.max.z + slack);
        return near;
    }

    bool is_finest(const Square& square) const {
        return std::max(square.x1 - square.x0, square.y1 - square.y0) <= goal_.finest;
    }

    /// Keeps the bound of a square that is too near, but is not divided any more; returns whether
    /// it is one.
    bool keeps_whole(const Square& square, const Near& near) {
        const bool finest = is_finest(square);
        if (!finest && !ends_refining()) return false;
        refined_lower_ = std::min(refined_lower_, near.bound);
        result_.futile += finest && result_.futile == 0;
        return true;
    }

    /// Divides a square that is too near until its bound reaches the threshold; the least remaining
    /// bound is kept.
    template <typename Cuts>
    void refine(Cuts& cuts) {
        const Square& square = cuts.square();
        const double x = 0.5 * (square.x0 + square.x1), y = 0.5 * (square.y0 + square.y1);
        offer_line(cuts.line_at_centre(), x, y);
        for (int quarter = 0; quarter < 4; ++quarter) {
            ++result_.refined;
            if (result_.futile > 0) ++result_.futile;
            const Square part = cuts.quarter(quarter);
            const Near left = near_part(part, cuts.column(quarter), ends_refining());
            if (left.bound >= near_enough() || keeps_whole(part, left)) continue;
            if constexpr (std::is_same_v<Cuts, KeptSquare>) {
                if (KeptSquare* const within = cuts.within(quarter)) {
                    refine(*within);
                } else {
                    SquareCuts loose = cuts.loose_within(quarter, left.heights);
                    refine(loose);
                }
            } else {
                SquareCuts within = cuts.within(quarter, left.heights);
                refine(within);
            }
        }
    }

    std::span<const ConvexShape> shapes_;
    const CutModel& stock_;
    StockGoal goal_;
    std::vector<ShapeOutline> outlines_;
    std::vector<Tube> tubes_; // around the shapes, if all are upright and move straight
    bool are_tubes_tight_ = true;
    Aabb whole_;           // around all of them
    bool is_exact_ = true; // outline distances are exact up to rounding
    /// Material on a line at this distance according to the outlines.
    struct Promise {
        double bound = infinity;
        Aabb matter;
    };

    Separation upper_;
    Promise promised_;
    double lower_ = infinity;
    double refined_lower_ = infinity;
    std::pair<int, int> nearest_cell_{-1, -1}; // of the column that gave `lower_`
    StockSeparation result_;
};

} // namespace

StockSeparation separation(std::span<const ConvexShape> shapes, const CutModel& stock,
                           const StockGoal& goal) {
    return StockSearch(shapes, stock, goal).run();
}

} // namespace core
