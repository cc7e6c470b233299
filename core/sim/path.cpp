#include "core/sim/path.h"

#include <algorithm>
#include <numbers>

namespace core {
namespace {

constexpr double seconds_per_minute = 60.0;

std::optional<Vec3> known(const AxisPosition& p) {
    if (!p[0] || !p[1] || !p[2]) return std::nullopt;
    return Vec3(*p[0], *p[1], *p[2]);
}

double rapid_speed(const MachineAxis& axis, Path& path) {
    if (!axis.rapid) path.assumed_speed = true;
    return axis.rapid.value_or(assumed_rapid);
}

/// Seconds each axis needs on its own.
Vec3 axis_times(const Vec3& by, const Machine& machine, Path& path) {
    Vec3 times(0.0);
    for (int i = 0; i < 3; ++i)
        if (by[i] != 0.0)
            times[i] = std::abs(by[i]) / rapid_speed(machine.axes[static_cast<size_t>(i)], path)
                       * seconds_per_minute;
    return times;
}

void add_straight(Path& path, const Machine& machine, const Vec3& from, const Vec3& to,
                  double duration) {
    path.legs.push_back(
        {{machine.place(from), machine.place(to)}, path.duration, path.duration + duration, 0.0});
    path.duration += duration;
}

/// Corners of the box of axis values between two places, in the machine frame.
std::vector<Vec3> box_corners(const Machine& machine, const Aabb& box) {
    std::vector<Vec3> corners;
    for (unsigned i = 0; i < 8; ++i) {
        const Vec3 corner(i & 1U ? box.max.x : box.min.x, i & 2U ? box.max.y : box.min.y,
                          i & 4U ? box.max.z : box.min.z);
        const Vec3 place = machine.place(corner);
        if (std::find(corners.begin(), corners.end(), place) == corners.end())
            corners.push_back(place);
    }
    return corners;
}

/// Each axis at its own speed: the path bends where an axis arrives.
void add_dogleg(Path& path, const Machine& machine, const Vec3& from, const Vec3& to) {
    const Vec3 times = axis_times(to - from, machine, path);
    const double total = std::max({times.x, times.y, times.z});
    if (path.assumed_speed) {
        Aabb box;
        box.extend(from);
        box.extend(to);
        path.legs.push_back({.places = box_corners(machine, box),
                             .end = total,
                             .straight = false,
                             .certain = {machine.place(from), machine.place(to)}});
        path.duration = total;
        return;
    }
    std::array<double, 3> bends = {times.x, times.y, times.z};
    std::sort(bends.begin(), bends.end());
    Vec3 here = from;
    double now = 0.0;
    for (const double bend : bends) {
        if (bend <= now) continue;
        Vec3 next = to;
        for (int i = 0; i < 3; ++i)
            if (bend < times[i]) next[i] = from[i] + (to[i] - from[i]) * (bend / times[i]);
        add_straight(path, machine, here, next, bend - now);
        here = next;
        now = bend;
    }
}

/// The place on an arc after a share of its angle, axis values.
Vec3 on_arc(const Motion& motion, const Vec3& from, const Vec3& to, double share) {
    const ArcPath& arc = *motion.arc;
    const int a = (arc.normal + 1) % 3, b = (arc.normal + 2) % 3;
    const double u = from[a] - arc.centre[a], v = from[b] - arc.centre[b];
    const double end_radius = std::hypot(to[a] - arc.centre[a], to[b] - arc.centre[b]);
    const double radius = std::hypot(u, v);
    // A small difference of the radii is spread evenly over the angle, as controls do.
    const double scale = radius > 0.0 ? 1.0 + share * (end_radius / radius - 1.0) : 1.0;
    const double angle = share * arc.angle;
    Vec3 p = from;
    p[a] = arc.centre[a] + scale * (u * std::cos(angle) - v * std::sin(angle));
    p[b] = arc.centre[b] + scale * (u * std::sin(angle) + v * std::cos(angle));
    p[arc.normal] = from[arc.normal] + share * (to[arc.normal] - from[arc.normal]);
    return p;
}

double arc_radius(const ArcPath& arc, const Vec3& from, const Vec3& to) {
    const int a = (arc.normal + 1) % 3, b = (arc.normal + 2) % 3;
    return std::max(std::hypot(from[a] - arc.centre[a], from[b] - arc.centre[b]),
                    std::hypot(to[a] - arc.centre[a], to[b] - arc.centre[b]));
}

void add_arc(Path& path, const Machine& machine, const Motion& motion, const Vec3& from,
             const Vec3& to, double max_error) {
    const ArcPath& arc = *motion.arc;
    const double radius = arc_radius(arc, from, to);
    // The sagitta of a chord is r (1 - cos(step / 2)); a spiral's drift adds less than as much
    // again.
    const double widest = radius > max_error ? 2.0 * std::acos(1.0 - 0.5 * max_error / radius)
                                             : std::numbers::pi / 2.0;
    const double step = std::min(widest, std::numbers::pi / 2.0);
    const int count = std::max(1, static_cast<int>(std::ceil(std::abs(arc.angle) / step)));
    const double rise = to[arc.normal] - from[arc.normal];
    const double length = std::hypot(radius * arc.angle, rise);
    path.duration = motion.feed > 0.0 ? length / motion.feed * seconds_per_minute : 0.0;
    Vec3 here = from;
    for (int i = 1; i <= count; ++i) {
        const double share = static_cast<double>(i) / count;
        const Vec3 next = i == count ? to : on_arc(motion, from, to, share);
        path.legs.push_back({{machine.place(here), machine.place(next)},
                             path.duration * (i - 1) / count,
                             path.duration * share,
                             max_error});
        here = next;
    }
}

/// Every straight way to the end from wherever the limits allow the machine to stand.
void add_from_unknown(Path& path, const Machine& machine, const Motion& motion) {
    Aabb starts, ends;
    for (int i = 0; i < 3; ++i) {
        const auto k = static_cast<size_t>(i);
        const MachineAxis& axis = machine.axes[k];
        if ((!motion.from[k] || !motion.to[k]) && (!axis.min || !axis.max)) return;
        starts.min[i] = motion.from[k].value_or(axis.min.value_or(0.0));
        starts.max[i] = motion.from[k].value_or(axis.max.value_or(0.0));
        ends.min[i] = motion.to[k].value_or(axis.min.value_or(0.0));
        ends.max[i] = motion.to[k].value_or(axis.max.value_or(0.0));
    }
    Leg leg{.places = box_corners(machine, starts), .straight = false, .start_known = false};
    if (const auto to = known(motion.to)) {
        leg.certain = {machine.place(*to)};
        leg.places.push_back(leg.certain[0]);
    } else { // an axis nobody commanded stands anywhere all the way
        starts.extend(ends);
        leg.places = box_corners(machine, starts);
    }
    path.legs.push_back(std::move(leg));
}

} // namespace

double chord_error(double mesh_size) { return std::clamp(mesh_size / 200.0, 1e-4, 0.0025); }

Path path_of(const Motion& motion, const Machine& machine, double max_error) {
    Path path;
    const auto from = known(motion.from), to = known(motion.to);
    if (!from || !to) {
        add_from_unknown(path, machine, motion);
        return path;
    }
    if (motion.arc) {
        add_arc(path, machine, motion, *from, *to, max_error);
        return path;
    }
    if (motion.kind != MotionKind::rapid) {
        const double length = glm::distance(*from, *to);
        add_straight(path, machine, *from, *to,
                     motion.feed > 0.0 ? length / motion.feed * seconds_per_minute : 0.0);
        return path;
    }
    if (machine.rapid == RapidStyle::dogleg && *from != *to) {
        add_dogleg(path, machine, *from, *to);
        return path;
    }
    const Vec3 times = axis_times(*to - *from, machine, path);
    add_straight(path, machine, *from, *to, std::max({times.x, times.y, times.z}));
    return path;
}

Aabb axis_range(const Motion& motion) {
    Aabb range;
    const Vec3 from = *known(motion.from), to = *known(motion.to);
    range.extend(from);
    range.extend(to);
    if (!motion.arc) return range;
    const ArcPath& arc = *motion.arc;
    const int a = (arc.normal + 1) % 3, b = (arc.normal + 2) % 3;
    const double start = std::atan2(from[b] - arc.centre[b], from[a] - arc.centre[a]);
    // The extremes of the two axes lie where the angle is a multiple of a quarter turn.
    const double quarter = std::numbers::pi / 2.0;
    const double first = std::min(start, start + arc.angle), last = first + std::abs(arc.angle);
    for (double k = std::ceil(first / quarter); k * quarter <= last; ++k) {
        const double share = (k * quarter - start) / arc.angle;
        range.extend(on_arc(motion, from, to, std::clamp(share, 0.0, 1.0)));
    }
    return range;
}

} // namespace core
