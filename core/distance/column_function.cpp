#include <array>
#include <cassert>
#include <memory>

#include "core/distance/outer_model.h"

namespace core {
namespace {

/// How far the rectangle is from 0 along one side.
double outside(double lower, double upper) { return std::max({lower, -upper, 0.0}); }

/// The stretch between two places, also where rounding leaves one or less than one point of it.
IntervalList closed(double lower, double upper) {
    return IntervalList({std::nextafter(std::min(lower, upper), -infinity),
                         std::nextafter(std::max(lower, upper), infinity)});
}

/// Half the chord of a circle, `across` away from its middle.
double half_chord(double radius, double across) {
    return std::sqrt(std::max(0.0, (radius - across) * (radius + across)));
}

/// The section of a piece gets thinner away from the axis, so what the rectangle's nearest point
/// sees of it holds what all others see.
IntervalList column_along_axis(const ProfileElement& e, const Square& s) {
    const double r = std::hypot(outside(s.x0, s.x1), outside(s.y0, s.y1));
    const double disc = std::max(e.r0, e.r1);
    if (r > disc + e.margin) return {};
    if (e.margin > 0.0) {
        const double half = half_chord(e.margin, std::max(0.0, r - disc));
        return closed(e.z0 - half, e.z1 + half);
    }
    const auto side = [&] { return e.z0 + (r - e.r0) / (e.r1 - e.r0) * (e.z1 - e.z0); };
    return closed(r <= e.r0 ? e.z0 : side(), r <= e.r1 ? e.z1 : side());
}

/// The greatest radius of a piece at heights of z.lower to z.upper, both within it: at one of them,
/// or where a rounded piece is widest.
double widest(const ProfileElement& e, const Interval& z) {
    if (e.margin > 0.0) {
        const double away = outside(z.lower - e.z1, z.upper - e.z0);
        return std::max(e.r0, e.r1) + half_chord(e.margin, away);
    }
    const auto at = [&](double height) {
        return e.r0 + (height - e.z0) / (e.z1 - e.z0) * (e.r1 - e.r0);
    };
    return std::max(at(z.lower), at(z.upper));
}

/// A column across the axis: `across` is how far it passes the axis, `z` its heights.
IntervalList column_across_axis(const ProfileElement& e, double across, Interval z) {
    z.lower = std::max(z.lower, e.z0 - e.margin);
    z.upper = std::min(z.upper, e.z1 + e.margin);
    if (z.lower > z.upper) return {};
    const double r = widest(e, z);
    if (r < across) return {};
    const double half = half_chord(r, across);
    return closed(-half, half);
}

IntervalList column_of(const ProfileElement& e, int axis, const Square& s) {
    if (axis == 2) return column_along_axis(e, s);
    // Along X the rectangle is (y, z), along Y it is (z, x).
    if (axis == 0) return column_across_axis(e, outside(s.x0, s.x1), {s.y0, s.y1});
    return column_across_axis(e, outside(s.y0, s.y1), {s.x0, s.x1});
}

IntervalList column_of(const Box& box, int axis, const Square& s) {
    const Vec3 half = 0.5 * box.size;
    if (outside(s.x0, s.x1) > half[u_axis(axis)] || outside(s.y0, s.y1) > half[v_axis(axis)])
        return {};
    return IntervalList({-half[axis], half[axis]});
}

IntervalList column_of(const Sphere& sphere, int axis, const Square& s) {
    return column_of(ProfileElement{0.0, 0.0, 0.0, 0.0, sphere.radius}, axis, s);
}

IntervalList column_of(const Cylinder& c, int axis, const Square& s) {
    const double half = 0.5 * c.height;
    return column_of(ProfileElement{-half, c.radius, half, c.radius, 0.0}, axis, s);
}

/// A vector as seen when `axis` is turned to Z, the two next axes to X and Y.
Vec3 turned(const Vec3& v, int axis) { return {v[u_axis(axis)], v[v_axis(axis)], v[axis]}; }

Aabb turned(const Aabb& box, int axis) { return {turned(box.min, axis), turned(box.max, axis)}; }

Solid turned(const Solid& solid, int axis) {
    if (axis == 2) return solid;
    if (const auto* box = std::get_if<SolidBox>(&solid.shape))
        return {SolidBox{turned(box->box, axis)}, solid.tolerance};
    if (const auto* mesh = std::get_if<SolidMesh>(&solid.shape)) {
        Mesh copy = *mesh->mesh;
        for (Vec3& v : copy.vertices) v = turned(v, axis);
        return {solid_mesh(std::move(copy)), solid.tolerance};
    }
    SolidCylinder cylinder = std::get<SolidCylinder>(solid.shape);
    cylinder.base = turned(cylinder.base, axis);
    cylinder.axis = (cylinder.axis + 2 - axis) % 3;
    return {cylinder, solid.tolerance};
}

} // namespace

ColumnFunction columns_of(const Primitive& primitive) {
    return [primitive](int axis, const Square& square) {
        return std::visit([&](const auto& shape) { return column_of(shape, axis, square); },
                          primitive);
    };
}

ColumnFunction columns_of(const RevolvedProfile& profile) {
    return [profile](int axis, const Square& square) {
        IntervalList all;
        for (const ProfileElement& element : profile.elements)
            for (const Interval& part : column_of(element, axis, square)) all.add(part);
        return all;
    };
}

ColumnFunction columns_of(const Solid& solid) {
    const auto sides = std::make_shared<const std::array<Solid, 3>>(
        std::array{turned(solid, 0), turned(solid, 1), solid});
    return [sides](int axis, const Square& square) {
        return core::column_of((*sides)[static_cast<size_t>(axis)], square);
    };
}

} // namespace core
