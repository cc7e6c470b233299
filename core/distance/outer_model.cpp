#include "core/distance/outer_model.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <memory>

#include "core/base/math.h"
#include "core/dbm/solid.h"
#include "core/distance/rounding.h"
#include "core/geom/profile.h"

namespace core {
namespace {

int cells_along(const OuterModel& model, int axis) { return model.grid.count(axis) + 1; }

ScanLines empty_columns(const OuterModel& model, int axis) {
    return {axis, cells_along(model, u_axis(axis)), cells_along(model, v_axis(axis))};
}

IntervalList grown(const LineView& list, double by) {
    IntervalList wider;
    for (const Interval& i : list) wider.add({i.lower - by, i.upper + by});
    return wider;
}

} // namespace

Interval cell_of(const OuterModel& model, int axis, int i) {
    const double low = model.box.min[axis], high = model.box.max[axis];
    const auto line = [&](int k) { return std::clamp(model.grid.coordinate(axis, k), low, high); };
    return {i == 0 ? low : line(i - 1), i == model.grid.count(axis) ? high : line(i)};
}

OuterModel outer_model(const Aabb& bounds, const ScanGrid& grid, const ColumnFunction& column,
                       std::initializer_list<int> axes) {
    assert(axes.size() > 0);
    const double error = scan_rounding(bounds.reach());
    OuterModel model{grid, bounds.grown(error), {}};
    for (const int axis : axes) {
        ScanLines columns = empty_columns(model, axis);
        for (int j = 0; j < columns.v_count(); ++j) {
            const Interval v = cell_of(model, v_axis(axis), j);
            for (int i = 0; i < columns.u_count(); ++i) {
                const Interval u = cell_of(model, u_axis(axis), i);
                const IntervalList found = column(
                    axis, {u.lower - error, u.upper + error, v.lower - error, v.upper + error});
                if (!found.empty()) columns.edit(i, j) = grown(found, error);
            }
        }
        model.families.push_back(std::move(columns));
    }
    return model;
}

namespace {

/// Distance of the interval from 0.
double outside(double lower, double upper) { return std::max({lower, -upper, 0.0}); }

/// The closed interval between two positions, enlarged so that rounding never empties it.
IntervalList closed(double lower, double upper) {
    return IntervalList({std::nextafter(std::min(lower, upper), -infinity),
                         std::nextafter(std::max(lower, upper), infinity)});
}

/// Half the chord of a circle at the distance `across` from its centre.
double half_chord(double radius, double across) {
    return std::sqrt(std::max(0.0, (radius - across) * (radius + across)));
}

/// A piece gets thinner away from its axis, so its heights at the point of the rectangle nearest to
/// the axis contain those at all other points.
IntervalList column_along_axis(const ProfileElement& e, const Square& s) {
    const double r = core::hypot(outside(s.x0, s.x1), outside(s.y0, s.y1));
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

/// A column across the axis: `across` is its distance from the axis, `z` its heights.
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

/// A vector with `axis` mapped to Z and the next two axes to X and Y.
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
