#pragma once

#include <span>

#include "core/distance/box_tree_distance.h"
#include "core/distance/measured_body.h"

namespace core {

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

/// Whether the bodies surely share a point although lengths may be wrong by up to `error`. `near`
/// is what separation() found; `false` says nothing.
///
/// Proof: README.md beside this file, "Overlap".
bool certainly_meet(const BodySide& a, const BodySide& b, const BodyMotion& motion,
                    const SideSeparation& near, double error);

} // namespace core
