#pragma once

#include "core/distance/body_distance.h"

namespace core {

struct Dbm;
struct RevolvedProfile;

/// How deep a point is inside a body: a lower bound of its distance from the surface; negative
/// outside, where the body is at most that far away.
///
/// Shape: convex shapes must have a single place.
double inner_depth(const ExactBody& body, const Vec3& point);

/// The same for a body of revolution: the greatest of its pieces.
double inner_depth(const RevolvedProfile& profile, const Vec3& point);

/// How a covered radius is to be found.
struct CoverGoal {
    double limit = infinity; // mm: more is not needed
    double enough = 0.0;     // mm: what is not more is not needed either
    int axis = -1;           // of the only family of scan lines to use; -1: the best of all
    int fineness = 6;        // squares in a radius: more give a larger radius
};

/// A radius, and the family of scan lines that proves it.
struct CoveredRadius {
    double radius = 0.0;
    int axis = -1;
};

/// The radius of a ball in which every point is closer than `reach` to the model's material: a ball
/// of radius `reach` meets the material wherever it is moved by less than the result.
///
/// Result: a lower bound, from the material on the scan lines; 0 if it is not more than
///         `goal.enough`.
/// Cost:   some 5,000 intervals for each family at the default fineness.
CoveredRadius covered_radius(const Dbm& model, const Vec3& centre, double reach,
                             const CoverGoal& goal);

} // namespace core
