#pragma once

#include <optional>
#include <vector>

#include "core/base/result.h"

namespace gcode {

/// A point in the XY plane, mm.
struct SplinePoint {
    double x = 0.0, y = 0.0;

    bool operator==(const SplinePoint&) const = default;
};

struct ControlPoint {
    SplinePoint at;
    double weight = 1.0;

    bool operator==(const ControlPoint&) const = default;
};

/// A rational B-spline that starts at its first control point and ends at its last. Its parameter
/// runs from 0 to `spans`, and the inner knots are at whole numbers.
struct NurbsCurve {
    std::vector<ControlPoint> points; // at least `order` of them
    int order = 3;                    // degree + 1

    int spans() const { return static_cast<int>(points.size()) - order + 1; }
    bool operator==(const NurbsCurve&) const = default;
};

/// The words of a G5 block besides its end point; lengths in mm.
struct CubicWords {
    std::optional<double> i, j; // from the start to the first inner control point
    std::optional<double> p, q; // from the end to the second inner control point
    SplinePoint end;
};

/// A cubic spline, and the I and J for a following G5 without them.
struct CubicSpline {
    NurbsCurve curve;
    SplinePoint next_tangent;
};

/// The curve of G5. `tangent` replaces missing I and J: it is `next_tangent` of the previous G5 in
/// the program, regardless of moves in between, and 0, 0 before the first.
///
/// Errors: I without J or J without I; P or Q missing.
core::Result<CubicSpline> cubic_spline(SplinePoint start, SplinePoint tangent,
                                       const CubicWords& words);

/// The curve of G5.1. I and J are the offset from the start to the inner control point.
///
/// Errors: I or J missing.
core::Result<NurbsCurve> quadratic_spline(SplinePoint start, std::optional<double> i,
                                          std::optional<double> j, SplinePoint end);

/// The words of a G5.2 block, or of a block without a G code while G5.2 is active. X and Y are end
/// points in program coordinates, mm; with G91, relative to the start of the curve in each block.
struct ControlPointWords {
    std::optional<double> x, y;
    std::optional<double> weight; // P
    std::optional<int> order;     // L
};

/// The control points that G5.2 has collected so far; empty before the first.
struct NurbsGathering {
    std::vector<ControlPoint> points;
    int order = 3;

    bool operator==(const NurbsGathering&) const = default;
};

/// Highest accepted order. The effort of LinuxCNC doubles with each order, so it would not finish.
constexpr int greatest_nurbs_order = 20;

/// Adds a block of G5.2. The first block also adds the start point: with the weight P if the block
/// has no X and Y, else with 1. L raises the order from 3. As in LinuxCNC, an L up to 3 is ignored,
/// and any greater L replaces the order.
///
/// A first block with X and Y but without P gives its control point the weight -1, as in LinuxCNC.
/// The curve then leaves the hull of its points, so the caller should warn.
///
/// Errors: X without Y or Y without X; after the first block, P without X and Y, or no positive P;
///         an order above greatest_nurbs_order. Then nothing is added.
core::Result<void> add_control_point(NurbsGathering& gathering, SplinePoint start,
                                     const ControlPointWords& words);

/// The curve that a G5.3 completes.
///
/// Errors: no control points, or fewer than the order.
core::Result<NurbsCurve> finish_nurbs(const NurbsGathering& gathering);

/// The point on the curve at a parameter from 0 to `spans`.
///
/// Result: infinite where weights cancel out, which needs a weight that is not positive.
/// Cost:   quadratic in the order.
/// Source: C. de Boor, "On calculating with B-splines", Journal of Approximation Theory 6 (1972).
SplinePoint point_at(const NurbsCurve& curve, double parameter);

/// The state that spline blocks pass on to each other.
struct SplineState {
    NurbsGathering gathering{}; // collected since G5.2
    SplinePoint next_tangent{}; // I and J for a G5 without them

    bool operator==(const SplineState&) const = default;
};

/// End points of straight feed moves that deviate from the curve by at most the tolerance, in mm.
/// Each knot between spans is an end point too.
///
/// Result: ends at the last control point.
/// Errors: the weights cancel out somewhere; more than a million chords would be needed.
core::Result<std::vector<SplinePoint>> chords_within(const NurbsCurve& curve, double tolerance);

} // namespace gcode
