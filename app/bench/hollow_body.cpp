#include "app/bench/hollow_body.h"

#include <cmath>

namespace app {
namespace {

core::IntervalList symmetric(double half) {
    return core::IntervalList(core::Interval{-half, half});
}

/// Half the chord that a circle cuts off a line at this distance from its centre; 0 beside it.
double half_chord(double radius, double distance) {
    return std::sqrt(std::max(0.0, radius * radius - distance * distance));
}

/// A line across Z, `aside` from the axis, between two circles round it.
core::IntervalList across_ring(double outer, double inner, double aside) {
    core::IntervalList matter = symmetric(half_chord(outer, aside));
    const double hole = half_chord(inner, aside);
    matter.subtract({-hole, hole});
    return matter;
}

} // namespace

core::IntervalList line_of(const Torus& torus, int axis, double u, double v) {
    if (axis == 2) return symmetric(half_chord(torus.tube, std::hypot(u, v) - torus.ring));
    const double aside = axis == 0 ? u : v, height = axis == 0 ? v : u;
    const double half = half_chord(torus.tube, height);
    if (half == 0.0) return {};
    return across_ring(torus.ring + half, torus.ring - half, aside);
}

core::IntervalList line_of(const Cup& cup, int axis, double u, double v) {
    const double top = 0.5 * cup.height, floor = top - cup.depth;
    if (axis == 2) {
        const double from_axis = std::hypot(u, v);
        if (from_axis >= cup.radius) return {};
        return core::IntervalList(core::Interval{-top, from_axis < cup.bore ? floor : top});
    }
    const double aside = axis == 0 ? u : v, height = axis == 0 ? v : u;
    if (height < -top || height >= top) return {};
    return across_ring(cup.radius, height < floor ? 0.0 : cup.bore, aside);
}

core::Aabb bounds(const Torus& torus) {
    const core::Vec3 corner(torus.ring + torus.tube, torus.ring + torus.tube, torus.tube);
    return {-corner, corner};
}

core::Aabb bounds(const Cup& cup) {
    const core::Vec3 corner(cup.radius, cup.radius, 0.5 * cup.height);
    return {-corner, corner};
}

} // namespace app
