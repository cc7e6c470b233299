#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/result.h"
#include "core/base/vec.h"
#include "core/geom/mesh.h"

namespace app {

/// A point of a plan, mm.
using PlanPoint = std::array<double, 2>;

/// A convex polygon, counter-clockwise.
using Outline = std::vector<PlanPoint>;

/// The greatest deviation of a polygon from the circle that it replaces, mm.
inline constexpr double round_deviation = 0.05;

/// The rectangle between two opposite corners.
Outline rectangle(const PlanPoint& low, const PlanPoint& high);

/// A polygon around a circle: it contains the circle, touches it in the four axis directions, and
/// is nowhere more than `round_deviation` outside.
Outline around_circle(const PlanPoint& centre, double radius);

/// A polygon in a circle, for a hole: the circle contains it, it meets the circle in the four axis
/// directions, and is nowhere more than `round_deviation` inside.
Outline within_circle(const PlanPoint& centre, double radius);

/// A regular hexagon with two sides along the first axis, `across` from each other.
Outline hexagon(const PlanPoint& centre, double across);

/// The outline, turned about the origin by an angle with this cosine and sine.
Outline turned(Outline outline, double cosine, double sine);

/// A prism that fills space, or empties it.
struct PresetPrism {
    Outline outline;
    double low, high; // its ends
    bool fills;
};

/// A solid of prisms that all extend along one axis: what is added later joins with what is there,
/// what is cut is taken away from what was added before.
///
/// The outlines divide the plan into convex pieces, the ends of the prisms divide the axis into
/// layers; the surface lies between the pieces of layers that are filled and those that are not. So
/// it has neither overlaps nor gaps.
class PresetSolid {
public:
    /// `axis`: 0, 1, 2 for X, Y, Z. The plan has the next two axes, in turn: YZ, ZX, XY.
    explicit PresetSolid(int axis) : axis_(axis) {}

    /// Fills, or empties, a prism from `low` to `high` along the axis. One of no length is nothing.
    void add(Outline outline, double low, double high);
    void cut(Outline outline, double low, double high);

    /// The closed surface, facing outwards. Points and planes nearer than 1e-7 mm become one.
    ///
    /// Errors:  invalid_value if nothing is filled, if it is in several pieces, if parts of it
    /// touch
    ///          along an edge or in a point only, or if sides nearly coincide.
    /// Cost:    some n^2 for n corners of outlines: 0.1 s for 1000.
    core::Result<core::Mesh> mesh() const;

private:
    int axis_;
    std::vector<PresetPrism> prisms_;
};

} // namespace app
