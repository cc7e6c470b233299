#include "gcode/contour/spline.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/vec.h"

namespace gcode {
namespace {

using core::ErrorCode;

SplinePoint sum(SplinePoint a, SplinePoint b) { return {a.x + b.x, a.y + b.y}; }

/// A control point multiplied by its weight, with the weight as third coordinate.
struct Homogeneous {
    double x, y, weight;
};

Homogeneous between(const Homogeneous& a, const Homogeneous& b, double t) {
    return {(1.0 - t) * a.x + t * b.x, (1.0 - t) * a.y + t * b.y,
            (1.0 - t) * a.weight + t * b.weight};
}

} // namespace

core::Result<CubicSpline> cubic_spline(SplinePoint start, SplinePoint tangent,
                                       const CubicWords& words) {
    if (words.i.has_value() != words.j.has_value())
        return core::fail(ErrorCode::missing_value,
                          fmt::format("G5 has {} but no {}: it needs both, or neither to continue "
                                      "in the direction of the previous G5",
                                      words.i ? 'I' : 'J', words.i ? 'J' : 'I'));
    if (!words.p || !words.q)
        return core::fail(
            ErrorCode::missing_value,
            "G5 needs both P and Q, the offset from its end point to the second control point");
    if (words.i) tangent = {*words.i, *words.j};
    const SplinePoint before_end = sum(words.end, {*words.p, *words.q});
    return CubicSpline{{{{start}, {sum(start, tangent)}, {before_end}, {words.end}}, 4},
                       {-*words.p, -*words.q}};
}

core::Result<NurbsCurve> quadratic_spline(SplinePoint start, std::optional<double> i,
                                          std::optional<double> j, SplinePoint end) {
    if (!i || !j)
        return core::fail(
            ErrorCode::missing_value,
            "G5.1 needs both I and J, the offset from its start point to its control point");
    return NurbsCurve{{{start}, {sum(start, {*i, *j})}, {end}}, 3};
}

core::Result<void> add_control_point(NurbsGathering& gathering, SplinePoint start,
                                     const ControlPointWords& words) {
    const bool first = gathering.points.empty();
    if (words.x.has_value() != words.y.has_value())
        return core::fail(ErrorCode::missing_value,
                          fmt::format("this control point of G5.2 has {} but no {}: it needs both",
                                      words.x ? 'X' : 'Y', words.x ? 'Y' : 'X'));
    const bool positive = words.weight && *words.weight > 0.0;
    if (!first && positive && !words.x)
        return core::fail(ErrorCode::missing_value,
                          "G5.2 has a weight P without X and Y: only the first block may, for the "
                          "weight of the start point");
    if (!first && !positive)
        return core::fail(ErrorCode::invalid_value,
                          "each control point of G5.2 needs a positive weight P");
    if (words.order && *words.order > greatest_nurbs_order)
        return core::fail(
            ErrorCode::invalid_value,
            fmt::format("L{}: orders above {} are not supported, as they take too long to compute",
                        *words.order, greatest_nurbs_order));
    if (first) gathering = {{{start, positive && !words.x ? *words.weight : 1.0}}, 3};
    if (words.order && *words.order > 3) gathering.order = *words.order;
    if (words.x) gathering.points.push_back({{*words.x, *words.y}, words.weight.value_or(-1.0)});
    return {};
}

core::Result<NurbsCurve> finish_nurbs(const NurbsGathering& gathering) {
    if (gathering.points.empty())
        return core::fail(ErrorCode::missing_value, "G5.3 without a G5.2 before it");
    if (static_cast<int>(gathering.points.size()) < gathering.order)
        return core::fail(ErrorCode::missing_value,
                          fmt::format("the curve that G5.3 ends has {} control points including "
                                      "its start, too few for order {}: add points or lower L",
                                      gathering.points.size(), gathering.order));
    return NurbsCurve{gathering.points, gathering.order};
}

SplinePoint point_at(const NurbsCurve& curve, double parameter) {
    const int degree = curve.order - 1;
    const int spans = curve.spans();
    const int span = std::clamp(static_cast<int>(std::floor(parameter)), 0, spans - 1);
    const auto knot = [&](int index) {
        return static_cast<double>(std::clamp(index - degree, 0, spans));
    };
    std::vector<Homogeneous> d;
    for (int j = 0; j <= degree; ++j) {
        const ControlPoint& p = curve.points[static_cast<size_t>(span + j)];
        d.push_back({p.weight * p.at.x, p.weight * p.at.y, p.weight});
    }
    for (int level = 1; level <= degree; ++level)
        for (int j = degree; j >= level; --j) {
            const double from = knot(span + j), to = knot(span + j + degree - level + 1);
            const size_t at = static_cast<size_t>(j);
            d[at] = between(d[at - 1], d[at], (parameter - from) / (to - from));
        }
    double greatest = 0.0;
    for (int j = 0; j <= degree; ++j)
        greatest = std::max(greatest, std::abs(curve.points[static_cast<size_t>(span + j)].weight));
    const double weight = d.back().weight;
    if (!(std::abs(weight) > 1e-12 * greatest)) return {core::infinity, core::infinity};
    return {d.back().x / weight, d.back().y / weight};
}

} // namespace gcode
