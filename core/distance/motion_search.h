#pragma once

#include <functional>

#include "core/base/result.h"
#include "core/base/vec.h"
#include "core/distance/distance_engine.h"
#include "core/geom/rigid_motion.h"

namespace core {

/// The tolerance of a search through a motion that turns is at least this, mm; no point of B, and
/// none of the places it comes to, is farther than `reach` from its origin.
constexpr double least_motion_tolerance(double reach) { return 1e-6 + 1e-8 * reach; }

/// The closest pair of points of two bodies over a whole rigid motion of B, and when.
///
/// A part of the motion is searched with every point going straight, along its chord; the arcs
/// bulge out from the chords by a length that is subtracted. Parts that stay in question are
/// halved.
///
/// Frame:  the result is in that of A, at the time `at`, 0..1.
/// Result: `distance` is that of the points named at the time `at`, and `lower` bounds that of all
///         points at all times; unless any will do they are no more than the goal's tolerance apart
///         (at least least_motion_tolerance(); exact if nothing turns).
/// Errors: those of DistanceEngine::closest_pair; a goal with a sweep or an end; a motion that does
///         not lead to its end.
/// Cost:   a quarter turn of a 50 mm body to 1e-3 mm takes some ten searches where it comes near at
///         one time, some hundred where it is equally near all the way.
/// Proof:  README.md beside this file, "Motions".
Result<ClosestPair> closest_pair(const DistanceEngine& engine, PointBody a, PointBody b,
                                 const RigidMotion& motion, const PairGoal& goal = {});

/// What is known of a distance during a stretch of time.
struct StretchBound {
    double lower = 0.0;      // at no time of the stretch is it less
    double upper = infinity; // at some time it is this
    double gain = infinity;  // by how much `lower` may still grow in halves of the stretch
};

/// What a search through time should find out.
struct TimeGoal {
    double limit = infinity; // mm: distances from here on do not count
    bool any = false;        // any distance below the limit will do
    double tolerance = 1e-3; // mm
    double known = infinity; // mm: found at some time already
};

/// The least distance over the time 0..1, from bounds over parts of it.
///
/// The stretch with the least bound is asked about next, and halved when it stays in question. A
/// bound must become tight as its stretch becomes short. `bound(from, to, worth)` need not tell
/// lengths of `worth` and more apart.
///
/// Result: `lower` holds for all times and is at most the limit; `upper` is the least of what was
///         found below the limit, else infinite. Unless any will do, they are no more than the
///         tolerance apart, or a quarter of it and what `bound` itself leaves open.
/// Errors: those of `bound`.
Result<StretchBound> least_over_time(
    const std::function<Result<StretchBound>(double from, double to, double worth)>& bound,
    const TimeGoal& goal);

} // namespace core
