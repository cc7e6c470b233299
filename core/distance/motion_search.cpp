#include "core/distance/motion_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace core {
namespace {

/// What rounding adds to a place on the way, for each of these lengths: some ten operations.
constexpr double motion_rounding = 32.0 * std::numeric_limits<double>::epsilon();

/// How far the turn may miss the end, for each of these lengths: rotations may be off by 1e-9 in
/// each entry of R^T R, and twice this much stays below the least tolerance.
constexpr double most_gap = 4e-9;

/// Searches parts of the motion and remembers the best pair.
class MotionSearch {
public:
    MotionSearch(const DistanceEngine& engine, PointBody a, PointBody b, const RigidMotion& motion,
                 const PairGoal& goal)
        : engine_(engine),
          a_(a),
          b_(b),
          motion_(motion),
          first_(goal.first),
          reach_(reach_from_axis(motion, engine.box_of(b))),
          lengths_(lengths_of(engine.box_of(b), motion)),
          gap_(gap_at_end(motion, engine.box_of(b))) {}

    Result<ClosestPair> run(const PairGoal& goal) {
        if (!(gap_ <= most_gap * lengths_))
            return fail(ErrorCode::invalid_value,
                        "the motion does not go together: its turn does not lead to its end");
        const double tolerance = std::max(goal.tolerance, least_motion_tolerance(lengths_));
        const auto part = [&](double from, double to, double worth) {
            return search(from, to, worth);
        };
        FEELER_TRY(const StretchBound least,
                   least_over_time(part, {goal.limit, goal.any, tolerance}));
        ClosestPair found = best_.distance < goal.limit ? best_ : ClosestPair{};
        found.lower = least.lower;
        found.node_tests = node_tests_;
        found.point_tests = point_tests_;
        return found;
    }

private:
    /// The sum of all lengths from which places on the way are worked out.
    static double lengths_of(const Aabb& box, const RigidMotion& motion) {
        return glm::length(glm::max(glm::abs(box.min), glm::abs(box.max)))
               + 2.0 * glm::length(motion.centre) + glm::length(motion.start.translation)
               + glm::length(motion.end.translation);
    }

    Result<StretchBound> search(double from, double to, double worth) {
        const Transform start = motion_.at(from);
        const double allowance =
            bulge(motion_, reach_, to - from) + gap_ + motion_rounding * lengths_;
        const PairGoal goal{.limit = worth + allowance, .end = motion_.at(to), .first = first_};
        FEELER_TRY(const ClosestPair chords, engine_.closest_pair(a_, b_, start, goal));
        node_tests_ += chords.node_tests;
        point_tests_ += chords.point_tests;
        StretchBound bound{std::max(chords.lower - allowance, 0.0), infinity, 2.0 * allowance};
        if (!chords.found()) return bound;
        first_ = chords.points;
        const double time = from + chords.at * (to - from);
        FEELER_TRY(ClosestPair pair, engine_.pair_at(a_, b_, chords.points, motion_.at(time)));
        pair.at = time;
        bound.upper = pair.distance;
        if (pair.distance < best_.distance) best_ = pair;
        return bound;
    }

    const DistanceEngine& engine_;
    PointBody a_, b_;
    const RigidMotion& motion_;
    std::optional<PointPair> first_;
    double reach_, lengths_;
    double gap_; // the last part of the way jumps by this to the end
    ClosestPair best_;
    uint64_t node_tests_ = 0, point_tests_ = 0;
};

} // namespace

Result<ClosestPair> closest_pair(const DistanceEngine& engine, PointBody a, PointBody b,
                                 const RigidMotion& motion, const PairGoal& goal) {
    if (goal.sweep != Vec3(0.0) || goal.end)
        return fail(ErrorCode::invalid_value,
                    "a goal with a way of its own does not go with a motion");
    PairGoal straight = goal;
    straight.end = motion.end;
    if (auto checked = engine.check(a, b, motion.start, straight); !checked)
        return tl::unexpected(std::move(checked).error());
    if (motion.angle == 0.0 && motion.start.rotation == motion.end.rotation) { // exactly, at once
        straight.end.reset();
        straight.sweep = motion.end.translation - motion.start.translation;
        return engine.closest_pair(a, b, motion.start, straight);
    }
    if (!std::isfinite(motion.angle) || !(std::abs(glm::length(motion.axis) - 1.0) <= 1e-9))
        return fail(ErrorCode::invalid_value,
                    "a motion must turn about an axis of length 1 by an angle that is a number");
    return MotionSearch(engine, a, b, motion, goal).run(goal);
}

namespace {

/// A stretch of time that is still in question.
struct Stretch {
    double lower;
    double from, to;
};

bool comes_after(const Stretch& x, const Stretch& y) {
    return x.lower != y.lower ? x.lower > y.lower : x.from > y.from;
}

constexpr double shortest = 1e-12; // rounding leaves nothing to be found in less

} // namespace

Result<StretchBound> least_over_time(
    const std::function<Result<StretchBound>(double from, double to, double worth)>& bound,
    const TimeGoal& goal) {
    std::vector<Stretch> queue = {{0.0, 0.0, 1.0}};
    StretchBound best{goal.limit, goal.known < goal.limit ? goal.known : infinity};
    const auto worth = [&] {
        return best.upper < goal.limit ? std::max(best.upper - goal.tolerance, 0.0) : goal.limit;
    };
    while (!queue.empty()) {
        std::pop_heap(queue.begin(), queue.end(), comes_after);
        const Stretch stretch = queue.back();
        queue.pop_back();
        const bool enough = best.upper == 0.0 || (goal.any && best.upper < goal.limit);
        if (enough || stretch.lower >= worth()) {
            best.lower = std::min(best.lower, stretch.lower); // of all that are left, the least
            break;
        }
        FEELER_TRY(const StretchBound found, bound(stretch.from, stretch.to, worth()));
        if (found.upper < std::min(best.upper, goal.limit)) best.upper = found.upper;
        const double lower = std::max(found.lower, stretch.lower);
        if (lower >= worth() || found.gain <= 0.25 * goal.tolerance
            || stretch.to - stretch.from < shortest) {
            best.lower = std::min(best.lower, lower);
            continue;
        }
        const double middle = 0.5 * (stretch.from + stretch.to);
        for (const Stretch& half :
             {Stretch{lower, stretch.from, middle}, Stretch{lower, middle, stretch.to}}) {
            queue.push_back(half);
            std::push_heap(queue.begin(), queue.end(), comes_after);
        }
    }
    best.lower = std::min(best.lower, best.upper);
    return best;
}

} // namespace core
