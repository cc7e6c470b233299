#include "core/dbm/covered_path.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "core/dbm/cut_model.h"

namespace core {
namespace {

constexpr int deepest_division = 12;
constexpr double rounding = 1e-6; // mm, of heights and radii

bool same_profile(const RevolvedProfile& a, const RevolvedProfile& b) {
    return std::equal(a.elements.begin(), a.elements.end(), b.elements.begin(), b.elements.end(),
                      [](const ProfileElement& p, const ProfileElement& q) {
                          return p.z0 == q.z0 && p.r0 == q.r0 && p.z1 == q.z1 && p.r1 == q.r1
                                 && p.margin == q.margin;
                      });
}

bool widens_upwards(const RevolvedProfile& flutes) {
    double radius = 0.0;
    for (const ProfileElement& e : flutes.elements) {
        if (e.r1 < e.r0 || e.r1 + e.margin < radius) return false;
        radius = e.r1 + e.margin;
    }
    // A ball with nothing above it narrows in its upper half.
    return is_convex(flutes) && flutes.elements.back().margin == 0.0;
}

/// A straight move of a tip in the frame of the tool, in which the tool is upright, and whether its
/// cut is open above.
struct Move {
    Vec3 from, to;
    double near = 0.0; // allowed distance of the tip from it
    bool open = false;
};

/// Whether the tip at `p` is near enough to a position of the move: a tool made smaller by that
/// distance is then inside the tool at that position.
bool passes(const Move& move, const Vec3& p) {
    const Vec3 q = move.from, by = move.to - move.from;
    const double length = glm::dot(by, by);
    const double t = length > 0.0 ? std::clamp(glm::dot(p - q, by) / length, 0.0, 1.0) : 0.0;
    const Vec3 apart = p - (q + t * by);
    return glm::dot(apart, apart) <= move.near * move.near;
}

/// The square of the distance, as seen along Z, of a point from the positions of a move by `by`
/// that begins at the origin: of those above which it is at one of these heights. Infinite if none
/// is.
double squared_distance_beside(const Vec3& p, const Vec3& by, const Interval& heights) {
    // These positions: first .. last of 0 .. 1.
    double first = 0.0, last = 1.0;
    const double low = p.z - heights.upper, high = p.z - heights.lower;
    if (by.z > 0.0) {
        first = std::max(first, low / by.z);
        last = std::min(last, high / by.z);
    } else if (by.z < 0.0) {
        first = std::max(first, high / by.z);
        last = std::min(last, low / by.z);
    } else if (low > 0.0 || high < 0.0) {
        return infinity;
    }
    if (first > last) return infinity;
    const double length = by.x * by.x + by.y * by.y;
    const double along = p.x * by.x + p.y * by.y;
    const double t = length > 0.0 ? std::clamp(along / length, first, last) : first;
    const double x = p.x - t * by.x, y = p.y - t * by.y;
    return x * x + y * y;
}

/// Whether the tip at `p` is in the cut of the move: above a position that is near enough.
bool covers(const Move& move, const Vec3& p) {
    return squared_distance_beside(p - move.from, move.to - move.from, {0.0, infinity})
           <= move.near * move.near;
}

/// A search among the candidate moves.
struct Search {
    std::vector<Move> moves;

