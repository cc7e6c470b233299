#include "core/distance/body_side.h"

namespace core {
namespace {

/// The way back: how A stands against B, and moves, when B is held still.
BodyMotion reversed(const BodyMotion& motion) {
    const Transform b_from_a = motion.a_from_b.inverse();
    return {b_from_a, -(b_from_a.rotation * motion.sweep)};
}

/// What was found while B was held still, in the frame of A again.
Separation held_against(Separation found, const BodyMotion& motion) {
    const Vec3 back = found.time_a * motion.sweep;
    found.point_a = motion.a_from_b * found.point_a + back;
    found.point_b = motion.a_from_b * found.point_b + back;
    return found;
}

SideSeparation of_boxes(const BoxTree& a, const ExactBody& b, const BodyMotion& motion,
                        const SeparationGoal& goal) {
    const BodyMotion back = reversed(motion);
    const BoxSeparation found = separation(a, b, back.a_from_b, back.sweep, goal);
    return {held_against(found.separation, motion), found.box_a, 0};
}

SideSeparation of_part(const ExactBody& a, const BoxTree& b, const BodyMotion& motion,
                       const SeparationGoal& goal) {
    const BoxSeparation found = separation(b, a, motion.a_from_b, motion.sweep, goal);
    SideSeparation result{found.separation, 0, found.box_a};
    std::swap(result.separation.point_a, result.separation.point_b);
    return result;
}

/// Collects what the parts of a side say.
struct Nearest {
    SeparationGoal goal;
    SideSeparation best;
    double least_lower = infinity;

    SeparationGoal next() const {
        return {goal.tolerance, std::min(goal.limit, best.separation.upper)};
    }

    void offer(const SideSeparation& found) {
        least_lower = std::min(least_lower, found.separation.lower);
        if (found.separation.upper < best.separation.upper) best = found;
    }

    SideSeparation result() const {
        SideSeparation found = best;
        found.separation.lower = std::min(least_lower, best.separation.upper);
        return found;
    }
};

SideSeparation of_all_parts(const BodySide& a, const BodySide& b, const BodyMotion& motion,
                            const SeparationGoal& goal) {
    Nearest nearest{goal, {}, infinity};
    for (size_t i = 0; i < a.parts.size(); ++i)
        for (size_t j = 0; j < b.parts.size(); ++j)
            nearest.offer({separation(a.parts[i].body, b.parts[j].body, motion.a_from_b,
                                      motion.sweep, nearest.next()),
                           i, j});
    return nearest.result();
}

} // namespace

SideSeparation separation(const BodySide& a, const BodySide& b, const BodyMotion& motion,
                          const SeparationGoal& goal) {
    if (a.is_exact() && b.is_exact()) return of_all_parts(a, b, motion, goal);
    if (!a.is_exact() && !b.is_exact()) {
        const BoxSeparation found =
            separation(*a.boxes, *b.boxes, motion.a_from_b, motion.sweep, goal);
        return {found.separation, found.box_a, 0};
    }
    Nearest nearest{goal, {}, infinity};
    for (size_t i = 0; i < a.parts.size(); ++i) {
        SideSeparation found = of_part(a.parts[i].body, *b.boxes, motion, nearest.next());
        found.part_a = i;
        nearest.offer(found);
    }
    for (size_t j = 0; j < b.parts.size(); ++j) {
        SideSeparation found = of_boxes(*a.boxes, b.parts[j].body, motion, nearest.next());
        found.part_b = j;
        nearest.offer(found);
    }
    return nearest.result();
}

} // namespace core
