#pragma once

#include "core/dbm/interval.h"
#include "core/dbm/solid.h"

namespace test_support {

/// The intersections of scan lines, and of columns around them, with a torus: its section at a
/// height is a ring.
struct TorusLines {
    double ring, tube;

    static core::Interval along(double outer, double across) {
        const double half = std::sqrt(std::max(0.0, outer * outer - across * across));
        return {-half, half};
    }
    core::IntervalList line(int axis, double u, double v) const {
        if (axis == 2) {
            const double r = std::hypot(u, v) - ring;
            return std::abs(r) < tube ? core::IntervalList(along(tube, r)) : core::IntervalList();
        }
        return ring_at(std::abs(axis == 0 ? v : u), std::abs(axis == 0 ? u : v),
                       std::abs(axis == 0 ? u : v));
    }
    core::IntervalList column(int axis, const core::Square& s) const {
        const double u = std::max({s.x0, -s.x1, 0.0}), v = std::max({s.y0, -s.y1, 0.0});
        const double u_far = std::max(s.x1, -s.x0), v_far = std::max(s.y1, -s.y0);
        if (axis != 2) return axis == 0 ? ring_at(v, u, u_far) : ring_at(u, v, v_far);
        const double near = std::hypot(u, v) - ring, far = std::hypot(u_far, v_far) - ring;
        const double r = std::max({near, -far, 0.0});
        return r <= tube ? core::IntervalList(along(tube, r)) : core::IntervalList();
    }
    /// The intersection of a line with the section of the torus at height `z`: a ring from radius
    /// `near` to `far`.
    core::IntervalList ring_at(double z, double near, double far) const {
        if (z > tube) return {};
        const double half = along(tube, z).upper;
        if (near > ring + half) return {};
        core::IntervalList list(along(ring + half, near));
        if (far < ring - half) list.subtract(along(ring - half, far));
        return list;
    }
};

} // namespace test_support
