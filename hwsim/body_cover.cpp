#include "hwsim/body_cover.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/math.h"
#include "core/dbm/cutter.h"
#include "core/dbm/solid.h"
#include "core/distance/outer_model.h"
#include "hwsim/post_cover.h"

namespace hwsim {
namespace {

using core::ConvexShape;

constexpr double safety = 1e-6; // mm: larger than all errors of lines and rounding

/// The columns of an upright piece of revolution at a given position.
core::ColumnFunction columns_at(const core::ProfileElement& element, const core::Vec3& at) {
    const core::ColumnFunction columns = columns_of(core::RevolvedProfile{{element}});
    return [columns, at](int axis, const core::Square& square) {
        const core::Square moved{square.x0 - at.x, square.x1 - at.x, square.y0 - at.y,
                                 square.y1 - at.y};
        core::IntervalList matter;
        for (const core::Interval& i : columns(axis, moved))
            matter.add({i.lower + at.z, i.upper + at.z});
        return matter;
    };
}

bool is_upright_cone(const ConvexShape& shape) {
    return shape.core == ConvexShape::Core::cone && shape.upright && shape.position_count == 1;
}

core::ProfileElement element_of(const ConvexShape& cone) {
    core::ProfileElement element = cone.cone;
    element.margin = cone.margin;
    return element;
}

core::ColumnFunction columns_of_turned(const core::RevolvedProfile& profile,
                                       const core::Mat3& orientation) {
    return [profile,
            turn = core::CutterSweep{.orientation = orientation}](int, const core::Square& square) {
        const double reach =
            0.5 * core::hypot(square.x1 - square.x0, square.y1 - square.y0) + safety;
        const double x = 0.5 * (square.x0 + square.x1), y = 0.5 * (square.y0 + square.y1);
        core::IntervalList matter;
        for (core::ProfileElement element : profile.elements) {
            // A cone with a margin is inside the cone grown by the margin.
            const double margin = element.z0 < element.z1 ? element.margin : 0.0;
            element.margin -= margin;
            const auto heights = line_interval(
                grown(core::RevolvedProfile{{element}}, reach + margin), turn, 2, x, y);
            if (heights) matter.add({heights->lower - safety, heights->upper + safety});
        }
        return matter;
    };
}

/// The cubes of a grid that a body overlaps.
struct CubeGrid {
    std::array<int, 3> count{};
    std::vector<bool> met =
        std::vector<bool>(static_cast<size_t>(count[0]) * static_cast<size_t>(count[1])
                          * static_cast<size_t>(count[2]));

