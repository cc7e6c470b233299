#pragma once

#include "core/distance/measurement.h"
#include "tests/support/known_body.h"

namespace test_support {

/// The intended relative position of two bodies.
enum class Meeting { near, far, touching, overlapping, nested };

/// Two bodies, their pose and motion, and their true distance.
struct KnownPair {
    const KnownBody* a = nullptr;
    const KnownBody* b = nullptr;
    core::Transform a_from_b;
    core::MeasureGoal goal;
    Meeting meeting = Meeting::near;
    Real truth = 0;
    bool is_to_the_bit = false; // the true distance holds for exactly the doubles of the pose

    /// The magnitude of the lengths involved.
    double reach() const {
        return a->body.reach + b->body.reach + glm::length(a_from_b.translation)
               + glm::length(goal.sweep);
    }
};

} // namespace test_support
