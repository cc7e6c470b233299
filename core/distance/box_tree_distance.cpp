#include "core/distance/box_tree_distance.h"

#include "core/distance/closest_pair.h"

namespace core {
namespace {

/// A box as a shape with no more corners than it needs.
ConvexShape shape_of(const Aabb& box) {
    const Vec3 size = box.size();
    const int thick = (size.x > 0.0) + (size.y > 0.0) + (size.z > 0.0);
    return thick <= 1 ? convex_segment(box.min, box.max) : convex(box);
}

ConvexShape moved(const Aabb& box, const Transform& pose, const Vec3& sweep) {
    const ConvexShape shape = posed(shape_of(box), pose);
    if (sweep == Vec3(0.0)) return shape;
    const Vec3 places[] = {Vec3(0.0), sweep};
    return swept(shape, places);
}

/// The best pair so far, and the least lower bound among all that was looked at or passed over.
struct Best {
    SeparationGoal goal;
    BoxSeparation best;
    double least_lower = infinity;

    /// What is this far away or farther needs no closer look.
    double limit() const { return std::min(goal.limit, best.separation.upper - goal.tolerance); }

    bool is_done() const { return best.separation.upper == 0.0; }

    /// Whether something at least `bound` away may be passed over.
    bool passes_over(double bound) {
        if (!is_done() && bound < limit()) return false;
        least_lower = std::min(least_lower, bound);
        return true;
    }

    void offer(const Separation& found, uint32_t box_a) {
        least_lower = std::min(least_lower, found.lower);
        if (found.upper < best.separation.upper) best = {found, box_a};
    }

    BoxSeparation result() const {
        const double lower = std::min({least_lower, best.separation.upper, goal.limit});
        BoxSeparation found = best.separation.upper < goal.limit ? best : BoxSeparation{};
        found.separation.lower = std::max(0.0, lower);
        return found;
    }
};

struct BodySearch : Best {
    const BoxTree& tree;
    const ExactBody& body;
    const Transform& pose;
    const Vec3& sweep;

    Separation measured(const Aabb& box) const {
        return separation(moved(box, pose, sweep), body, {goal.tolerance, limit()});
    }

    void visit(const BoxTree::Node& node) {
        if (node.is_leaf()) {
            for (uint32_t i = node.first; i < node.first + node.count; ++i)
                if (!is_done()) offer(measured(tree.boxes[i]), i);
            return;
        }
        const BoxTree::Node* near = &tree.nodes[node.first];
        const BoxTree::Node* far = near + 1;
        double near_bound = measured(near->box).lower, far_bound = measured(far->box).lower;
        if (far_bound < near_bound) {
            std::swap(near, far);
            std::swap(near_bound, far_bound);
        }
        if (!passes_over(near_bound)) visit(*near);
        if (!passes_over(far_bound)) visit(*far);
    }
};

Mat3 absolute(const Mat3& m) { return {glm::abs(m[0]), glm::abs(m[1]), glm::abs(m[2])}; }

/// How far two boxes round 0 of half sizes `a` and `b` stay apart while the second one moves from
/// `from` by `sweep`.
double gap(const Vec3& a, const Vec3& b, const Vec3& from, const Vec3& sweep) {
    const Vec3 low = from + glm::min(sweep, Vec3(0.0)), high = from + glm::max(sweep, Vec3(0.0));
    return glm::length(glm::max(glm::max(low, -high) - (a + b), Vec3(0.0)));
}

struct PairSearch : Best {
    const BoxTree& a;
    const BoxTree& b;
    const Transform& a_from_b;
    const Vec3& sweep;
    Mat3 b_from_a = glm::transpose(a_from_b.rotation);
    Mat3 spread_to_a = absolute(a_from_b.rotation);
    Mat3 spread_to_b = glm::transpose(spread_to_a);
    Vec3 sweep_in_b = b_from_a * sweep;

    /// A lower bound of the distance of two boxes: along the axes of A, along those of B, and along
    /// the line between their middles where these are nearest.
    double bound(const Aabb& box_a, const Aabb& box_b) const {
        const Vec3 half_a = 0.5 * box_a.size(), half_b = 0.5 * box_b.size();
        const Vec3 apart = a_from_b * box_b.center() - box_a.center();
        const double by_axes =
            std::max(gap(half_a, spread_to_a * half_b, apart, sweep),
                     gap(half_b, spread_to_b * half_a, b_from_a * apart, sweep_in_b));
        const Vec3 nearest = apart + nearest_time(-apart, sweep) * sweep;
        const double length = glm::length(nearest);
        if (length == 0.0) return by_axes;
        const Vec3 n = nearest / length;
        return std::max(by_axes, length - glm::dot(glm::abs(n), half_a)
                                     - glm::dot(glm::abs(b_from_a * n), half_b));
    }

    double bound(const BoxTree::Node& node_a, const BoxTree::Node& node_b) const {
        return bound(node_a.box, node_b.box);
    }

    void visit(const BoxTree::Node& node_a, const BoxTree::Node& node_b) {
        if (node_a.is_leaf() && node_b.is_leaf()) return compare(node_a, node_b);
        const Vec3 size_a = node_a.box.size(), size_b = node_b.box.size();
        const bool split_a =
            node_b.is_leaf()
            || (!node_a.is_leaf() && glm::dot(size_a, size_a) >= glm::dot(size_b, size_b));
        const BoxTree::Node* near = split_a ? &a.nodes[node_a.first] : &b.nodes[node_b.first];
        const BoxTree::Node* far = near + 1;
        const auto bound_of = [&](const BoxTree::Node* child) {
            return split_a ? bound(*child, node_b) : bound(node_a, *child);
        };
        double near_bound = bound_of(near), far_bound = bound_of(far);
        if (far_bound < near_bound) {
            std::swap(near, far);
            std::swap(near_bound, far_bound);
        }
        for (const auto& [child, least] : {std::pair(near, near_bound), std::pair(far, far_bound)})
            if (!passes_over(least)) split_a ? visit(*child, node_b) : visit(node_a, *child);
    }

    void compare(const BoxTree::Node& node_a, const BoxTree::Node& node_b) {
        for (uint32_t j = node_b.first; j < node_b.first + node_b.count; ++j) {
            for (uint32_t i = node_a.first; i < node_a.first + node_a.count; ++i) {
                if (passes_over(bound(a.boxes[i], b.boxes[j]))) continue;
                Separation found = separation(moved(b.boxes[j], a_from_b, sweep),
                                              shape_of(a.boxes[i]), {goal.tolerance, limit()});
                std::swap(found.point_a, found.point_b);
                offer(found, i);
            }
        }
    }
};

} // namespace

BoxSeparation separation(const BoxTree& tree, const ExactBody& body,
                         const Transform& body_from_tree, const Vec3& sweep,
                         const SeparationGoal& goal) {
    BodySearch search{{goal, {}, infinity}, tree, body, body_from_tree, sweep};
    if (!tree.nodes.empty()) search.visit(tree.nodes[0]);
    return search.result();
}

BoxSeparation separation(const BoxTree& a, const BoxTree& b, const Transform& a_from_b,
                         const Vec3& sweep, const SeparationGoal& goal) {
    PairSearch search{{goal, {}, infinity}, a, b, a_from_b, sweep};
    if (!a.nodes.empty() && !b.nodes.empty()) search.visit(a.nodes[0], b.nodes[0]);
    return search.result();
}

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