    size_t index(int i, int j, int k) const {
        return static_cast<size_t>((i * count[1] + j) * count[2] + k);
    }
    /// Adds all cubes that a box overlaps; the box is in units of cubes.
    void add(const core::Aabb& box) {
        std::array<int, 3> low{}, high{};
        for (int axis = 0; axis < 3; ++axis) {
            const auto a = static_cast<size_t>(axis);
            const auto cube = [&](double at) {
                return std::clamp(static_cast<int>(std::floor(at)), 0, count[a] - 1);
            };
            low[a] = cube(box.min[axis] - safety);
            high[a] = cube(box.max[axis] + safety);
        }
        for (int i = low[0]; i <= high[0]; ++i)
            for (int j = low[1]; j <= high[1]; ++j)
                for (int k = low[2]; k <= high[2]; ++k) met[index(i, j, k)] = true;
    }
};

/// Whether the surface of a convex shape misses a cube: the cube is wholly outside, or corners
/// slightly beyond its own are inside, so that it is wholly inside.
bool is_off_surface(const ConvexShape& shape, const core::Vec3& centre, double side) {
    constexpr double about = 1e-5; // mm: far larger than the errors of distances
    const core::Vec3 half(0.5 * side + about);
    const core::Aabb cube{centre - half, centre + half};
    const core::ExactBody body = shape;
    if (separation(core::convex(cube), body).lower > safety) return true;
    for (int corner = 0; corner < 8; ++corner) {
        const core::Vec3 at((corner & 1) != 0 ? cube.min.x : cube.max.x,
                            (corner & 2) != 0 ? cube.min.y : cube.max.y,
                            (corner & 4) != 0 ? cube.min.z : cube.max.z);
        if (separation(core::convex_segment(at, at), body).lower > 0.0) return false;
    }
    return true;
}

core::Result<std::vector<Record>> posts_in(const core::Aabb& box, double spacing,
                                           const core::ColumnFunction& columns) {
    const core::OuterModel model = outer_model(box, scan_grid(box, spacing), columns, {2});
    FEELER_TRY(const ColumnCells cells, cells_of(model));
    return posts_of(cells);
}

core::ColumnFunction columns_round(const core::ExactBody& body) {
    if (const auto* mesh = std::get_if<core::SolidMesh>(&body))
        return columns_of(core::Solid{*mesh});
    const auto& shape = std::get<ConvexShape>(body);
    if (!is_upright_cone(shape)) return columns_of(core::Solid{core::SolidBox{bounds(shape)}});
    return columns_at(element_of(shape), shape.positions[0].at);
}

} // namespace

core::Result<std::vector<Record>> posts_round(const core::ExactBody& body, double spacing) {
    return posts_in(bounds(body), spacing, columns_round(body));
}

core::Result<std::vector<Record>> posts_round(const core::RevolvedProfile& profile, double spacing,
                                              const core::Mat3& orientation) {
    core::Aabb box;
    for (const core::ProfileElement& element : profile.elements) {
        const core::Aabb part =
            bounds(posed(core::convex(element), {orientation, core::Vec3(0.0)}));
        box.extend(part.min);
        box.extend(part.max);
    }
    return posts_in(box, spacing, columns_of_turned(profile, orientation));
}

CubeCover cubes_round(const core::ExactBody& body, double side) {
    const core::Aabb box = bounds(body);
    const auto along = [&](int axis) { return static_cast<int>(box.size()[axis] / side) + 1; };
    const auto in_cubes = [&](const core::Vec3& p) { return (p - box.min) / side; };
    CubeGrid grid{{along(0), along(1), along(2)}};
    const auto* shape = std::get_if<ConvexShape>(&body);
    if (shape) grid.add({in_cubes(box.min), in_cubes(box.max)});
    if (const auto* mesh = std::get_if<core::SolidMesh>(&body))
        for (size_t i = 0; i < mesh->mesh->triangles.size(); ++i) {
            const core::Triangle triangle = mesh->mesh->triangle(i);
            core::Aabb round;
            for (const core::Vec3& corner : {triangle.a, triangle.b, triangle.c})
                round.extend(in_cubes(corner));
            grid.add(round);
        }
    CubeCover cover{side, {}};
    for (int i = 0; i < grid.count[0]; ++i)
        for (int j = 0; j < grid.count[1]; ++j)
            for (int k = 0; k < grid.count[2]; ++k) {
                const core::Vec3 centre = box.min + side * (core::Vec3(i, j, k) + 0.5);
                if (grid.met[grid.index(i, j, k)]
                    && !(shape && is_off_surface(*shape, centre, side)))
                    cover.centres.push_back(centre);
            }
    return cover;
}

core::Result<std::vector<Record>> cylinders_round(const CubeCover& cubes,
                                                  const core::Mat3& orientation) {
    core::Vec3 half(0.0); // of the box around a rotated cube
    for (int i = 0; i < 3; ++i) half += 0.5 * cubes.side * glm::abs(orientation[i]);
    const double radius =
        std::min(core::hypot(half.x, half.y), 0.5 * std::numbers::sqrt3 * cubes.side) + safety;
    std::vector<Record> records;
    for (const core::Vec3& centre : cubes.centres) {
        const core::Vec3 at = orientation * centre;
        Record record;
        FEELER_TRY(record.base[0], fixed(at.x, Rounding::nearest));
        FEELER_TRY(record.base[1], fixed(at.y, Rounding::nearest));
        FEELER_TRY(record.base[2], fixed(at.z - half.z - safety, Rounding::down));
        FEELER_TRY(const int32_t top, fixed(at.z + half.z + safety, Rounding::up));
        FEELER_TRY(record.half, fixed(radius + lsb, Rounding::up)); // the axis is half a step off
        record.run = top - record.base[2];
        if (record.run > Record::greatest_extent || record.half > Record::greatest_extent)
            return core::fail(core::ErrorCode::invalid_value,
                              "a cube of a body is larger than the coprocessor's limit of 256 mm");
        records.push_back(record);
    }
    return records;
}

} // namespace hwsim
