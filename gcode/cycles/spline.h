#pragma once

#include <optional>
#include <vector>

#include "core/base/result.h"

namespace gcode {

/// A place in the XY plane, mm.
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
/// runs from 0 to `spans`, and the knots between are whole numbers.
struct NurbsCurve {
    std::vector<ControlPoint> points; // at least `order` of them
    int order = 3;                    // the degree and one

    int spans() const { return static_cast<int>(points.size()) - order + 1; }
    bool operator==(const NurbsCurve&) const = default;
};

/// The words of a G5 block besides its end; lengths in mm.
struct CubicWords {
    std::optional<double> i, j; // from the start to the first inner control point
    std::optional<double> p, q; // from the end to the second
    SplinePoint end;
};

/// A cubic spline, and the I and J of the next one if that block has none.
struct CubicSpline {
    NurbsCurve curve;
    SplinePoint next_tangent;
};

/// The curve of G5. `tangent` stands for I and J where the block has neither: `next_tangent` of the
/// last G5 of the program, whatever moved since then, and 0, 0 before the first.
///
/// Errors: I without J or J without I; P or Q missing.
core::Result<CubicSpline> cubic_spline(SplinePoint start, SplinePoint tangent,
                                       const CubicWords& words);

/// The curve of G5.1: I and J lead from the start to the inner control point.
///
/// Errors: I or J missing.
core::Result<NurbsCurve> quadratic_spline(SplinePoint start, std::optional<double> i,
                                          std::optional<double> j, SplinePoint end);

/// The words of a G5.2 block, or of a block without a G code while G5.2 is on. X and Y are ends in
/// program coordinates, mm: under G91 they count from where the curve starts, in every block.
struct ControlPointWords {
    std::optional<double> x, y;
    std::optional<double> weight; // P
    std::optional<int> order;     // L
};

/// What G5.2 has gathered so far; a default one before the first of them.
struct NurbsGathering {
    std::vector<ControlPoint> points;
    int order = 3;

    bool operator==(const NurbsGathering&) const = default;
};

/// Orders above this are refused: LinuxCNC, which doubles its effort with each, would not finish.
constexpr int greatest_nurbs_order = 20;

/// Takes in a block of G5.2. The first one adds the start as well: with the weight P if the block
/// has no X and Y, else with 1. L raises the order from 3; a smaller one than that, or than an
/// earlier one, behaves as in LinuxCNC: up to 3 it is passed over.
///
/// A first block with X and Y but without P gives that control point the weight -1, as in LinuxCNC:
/// the curve then leaves the hull of its points, so the caller should warn.
///
/// Errors: X without Y or Y without X; after the first block, P without X and Y, or no positive P;
/// an order above greatest_nurbs_order. The gathering is then as before.
core::Result<void> add_control_point(NurbsGathering& gathering, SplinePoint start,
                                     const ControlPointWords& words);

/// The curve of G5.3.
///
/// Errors: nothing gathered, or fewer control points than the order.
core::Result<NurbsCurve> finish_nurbs(const NurbsGathering& gathering);

/// The place on the curve at a parameter from 0 to `spans`.
///
/// Result: infinite where weights cancel, which takes one that is not positive.
/// Cost: the square of the order.
/// Source: C. de Boor, "On calculating with B-splines", Journal of Approximation Theory 6 (1972).
SplinePoint point_at(const NurbsCurve& curve, double parameter);

/// The ends of the straight feeds by which LinuxCNC's preview follows the curve: 15 to a control
/// point, at equal steps of the parameter.
///
/// Result: the last one is the last control point. Rounding may add one just before it, as there.
/// Errors: weights cancel on the way.
core::Result<std::vector<SplinePoint>> preview_chords(const NurbsCurve& curve);

/// What the blocks of splines leave behind for one another.
struct SplineState {
    NurbsGathering gathering{}; // since G5.2
    SplinePoint next_tangent{}; // I and J of a G5 that has none

    bool operator==(const SplineState&) const = default;
};

/// The ends of straight feeds along a curve, of which none is farther from it than the tolerance,
/// in mm. Where knots join the spans of the curve there is an end as well.
///
/// Result: the last one is the last control point.
/// Errors: weights cancel on the way; more than a million chords would be needed.
core::Result<std::vector<SplinePoint>> chords_within(const NurbsCurve& curve, double tolerance);

} // namespace gcode
