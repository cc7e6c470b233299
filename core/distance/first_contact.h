#pragma once

#include <optional>
#include <span>

#include "core/distance/body_distance.h"
#include "core/geom/placement.h"

namespace core {

/// A body where it stands; `pose` maps its frame to that of the machine.
struct PlacedBody {
    const ExactBody* body = nullptr;
    Transform pose;
};

/// How far a body can move before it touches another one.
struct FirstContact {
    double travel = 0.0; // mm, at least 0
    size_t support = 0;  // the body that it touches; a plane comes after all bodies
};

/// What counts as contact.
struct ContactGoal {
    double limit = infinity; // mm: contacts beyond it are not searched for
    double graze = 1e-6;     // mm: bodies pass each other if they overlap sideways by at most this
    double sunk = 0.01;      // mm: a body that has sunk into a support by at most this rests on it
};

/// How far a body can move straight until it first touches a support or a plane: it rests on it, or
/// clamps it.
///
/// Only the direction of `direction` counts, not its length. Planes are half-spaces, full on the
/// side away from their normals.
///
/// Frame:   the machine's.
/// Result:  within 1e-6 mm; the bodies overlap by at most `graze` then. Surfaces along the motion
///          do not stop it: a jaw slides on its bed. Neither does a contact that the motion opens,
///          nor a surface that the body has passed by more than `sunk`: so ask separation()
///          whether bodies overlap at the start. A plane that was passed gives 0. Empty if nothing
///          is touched, and for no direction.
/// Cost:    O(n log n) for n triangles in all, plus the pairs whose gap is less than the result; a
///          million triangles some 2 s.
std::optional<FirstContact> first_contact(const ExactBody& body, const Transform& pose,
                                          const Vec3& direction,
                                          std::span<const PlacedBody> supports,
                                          std::span<const FacePlane> planes = {},
                                          const ContactGoal& goal = {});

/// How far a body extends along a direction. `pose` maps it to the frame of the direction.
BodyExtent extent_along(const ExactBody& body, const Transform& pose, const Vec3& direction);

} // namespace core
