#include "core/dbm/lane_plan.h"

#include "core/base/math.h"
#include "core/dbm/scan_lines.h"

namespace core {
namespace {

/// Shorter components of a move are ignored, mm; the effect is below the error bound of computed
/// ends.
constexpr double least_move = 1e-10;

/// An end of a swept segment as the lanes store it.
double on_lattice(double x) { return std::nearbyint(x * ends_per_mm) * (1.0 / ends_per_mm); }

/// Parameters common to a ball and a circle; `steep` is the inclination of the swept surface along
/// the lines, 0 for a circle.
CapsuleLanes capsule(const CutterSweep& sweep, int axis, double z0, double radius) {
    const int ua = u_axis(axis), va = v_axis(axis);
    Vec3 from = sweep.from;
    from.z += z0;
    const Vec3 by = sweep.to - sweep.from;
    CapsuleLanes c{};
    c.from_a = from[axis];
    c.from_u = from[ua];
    c.from_v = from[va];
    c.by_a = by[axis];
    c.reach_low = c.from_a + std::min(0.0, c.by_a);
    c.reach_high = c.from_a + std::max(0.0, c.by_a);
    c.radius = radius;
    c.length = std::sqrt(by[ua] * by[ua] + by[va] * by[va]);
    c.u_most = c.v_most = infinity;
    if (c.length > least_move) {
        c.cos_u = by[ua] / c.length;
        c.cos_v = by[va] / c.length;
        c.per_length = 1.0 / c.length;
    } else {
        c.cos_u = 1.0;
        c.cos_v = c.length = c.per_length = 0.0;
    }
    return c;
}

/// A ball begins where the cylinder that it sweeps does, at the moment when it touches there.
CapsuleLanes ball_lanes(const CutterSweep& sweep, int axis, const ProfileElement& e) {
    CapsuleLanes c = capsule(sweep, axis, e.z0, e.margin);
    const double whole = std::sqrt(c.length * c.length + c.by_a * c.by_a);
    const double lean = whole > 0.0 ? c.by_a / whole * c.per_length : 0.0;
    c.low_by_half = -lean;
    c.high_by_half = lean;
    constexpr double steepest = 16.0; // with a rough root, errors of the ends stay below 1e-10 mm
    c.steep = c.length > 0.0 && whole > steepest * c.length;
    if (c.length == 0.0) {
        c.low_at = c.by_a < 0.0 ? 1.0 : 0.0;
        c.high_at = c.by_a > 0.0 ? 1.0 : 0.0;
    }
    return c;
}

/// The segment of a cylinder begins and ends at its faces, when the line enters or leaves.
CapsuleLanes upright_lanes(const CutterSweep& sweep, const ProfileElement& e) {
    CapsuleLanes c = capsule(sweep, 2, 0.0, e.r0);
    c.low_end = e.z0;
    c.high_end = e.z1;
    c.reach_low += e.z0;
    c.reach_high += e.z1;
    c.low_by_half = c.by_a < 0.0 ? c.per_length : -c.per_length;
    c.high_by_half = -c.low_by_half;
    if (c.length == 0.0) {
        c.low_at = c.by_a < 0.0 ? 1.0 : 0.0;
        c.high_at = 1.0 - c.low_at;
    }
    return c;
}

AcrossLanes across_lanes(const CutterSweep& sweep, int axis, const ProfileElement& e) {
    const int side = 1 - axis;
    const Vec3 by = sweep.to - sweep.from;
    AcrossLanes c{};
    c.side_is_u = u_axis(axis) == side;
    c.from_a = sweep.from[axis];
    c.from_side = sweep.from[side];
    c.from_z = sweep.from.z;
    c.by_a = by[axis];
    c.reach_low = c.from_a + std::min(0.0, c.by_a);
    c.reach_high = c.from_a + std::max(0.0, c.by_a);
    c.by_side = by[side];
    c.by_z = by.z;
    c.radius = e.r0;
    c.z0 = e.z0;
    c.z1 = e.z1;
    c.per_z = std::abs(by.z) > least_move ? 1.0 / by.z : 0.0;
    if (std::abs(by[side]) > least_move) {
        c.per_side = 1.0 / by[side];
        // The circle's foremost points across its own path.
        const double whole = std::sqrt(c.by_a * c.by_a + c.by_side * c.by_side);
        c.by_radius = c.by_a / (whole * std::abs(c.by_side));
    } else {
        c.by_side = 0.0;
        c.low_at = c.by_a < 0.0 ? 1.0 : 0.0;
        c.high_at = 1.0 - c.low_at;
    }
    return c;
}

ElementLanes element_lanes(const CutterSweep& sweep, int axis, const ProfileElement& e,
                           bool sloped) {
    ElementLanes lanes{e, {}, {}, sloped, {-infinity, infinity}};
    if (axis == 2) {
        lanes.path = capsule(sweep, axis, 0.0, std::max(e.r0, e.r1) + e.margin);
    } else {
        lanes.across = across_lanes(sweep, axis, e);
        lanes.matters = {std::min(sweep.from.z, sweep.to.z) + e.z0 - e.margin,
                         std::max(sweep.from.z, sweep.to.z) + e.z1 + e.margin};
    }
    return lanes;
}

/// For each element of a convex profile, the distances from the axis at which it may be the lowest
/// or the highest on a line along Z. Elements are ordered by height.
std::vector<Interval> distances_that_matter(const std::vector<ProfileElement>& all) {
    const size_t count = all.size();
    std::vector<Interval> distances(count, Interval{infinity, -infinity});
    const auto rim = [](const ProfileElement& e) { return std::max(e.r0, e.r1); };
    const auto visit = [&](const auto& nth, const auto& is_beyond) {
        // Out to this distance, an element that ends before the present one begins hides it.
        double hidden = -infinity;
        size_t passed = 0;
        for (size_t i = 0; i < count; ++i) {
            const ProfileElement& e = all[nth(i)];
            for (; passed < i && is_beyond(e, all[nth(passed)]); ++passed)
                hidden = std::max(hidden, rim(all[nth(passed)]));
            const double reach = rim(e) + e.margin;
            Interval& seen = distances[nth(i)];
            if (reach > hidden) seen = {std::min(seen.lower, hidden), reach};
        }
    };
    visit([](size_t i) { return i; },
          [](const ProfileElement& e, const ProfileElement& lower) {
              return lower.z1 <= e.z0 - e.margin;
          });
    visit([&](size_t i) { return count - 1 - i; },
          [](const ProfileElement& e, const ProfileElement& higher) {
              return higher.z0 >= e.z1 + e.margin;
          });
    return distances;
}

/// Whether a move is sloped by more than rounding.
bool is_sloped(const CutterSweep& sweep) {
    constexpr double least_part = 1e-6;
    const Vec3 by = sweep.to - sweep.from;
    return std::abs(by.z) > least_part && core::hypot(by.x, by.y) > least_part;
}

bool is_ball(const ProfileElement& e) { return e.margin > 0.0 && e.r0 == 0.0 && e.r1 == 0.0; }
bool is_cylinder(const ProfileElement& e) { return e.margin == 0.0 && e.r0 == e.r1 && e.z0 < e.z1; }

/// Whether ball `i` has a shaft of its own width from its centre up.
bool has_shaft(const std::vector<ProfileElement>& all, size_t i) {
    return i + 1 < all.size() && is_cylinder(all[i + 1]) && all[i + 1].r0 == all[i].margin
           && all[i + 1].z0 == all[i].z0 && all[i + 1].z1 >= all[i].z0 + all[i].margin;
}

/// Ends the segments at the height that the body always reaches, if that is above all stock.
bool open_up(CapsuleLanes& c, double reached, double top) {
    if (reached < top) return false;
    c.opens_up = true;
    c.high_end = c.reach_high = reached;
    return true;
}

/// The box around what a tilted piece sweeps, aligned with its axis and with its way across it.
std::array<SlabLanes, 3> slabs_around(const RevolvedProfile& convex, const CutterSweep& sweep,
                                      int axis) {
    constexpr double slack = 1e-6, least_part = 1e-9; // mm
    const Vec3 up = sweep.orientation[2], by = sweep.to - sweep.from;
    const Vec3 aside = by - glm::dot(by, up) * up;
    const double way = glm::length(aside);
    const Vec3 along = way > least_part ? aside / way : sweep.orientation[0];
    const Aabb body = bounds(convex);
    const double radius = body.max.x;
    const std::array<Vec3, 3> normals = {along, glm::cross(up, along), up};
    std::array<SlabLanes, 3> slabs;
    for (size_t i = 0; i < slabs.size(); ++i) {
        const Vec3& n = normals[i];
        const double from = glm::dot(n, sweep.from), to = glm::dot(n, sweep.to);
        const bool is_axis = i == 2;
        slabs[i] = {.normal_u = n[u_axis(axis)],
                    .normal_v = n[v_axis(axis)],
                    .per_a = std::abs(n[axis]) > least_part ? 1.0 / n[axis] : 0.0,
                    .low = std::min(from, to) + (is_axis ? body.min.z : -radius) - slack,
                    .high = std::max(from, to) + (is_axis ? body.max.z : radius) + slack};
    }
    return slabs;
}

/// The form that is negative inside a cone: x x' + y y' - r r'.
double form(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y - a.z * b.z; }

/// Prepares a cone for lanes; false if lines lie along its flank or the motion along its faces so
/// nearly that only `tilted_line_interval` is accurate.
bool prepare_tilted(const CutterSweep& sweep, int axis, const ProfileElement& e, TiltedLanes& c) {
    const Mat3 tool_from_stock = glm::transpose(sweep.orientation);
    Vec3 along(0.0), u(0.0), v(0.0), origin = -sweep.from;
    along[axis] = u[u_axis(axis)] = v[v_axis(axis)] = 1.0;
    origin[axis] = 0.0;
    const Vec3 by = sweep.to - sweep.from;
    c = {};
    c.origin = tool_from_stock * origin;
    c.by_u = tool_from_stock * u;
    c.by_v = tool_from_stock * v;
    c.from_a = sweep.from[axis];
    c.length = glm::length(by);
    c.d = tool_from_stock * along;
    c.m = c.length > 0.0 ? tool_from_stock * (by / c.length) : Vec3(0.0);
    c.z0 = e.z0;
    c.z1 = e.z1;
    c.r0 = e.r0;
    c.r1 = e.r1;
    c.slope = (e.r1 - e.r0) / (e.z1 - e.z0);
    // As (x, y, radius); their third components are those of directions.
    const Vec3 d(c.d.x, c.d.y, c.slope * c.d.z), m(c.m.x, c.m.y, c.slope * c.m.z);
    c.chord_a = form(d, d);
    if (!(std::abs(c.chord_a) > 0.01 * glm::dot(d, d))) return false;
    if (c.length == 0.0) return true;

    constexpr double least_steep = 1e-6;
    const double steep = std::sqrt(c.d.z * c.d.z + c.m.z * c.m.z);
    if (steep > 0.0) {
        if (steep < least_steep) return false;
        c.face_s = c.d.z / (steep * steep);
        c.face_t = -c.m.z / (steep * steep);
        c.face_s_by = c.m.z / steep;
        c.face_t_by = c.d.z / steep;
        c.face_e = c.face_s_by * c.d - c.face_t_by * c.m;
    }
    const double flat = form(m, m);
    const Vec3 w = glm::cross(d, m);
    const double across = glm::length(w);
    c.has_silhouette = flat > 0.0 && across > 0.0;
    if (!c.has_silhouette) return true;
    const Vec3 n = w / across, k = glm::cross(n, m);
    c.touch_n = n;
    // -dot(cross(p, m), n) = dot(p, cross(n, m)), and dot(cross(d, p), n) = dot(p, cross(n, d)).
    c.touch_s_foot = -glm::cross(m, n) / across;
    c.touch_t_foot = glm::cross(n, d) / across;
    // The zeros of form(n, n) y^2 + 2 form(n, k) y + form(k, k), with the discriminant `flat`.
    const double far = -form(n, k) - std::copysign(std::sqrt(flat), form(n, k));
    const double one = far == 0.0 ? 0.0 : far / form(n, n);
    const double other = far == 0.0 ? 0.0 : form(k, k) / far;
    c.touch_y = {one / across, other / across};
    c.touch_t_by_h = form(n, m) / flat;
    c.touch_t_by_s = form(d, m) / flat;
    return true;
}

/// Plans the piece of a tilted tool: by lanes if it consists of cones, cylinders and balls.
void plan_tilted(LanePlan& plan) {
    const CutterSweep& sweep = *plan.sweep;
    plan.slabs = slabs_around(*plan.piece, sweep, plan.axis);
    plan.has_slabs = true;
    for (const ProfileElement& e : plan.piece->elements) {
        bool fits = false;
        if (is_ball(e) && plan.balls < LanePlan::most) {
            // A ball is the same in every orientation.
            CutterSweep centred = sweep;
            centred.from += e.z0 * sweep.orientation[2];
            centred.to += e.z0 * sweep.orientation[2];
            plan.ball[plan.balls++] =
                ball_lanes(centred, plan.axis, {0.0, 0.0, 0.0, 0.0, e.margin});
            fits = true;
        } else if (e.margin == 0.0 && e.z0 < e.z1) {
            fits = prepare_tilted(sweep, plan.axis, e, plan.tilted.emplace_back());
        } else if (e.margin == 0.0) {
            continue; // no volume
        }
        if (fits) continue;
        plan.balls = 0;
        plan.tilted.clear();
        return;
    }
    plan.by_lanes = true;
}

} // namespace

LanePlan lane_plan(const RevolvedProfile& convex, const CutterSweep& sweep, int axis, double top) {
    LanePlan plan;
    plan.axis = axis;
    plan.piece = &convex;
    plan.sweep = &sweep;
    if (!is_upright(sweep.orientation)) {
        plan_tilted(plan);
        return plan;
    }
    const auto& all = convex.elements;
    const double lowest = std::min(sweep.from.z, sweep.to.z);
    const double highest = std::max(sweep.from.z, sweep.to.z);
    const bool level = sweep.from.z == sweep.to.z;
    const bool upright = sweep.from.x == sweep.to.x && sweep.from.y == sweep.to.y;
    const bool sloped = is_sloped(sweep);
    std::vector<Interval> distances;
    for (size_t i = 0; i < all.size(); ++i) {
        const ProfileElement& e = all[i];
        if (is_ball(e) && plan.balls < LanePlan::most) {
            CapsuleLanes& c = plan.ball[plan.balls++];
            c = ball_lanes(sweep, axis, e);
            if (!has_shaft(all, i)) continue;
            // Above its centre, the shaft contains the ball at every position.
            if (axis == 0) c.v_most = highest + e.z0;
            if (axis == 1) c.u_most = highest + e.z0;
            if (axis == 2 && open_up(c, lowest + all[i + 1].z1, top)) ++i;
        } else if (is_cylinder(e) && axis == 2 && plan.uprights < LanePlan::most) {
            CapsuleLanes& c = plan.upright[plan.uprights++];
            c = upright_lanes(sweep, e);
            open_up(c, lowest + e.z1, top);
            // Of several elements, what is between them is swept, too.
            c.level = level && all.size() == 1;
            if (c.level) {
                c.reach_low = on_lattice(c.from_a + c.low_end);
                c.reach_high = on_lattice(c.opens_up ? c.high_end : c.from_a + c.high_end);
            }
        } else if (is_cylinder(e) && axis != 2 && plan.across < LanePlan::most) {
            plan.sideways[plan.across++] = across_lanes(sweep, axis, e);
        } else if ((level || upright || sloped)
                   && (e.margin > 0.0 || (e.z0 < e.z1 && e.r0 != e.r1))) {
            plan.elements.push_back(element_lanes(sweep, axis, e, sloped));
            if (axis == 2 && all.size() > 1) {
                if (distances.empty()) distances = distances_that_matter(all);
                plan.elements.back().matters = distances[i];
            }
        } else {
            plan.balls = plan.uprights = plan.across = 0;
            plan.elements.clear();
            plan.slabs = slabs_around(convex, sweep, axis);
            plan.has_slabs = true;
            return plan;
        }
    }
    plan.by_lanes = true;
    return plan;
}

} // namespace core