    /// Whether both ends meet the same one of two criteria of a move: as it and the path are
    /// straight, everything between does too. Otherwise both halves must, so each end some move's.
    bool covered(const Vec3& a, const Vec3& b, int depth) const {
        bool is_a_covered = false, is_b_covered = false;
        for (const Move& move : moves)
            for (const auto criterion : {passes, covers}) {
                if (criterion == covers && !move.open) continue;
                const bool at_a = criterion(move, a), at_b = criterion(move, b);
                if (at_a && at_b) return true;
                is_a_covered = is_a_covered || at_a;
                is_b_covered = is_b_covered || at_b;
            }
        if (!is_a_covered || !is_b_covered || depth == deepest_division) return false;
        const Vec3 middle = 0.5 * (a + b);
        return covered(a, middle, depth + 1) && covered(middle, b, depth + 1);
    }
};

/// The height of the highest point of a box along `up`.
double top_along(const Aabb& box, const Vec3& up) {
    return glm::dot(glm::max(box.min * up, box.max * up), Vec3(1.0));
}

/// The box of a path and of everything below and above it, along `up`, from where flutes of this
/// height may have cut through to the top of the stock.
Aabb over_and_under(const Vec3& from, const Vec3& to, const Vec3& up, const Aabb& stock,
                    double height) {
    Aabb path;
    path.extend(from);
    path.extend(to);
    Aabb all = path;
    all.extend(stock);
    const Vec3 far = (glm::length(all.size()) + height) * up;
    for (const Vec3& position : {from, to}) {
        path.extend(position + far);
        path.extend(position - far);
    }
    return path;
}

/// The candidate moves of a log, among those with these numbers.
Search search_among(const SweepLog& log, const std::vector<uint32_t>& numbers,
                    const PathQuery& question, double top) {
    const bool upwards = widens_upwards(question.flutes);
    const double height = bounds(question.flutes).max.z;
    const Vec3 up = question.orientation[2];
    const Mat3 tool_from_stock = glm::transpose(question.orientation);
    Search search;
    for (const uint32_t number : numbers) {
        const CutterSweep& sweep = log[number].sweep;
        if (sweep.orientation[2] != up) continue;
        if (!same_profile(sweep.cutter->flutes, question.flutes)) continue;
        Move move{tool_from_stock * sweep.from, tool_from_stock * sweep.to,
                  question.sideways - sweep.cutter->path_error};
        if (move.near <= 0.0) continue;
        // The move below the path also cut above it, up to the top of all material and beyond.
        move.open = upwards && std::min(move.from.z, move.to.z) + height >= top;
        search.moves.push_back(move);
    }
    return search;
}

/// The heights in which the hull of a profile's elements has at least this radius.
std::optional<Interval> heights_of_radius(const RevolvedProfile& profile, double radius) {
    std::optional<Interval> all;
    for (const ProfileElement& e : profile.elements) {
        const double low = e.r0 + e.margin - radius, high = e.r1 + e.margin - radius;
        if (low < 0.0 && high < 0.0) continue;
        Interval wide{e.z0, e.z1};
        const double crossing = low == high ? e.z0 : e.z0 + (e.z1 - e.z0) * low / (low - high);
        if (low < 0.0) wide.lower = crossing;
        if (high < 0.0) wide.upper = crossing;
        all = all ? Interval{all->lower, wide.upper} : wide;
    }
    return all;
}

/// Where the axis of a part need not be covered any more: sets of pairs of a fraction of the path
/// and a height above the tip. All these sets are convex.
///
/// `ways`: the path, and others beside which the part contains all of the part on the path that is
/// in the box of the stock, for example with the axis moved to the nearest place in the box. Any of
/// them may be covered. Moves that meet no stock are not logged, so a cut may end where it has left
/// the stock.
class Covers {
public:
    struct Way {
        Vec3 from, to; // of the tip
    };

    Covers(const CutModel& stock, const PartPathQuery& question, std::vector<Way> ways)
        : question_(question), ways_(std::move(ways)) {
        const Aabb part = bounds(question.part);
        // With a gap, the part may be as long as it is.
        heights_ = {part.min.z + (question.gap > 0.0 ? 0.0 : question.sideways), part.max.z};
        const double radius = part.max.x;
        const Vec3 up = question.orientation[2];
        for (int axis = 0; axis < 3; ++axis) {
            const double across = std::sqrt(std::max(0.0, 1.0 - up[axis] * up[axis]));
            clear_[axis] = (radius + question.sideways) * across;
        }
        box_ = stock.outer_box;
        add_cuts(stock, radius - rounding);
    }

    /// Whether all of the part's axis is covered on the whole path.
    bool everything() {
        std::vector<size_t> sets(6 + cuts_.size());
        std::iota(sets.begin(), sets.end(), size_t(0));
        return cell({0.0, 1.0}, heights_, sets);
    }

private:
    struct Cut {
        Vec3 start, path, up; // of the part, in the frame of the cutter where it starts
        Vec3 by;              // of the cutter
        Interval heights;     // in which it is wide enough
        double near = 0.0;    // allowed distance from its axis, mm
        Aabb axis;            // a box around its axis at these heights, in the stock's frame
    };

