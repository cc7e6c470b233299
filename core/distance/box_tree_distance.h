#pragma once

#include <optional>
#include <span>

#include "core/distance/body_distance.h"
#include "core/distance/box_tree.h"
#include "core/distance/measured_body.h"

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

/// One of two bodies as a search sees it: exact parts, or boxes that stand for it.
struct BodySide {
    std::span<const ExactPart> parts;
    const BoxTree* boxes = nullptr;

    bool is_exact() const { return boxes == nullptr; }
};

/// Where B stands against A, and how it moves on. Frame: that of A.
struct BodyMotion {
    Transform a_from_b;
    Vec3 sweep = Vec3(0.0);
};

/// The nearest of all parts or boxes of one side, and which of them `upper` belongs to.
struct SideSeparation {
    Separation separation;
    size_t part_a = 0, part_b = 0; // index of a part, or of a box of A or B
};

/// The least distance of two sides over the motion, insides included.
///
/// Frame:  that of A.
/// Result: as separation() of two bodies.
SideSeparation separation(const BodySide& a, const BodySide& b, const BodyMotion& motion,
                          const SeparationGoal& goal = {});

/// A point that two bodies have in common, and when in the sweep (0..1).
struct SharedPoint {
    Vec3 point;
    double time;
};

/// A point that the bodies surely share although lengths may be wrong by up to `error`; nothing
/// proves nothing. `near` is what separation() found.
///
/// Frame:  that of A.
/// Result: the point lies in one body however lengths are rounded, and in the other or within
///         `error` of it; not where `near` is, whose points may be as far apart as its tolerance.
/// Proof:  README.md beside this file, "Overlap".
std::optional<SharedPoint> certainly_shared(const BodySide& a, const BodySide& b,
                                            const BodyMotion& motion, const SideSeparation& near,
                                            double error);

} // namespace core
