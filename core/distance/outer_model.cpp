#include "core/distance/outer_model.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <memory>

#include "core/dbm/cut_model.h"
#include "core/distance/rounding.h"

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

/// The cells across `axis` that an interval along it overlaps, first .. last.
struct CellRange {
    int first, last;
};

CellRange cells_met(const OuterModel& model, int axis, const Interval& stretch) {
    const double first_line = model.grid.coordinate(axis, 0);
    const auto near = [&](double x) {
        return static_cast<int>(std::clamp(std::floor((x - first_line) / model.grid.spacing), -1.0,
                                           model.grid.count(axis) - 1.0))
               + 1;
    };
    // One more on either side: the estimate is rounded, and cells without overlap drop out.
    return {std::max(0, near(stretch.lower) - 1),
            std::min(cells_along(model, axis) - 1, near(stretch.upper) + 1)};
}

/// The parts of a list within a cell, both closed; a part may be a single point.
void clip(const LineView& list, const Interval& cell, std::vector<Interval>& parts) {
    parts.clear();
    for (const Interval& i : list) {
        const Interval part{std::max(i.lower, cell.lower), std::min(i.upper, cell.upper)};
        if (part.lower <= part.upper) parts.push_back(part);
    }
}

/// Builds the boxes of a model, column by column of its first family.
class BoxBuilder {
public:
    explicit BoxBuilder(const OuterModel& model)
        : model_(model),
          along_(model.families.front().axis()),
          u_(u_axis(along_)),
          v_(v_axis(along_)) {
        for (const ScanLines& family : model.families)
            families_[static_cast<size_t>(family.axis())] = &family;
    }

    std::vector<Aabb> run() {
        const ScanLines& columns = model_.families.front();
        for (int j = 0; j < columns.v_count(); ++j)
            for (int i = 0; i < columns.u_count(); ++i) {
                first_of_column_ = boxes_.size();
                for (const Interval& stretch : columns.line(i, j)) add_stretch(i, j, stretch);
            }
        return std::move(boxes_);
    }

private:
    void add_stretch(int i, int j, const Interval& stretch) {
        const auto [first, last] = cells_met(model_, along_, stretch);
        for (int k = first; k <= last; ++k) {
            const Interval cell = cell_of(model_, along_, k);
            const Interval part{std::max(stretch.lower, cell.lower),
                                std::min(stretch.upper, cell.upper)};
            if (part.lower > part.upper) continue;
            // The family along u counts its cells by (v, along), that along v by (along, u).
            clip_across(u_, j, k, cell_of(model_, u_, i), across_u_);
            clip_across(v_, k, i, cell_of(model_, v_, j), across_v_);
            for (const Interval& v : across_v_)
                for (const Interval& u : across_u_) add_box(u, v, part);
        }
    }

    void clip_across(int axis, int i, int j, const Interval& cell, std::vector<Interval>& parts) {
        const ScanLines* family = families_[static_cast<size_t>(axis)];
        if (family)
            clip(family->line(i, j), cell, parts);
        else
            parts.assign(1, cell);
    }

    void add_box(const Interval& u, const Interval& v, const Interval& along) {
        Aabb box;
        box.min[u_] = u.lower, box.max[u_] = u.upper;
        box.min[v_] = v.lower, box.max[v_] = v.upper;
        box.min[along_] = along.lower, box.max[along_] = along.upper;
        if (boxes_.size() > first_of_column_ && continues(boxes_.back(), box))
            boxes_.back().max[along_] = along.upper;
        else
            boxes_.push_back(box);
    }

    bool continues(const Aabb& below, const Aabb& box) const {
        return below.min[u_] == box.min[u_] && below.max[u_] == box.max[u_]
               && below.min[v_] == box.min[v_] && below.max[v_] == box.max[v_]
               && below.max[along_] == box.min[along_];
    }

    const OuterModel& model_;
    int along_, u_, v_;
    std::array<const ScanLines*, 3> families_{};
    std::vector<Aabb> boxes_;
    size_t first_of_column_ = 0;
    std::vector<Interval> across_u_, across_v_;
};

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

OuterModel outer_model(const CutModel& stock) {
    const double error = scan_rounding(stock.outer_box.reach());
    OuterModel model{stock.lines.grid, stock.outer_box, {}};
    ScanLines columns = empty_columns(model, 2);
    for (int j = 0; j < columns.v_count(); ++j)
        for (int i = 0; i < columns.u_count(); ++i)
            if (!stock.columns.line(i, j).empty())
                columns.edit(i, j) = grown(stock.columns.line(i, j), error);
    model.families.push_back(std::move(columns));
    return model;
}

std::vector<Aabb> boxes_of(const OuterModel& model) {
    if (model.families.empty()) return {};
    return BoxBuilder(model).run();
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
