#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "core/base/result.h"
#include "core/base/vec.h"
#include "core/dbm/dbm.h"
#include "core/distance/closest_pair.h"

namespace core {

/// Index of a body in an engine, from 0.
enum class PointBody : uint32_t {};

/// Finds closest pairs of bodies given by points. All engines give the same distance to the last
/// bit; of equally near pairs, they may return different ones.
class DistanceEngine {
public:
    virtual ~DistanceEngine() = default;

    virtual std::string_view name() const = 0;

    /// Adds a body.
    ///
    /// Errors:  no points; a coordinate that is not finite or beyond 1e12 mm; more points than fit
    ///          into `memory_limit` bytes: the message states the need, and nothing is allocated.
    Result<PointBody> add(std::span<const Vec3> points, double memory_limit = default_memory_limit);

    /// The closest pair of points of two bodies.
    ///
    /// Frame:  the result is in that of A.
    /// Errors: a transform that is not rigid; a sweep or a goal that is not a number; a body or a
    ///         point that does not exist.
    Result<ClosestPair> closest_pair(PointBody a, PointBody b, const Transform& a_from_b,
                                     const PairGoal& goal = {}) const;

private:
    Result<void> check(PointBody a, PointBody b, const Transform& a_from_b,
                       const PairGoal& goal) const;
    virtual Result<PointBody> take_in(std::span<const Vec3> points) = 0;
    virtual double bytes_per_point() const = 0;
    virtual size_t points_of(PointBody body) const = 0; // 0: no such body
    virtual ClosestPair search(PointBody a, PointBody b, const Transform& a_from_b,
                               const PairGoal& goal) const = 0;
};

/// The search of the paper: a tree of spheres with one point per leaf.
std::unique_ptr<DistanceEngine> paper_engine();

/// A tree of oriented boxes, eight per node, sixteen points per leaf.
std::unique_ptr<DistanceEngine> fast_engine();

} // namespace core
