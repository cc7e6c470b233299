#pragma once

#include "core/distance/measurement.h"
#include "tests/support/known_body.h"

namespace test_support {

/// Where two bodies were meant to stand.
enum class Meeting { near, far, touching, overlapping, nested };

/// Two bodies, how they stand and move, and how far they truly are apart.
struct KnownPair {
    const KnownBody* a = nullptr;
    const KnownBody* b = nullptr;
    core::Transform a_from_b;
    core::MeasureGoal goal;
    Meeting meeting = Meeting::near;
    Real truth = 0;
    bool is_to_the_bit = false; // the truth is that of the very doubles of the pose

    /// How large the lengths are that enter it.
    double reach() const {
        return a->body.reach + b->body.reach + glm::length(a_from_b.translation)
               + glm::length(goal.sweep);
    }
};

} // namespace test_support