    void add_cuts(const CutModel& stock, double radius) {
        const double parallel = question_.gap > 0.0 ? 0.02 : 1e-9; // radians
        const Vec3 up = question_.orientation[2];
        const Aabb flutes = bounds(question_.flutes);
        const double reach = is_upright(question_.orientation)
                                 ? flutes.max.x
                                 : glm::length(Vec3(flutes.max.x, 0.0, flutes.max.z));
        const auto numbers = tips_near(stock, tips_around(), reach);
        for (auto number = numbers.rbegin(); number != numbers.rend(); ++number) {
            if (*number < question_.first_move) break;
            if (*number >= question_.moves_end) continue;
            const CutterSweep& sweep = stock.log[*number].sweep;
            if (glm::length(sweep.orientation[2] - up) > parallel) continue;
            const double error = sweep.cutter->path_error;
            if (error >= question_.sideways) continue;
            for (const Cutter::Piece& piece : sweep.cutter->pieces)
                if (const auto heights = heights_of_radius(piece.within, radius - error))
                    add_cut(sweep, *heights, question_.sideways - error);
        }
    }

    /// Adds what a move of a cutter covers that is wide enough between two heights.
    void add_cut(const CutterSweep& sweep, const Interval& heights, double near) {
        const Mat3 inverse = glm::transpose(sweep.orientation);
        Cut cut{.up = inverse * question_.orientation[2],
                .by = inverse * (sweep.to - sweep.from),
                .heights = {heights.lower - rounding, heights.upper + rounding},
                .near = near};
        for (const Vec3& tip : {sweep.from, sweep.to})
            for (const double height : {heights.lower, heights.upper})
                cut.axis.extend(tip + height * sweep.orientation[2]);
        for (const Way& way : ways_) {
            cut.start = inverse * (way.from - sweep.from);
            cut.path = inverse * (way.to - way.from);
            cuts_.push_back(cut);
        }
    }

    /// A box around the tips of all cutters that may cover the part.
    Aabb tips_around() const {
        const Vec3 up = question_.orientation[2];
        const double reach = bounds(question_.flutes).max.z;
        Aabb box;
        for (const Way& way : ways_)
            for (const Vec3& tip : {way.from, way.to}) {
                box.extend(tip + heights_.upper * up);
                box.extend(tip + (heights_.lower - reach) * up);
            }
        return box.grown(question_.sideways);
    }

    Vec3 on_axis(const Way& way, double t, double h) const {
        return way.from + t * (way.to - way.from) + h * question_.orientation[2];
    }

    /// Whether a set contains a point; the first six are the sides of the box.
    bool contains(size_t set, double t, double h) const {
        if (set < 6) {
            const int axis = static_cast<int>(set / 2);
            const double at = on_axis(ways_[0], t, h)[axis];
            return set % 2 == 0 ? at + clear_[axis] <= box_.min[axis]
                                : at - clear_[axis] >= box_.max[axis];
        }
        const Cut& cut = cuts_[set - 6];
        const Vec3 p = cut.start + t * cut.path + h * cut.up;
        return squared_distance_beside(p, cut.by, cut.heights) <= cut.near * cut.near;
    }

    /// Whether a part of path and heights is covered: by one set with all four corners, which as
    /// it is convex contains everything between; or in halves. `sets`: those that may be near.
    bool cell(const Interval& path, const Interval& heights, const std::vector<size_t>& sets) {
        // Corners as bits: where the path starts and ends, below and above.
        constexpr unsigned start = 0b0101, end = 0b1010, below = 0b0011, above = 0b1100, all = 15;
        Aabb here;
        for (const double t : {path.lower, path.upper})
            for (const double h : {heights.lower, heights.upper})
                for (const Way& way : ways_) here.extend(on_axis(way, t, h));
        here = here.grown(question_.sideways);
        std::vector<size_t> near;
        unsigned any = 0;
        bool has_start = false, has_end = false, has_below = false, has_above = false;
        for (const size_t set : sets) {
            if (set >= 6 && !overlaps(cuts_[set - 6].axis, here)) continue;
            if (++tests_ > most_tests) return false;
            near.push_back(set);
            unsigned in = 0;
            for (unsigned corner = 0; corner < 4; ++corner)
                if (contains(set, corner & 1 ? path.upper : path.lower,
                             corner & 2 ? heights.upper : heights.lower))
                    in |= 1U << corner;
            if (in == all) return true;
            any |= in;
            has_start = has_start || (in & start) == start;
            has_end = has_end || (in & end) == end;
            has_below = has_below || (in & below) == below;
            has_above = has_above || (in & above) == above;
        }
        if (any != all) return false;
        const double width = path.length() * glm::length(question_.to - question_.from);
        const double height = heights.length();
        const double gap = std::max(question_.gap, rounding);
        const bool is_narrow = width <= gap, is_low = height <= gap;
        // Two sides are each covered by one set: what may be between them is narrow.
        const bool has_ends = has_start && has_end, has_edges = has_below && has_above;
        if ((has_ends && is_narrow) || (has_edges && is_low) || (is_narrow && is_low))
            return question_.gap > 0.0;
        if (has_ends != has_edges ? has_ends : width > height) {
            const double middle = 0.5 * (path.lower + path.upper);
            return cell({path.lower, middle}, heights, near)
                   && cell({middle, path.upper}, heights, near);
        }
        const double middle = 0.5 * (heights.lower + heights.upper);
        return cell(path, {heights.lower, middle}, near)
               && cell(path, {middle, heights.upper}, near);
    }

