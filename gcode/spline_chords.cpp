#include "gcode/spline_chords.h"

#include <cmath>

namespace gcode {
namespace {

constexpr int most_chords_of_span = 1 << 20;

bool is_finite(SplinePoint place) { return std::isfinite(place.x) && std::isfinite(place.y); }

double distance_from_chord(SplinePoint place, SplinePoint from, SplinePoint to) {
    const double x = to.x - from.x, y = to.y - from.y;
    const double squared = x * x + y * y;
    const double along =
        squared > 0.0 ? ((place.x - from.x) * x + (place.y - from.y) * y) / squared : 0.0;
    const double share = std::fmin(std::fmax(along, 0.0), 1.0);
    return std::hypot(place.x - from.x - share * x, place.y - from.y - share * y);
}

/// The curve from a knot to the next in equal steps of its parameter.
std::vector<SplinePoint> chords_of_span(const NurbsCurve& curve, int span, int count) {
    std::vector<SplinePoint> ends;
    for (int i = 1; i <= count; ++i)
        ends.push_back(point_at(curve, span + static_cast<double>(i) / count));
    return ends;
}

/// Whether chords stay near the curve. Between knots a curve of this order bends at most a few
/// times, so that within one of many chords it is seen at its quarters; half of the tolerance is
/// kept for what lies between them.
bool are_near(const NurbsCurve& curve, int span, SplinePoint from,
              const std::vector<SplinePoint>& ends, double tolerance) {
    const auto count = static_cast<double>(ends.size());
    for (size_t i = 0; i < ends.size(); ++i) {
        for (const double share : {0.25, 0.5, 0.75}) {
            const double parameter = span + (static_cast<double>(i) + share) / count;
            if (distance_from_chord(point_at(curve, parameter), from, ends[i]) > tolerance / 2.0)
                return false;
        }
        from = ends[i];
    }
    return true;
}

} // namespace

core::Result<std::vector<SplinePoint>> chords_within(const NurbsCurve& curve, double tolerance) {
    std::vector<SplinePoint> all;
    SplinePoint from = curve.points.front().at;
    for (int span = 0; span < curve.spans(); ++span) {
        std::vector<SplinePoint> ends;
        for (int count = 4 * curve.order;; count *= 2) {
            if (count > most_chords_of_span)
                return core::fail(core::ErrorCode::invalid_value,
                                  "this spline bends too sharply: its weights nearly cancel");
            ends = chords_of_span(curve, span, count);
            for (const SplinePoint end : ends)
                if (!is_finite(end))
                    return core::fail(core::ErrorCode::invalid_value,
                                      "the weights of this spline cancel: it leads infinitely far "
                                      "away; make all P positive");
            if (are_near(curve, span, from, ends, tolerance)) break;
        }
        all.insert(all.end(), ends.begin(), ends.end());
        from = all.back();
    }
    all.back() = curve.points.back().at;
    return all;
}

} // namespace gcode
