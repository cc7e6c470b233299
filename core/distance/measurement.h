#pragma once

#include <optional>
#include <string>

#include "core/distance/measured_body.h"
#include "core/geom/rigid_motion.h"

namespace core {

/// What is to be measured, and how closely.
struct MeasureGoal {
    Vec3 sweep = Vec3(0.0);  // B moves on by this; the least distance on the way counts
    double limit = infinity; // mm: beyond it nobody asks
    double tolerance = 1e-7; // mm: how far a search for exact bodies may leave its interval open
    std::optional<PointPair> first; // of the scan points, compared before all others
};

/// How near two bodies are: lower <= true distance <= upper.
struct Measurement {
    ClosestPair scan;   // the closest pair of scan points: the paper's answer
    double lower = 0.0; // mm; at most the goal's limit
    double upper =
        infinity; // of two points that exist; infinite when none are nearer than the limit
    Vec3 witness_a = Vec3(0.0); // on A and on B, as far apart as `upper` says; B's at the time `at`
    Vec3 witness_b = Vec3(0.0);
    double at = 0.0;    // 0..1 of the sweep
    std::string reason; // why `lower` is 0 though the bodies may be apart; else empty
};

/// Measures B, placed by `a_from_b` and moved on by the goal's sweep, against A.
///
/// Frame:  the result is in that of A.
/// Result: lower <= true distance <= upper, rounding included, insides being part of the bodies:
///         0 when one overlaps or holds the other. `upper` is at most the distance of the scan
///         points, up to rounding. Of bodies known exactly the interval is as wide as the tolerance
///         and rounding; of a scanned one as its outer model leaves open; without one `lower` is 0.
/// Errors: those of DistanceEngine::closest_pair; a tolerance that is no length.
Result<Measurement> measure(const DistanceEngine& engine, const MeasuredBody& a,
                            const MeasuredBody& b, const Transform& a_from_b,
                            const MeasureGoal& goal = {});

/// The tolerance of a measurement over a motion that turns is at least this, mm.
constexpr double least_turning_tolerance = 1e-3;

/// Measures B against A over a whole rigid motion; `at` is 0..1 of it.
///
/// Result: lower <= least true distance on the way <= upper, as above; bodies known exactly leave
///         no more open than the goal's tolerance, at least `least_turning_tolerance`.
/// Errors: as above; a goal with a sweep.
/// Cost:   some ten to some hundred measurements where the bodies come near at one time; one for
///         every so many times the tolerance that B's farthest point moves where they stay equally
///         near.
/// Proof:  README.md beside this file, "Motions".
Result<Measurement> measure(const DistanceEngine& engine, const MeasuredBody& a,
                            const MeasuredBody& b, const RigidMotion& motion,
                            const MeasureGoal& goal = {});

} // namespace core
