#pragma once

#include "core/distance/body_distance.h"
#include "core/distance/box_tree.h"

namespace core {

/// How far the boxes of a tree, taken together, are from something else, and the box that gave
/// `upper`.
struct BoxSeparation {
    Separation separation;
    uint32_t box_a = 0; // by its index in the tree
};

/// The least distance from the boxes of a tree, moved by `sweep` from where they stand, to a body,
/// insides included.
///
/// Frame:  that of the body; the tree is A.
/// Result: as separation() of two bodies.
BoxSeparation separation(const BoxTree& tree, const ExactBody& body,
                         const Transform& body_from_tree, const Vec3& sweep,
                         const SeparationGoal& goal = {});

/// The least distance between the boxes of two trees while those of B move by `sweep`.
///
/// Frame:  that of A.
BoxSeparation separation(const BoxTree& a, const BoxTree& b, const Transform& a_from_b,
                         const Vec3& sweep, const SeparationGoal& goal = {});

} // namespace core