    static constexpr size_t most_tests = 100'000;

    const PartPathQuery& question_;
    std::vector<Way> ways_; // the path is the first
    Interval heights_;
    Aabb box_;
    Vec3 clear_ = Vec3(0.0); // of the axis from each side of the box
    std::vector<Cut> cuts_;
    size_t tests_ = 0;
};

bool is_covered(const Search& search, const PathQuery& question) {
    const Mat3 tool_from_stock = glm::transpose(question.orientation);
    return search.covered(tool_from_stock * question.from, tool_from_stock * question.to, 0);
}

} // namespace

bool runs_in_own_cut(const CutModel& stock, const PathQuery& question) {
    if (question.sideways <= 0.0) return false;
    const Vec3 up = question.orientation[2];
    const Aabb path = over_and_under(question.from, question.to, up, stock.outer_box,
                                     bounds(question.flutes).max.z);
    const auto numbers = tips_near(stock, path.grown(question.sideways));
    return is_covered(search_among(stock.log, numbers, question, top_along(stock.outer_box, up)),
                      question);
}

bool runs_in_own_cut(const SweepLog& log, const Aabb& box, const PathQuery& question) {
    if (question.sideways <= 0.0) return false;
    const Vec3 up = question.orientation[2];
    const Aabb path =
        over_and_under(question.from, question.to, up, box, bounds(question.flutes).max.z)
            .grown(question.sideways);
    std::vector<uint32_t> numbers;
    for (uint32_t number = 0; number < log.size(); ++number)
        if (overlaps(log.path_box(number), path)) numbers.push_back(number);
    return is_covered(search_among(log, numbers, question, top_along(box, up)), question);
}

bool stays_in_own_cut(const CutModel& stock, const PartPathQuery& question) {
    if (question.sideways <= 0.0) return false;
    const Vec3 &from = question.from, by = question.to - from;
    if (!is_upright(question.orientation))
        return Covers(stock, question, {{from, from + by}}).everything();
    // Parts of the path, each on one side of each side of the box.
    const Aabb& box = stock.outer_box;
    std::vector<double> ends{0.0, 1.0};
    for (const int axis : {0, 1})
        for (const double side : {box.min[axis], box.max[axis]})
            if (const double t = (side - from[axis]) / by[axis]; t > 0.0 && t < 1.0)
                ends.push_back(t);
    std::sort(ends.begin(), ends.end());
    for (size_t i = 0; i + 1 < ends.size(); ++i) {
        PartPathQuery part = question;
        part.from = from + ends[i] * by;
        part.to = from + ends[i + 1] * by;
        // For a point p of the box and q of the axis, |p - clamp(q)| <= |p - q|, also if only one
        // coordinate is clamped.
        std::vector<Covers::Way> ways{{part.from, part.to}};
        for (const int axis : {0, 1})
            for (size_t k = 0, count = ways.size(); k < count; ++k) {
                Covers::Way way = ways[k];
                for (Vec3* tip : {&way.from, &way.to})
                    (*tip)[axis] = std::clamp((*tip)[axis], box.min[axis], box.max[axis]);
                if (way.from != ways[k].from || way.to != ways[k].to) ways.push_back(way);
            }
        if (!Covers(stock, part, std::move(ways)).everything()) return false;
    }
    return true;
}

} // namespace core
