#include "core/dbm/dbm.h"

#include <cassert>
#include <cmath>

#include <fmt/format.h>

#include "core/base/math.h"

namespace core {
namespace {

/// Calls visit(axis, u, v) for every line, in the fixed order.
template <typename Visit>
void for_each_line(const Dbm& dbm, const Visit& visit) {
    for (int axis = 0; axis < 3; ++axis) {
        const ScanLines& family = dbm.families[static_cast<size_t>(axis)];
        for (int v = 0; v < family.v_count(); ++v)
            for (int u = 0; u < family.u_count(); ++u) visit(axis, u, v);
    }
}

double lines_for(const Aabb& bounds, double spacing) {
    const double x = lines_across(bounds.size().x, spacing);
    const double y = lines_across(bounds.size().y, spacing);
    const double z = lines_across(bounds.size().z, spacing);
    return x * y + y * z + z * x;
}

/// A mesh size, near the smallest, whose model fits into `memory_limit`.
double fitting_spacing(const Aabb& bounds, double spacing, double memory_limit) {
    double wider = spacing;
    while (memory_estimate(bounds, wider) > memory_limit && wider < 1e9) wider *= 1.05;
    const double unit = core::pow(10.0, std::floor(core::log10(wider)) - 1.0);
    return std::ceil(wider / unit) * unit;
}

constexpr double bytes_per_line = sizeof(IntervalList) + 2 * sizeof(Vec3);

bool in_half_open(double x, double half_size) { return -half_size <= x && x < half_size; }

IntervalList symmetric(double half) { return IntervalList(Interval{-half, half}); }

IntervalList line_of(const Sphere& sphere, int, double u, double v) {
    const double square = sphere.radius * sphere.radius - u * u - v * v;
    return square > 0.0 ? symmetric(std::sqrt(square)) : IntervalList();
}

IntervalList line_of(const Box& box, int axis, double u, double v) {
    const Vec3 half = 0.5 * box.size;
    if (!in_half_open(u, half[u_axis(axis)]) || !in_half_open(v, half[v_axis(axis)])) return {};
    return symmetric(half[axis]);
}

IntervalList line_of(const Cylinder& cylinder, int axis, double u, double v) {
    const double half_height = 0.5 * cylinder.height;
    // The distance of the line from the axis, in the plane across it.
    const double x = axis == 1 ? v : (axis == 2 ? u : 0.0);
    const double y = axis == 0 ? u : (axis == 2 ? v : 0.0);
    const double square = cylinder.radius * cylinder.radius - x * x - y * y;
    if (!(square > 0.0)) return {};
    if (axis == 2) return symmetric(half_height);
    return in_half_open(axis == 0 ? v : u, half_height) ? symmetric(std::sqrt(square))
                                                        : IntervalList();
}

} // namespace

ScanGrid scan_grid(const Aabb& bounds, double spacing) {
    assert(spacing > 0.0 && !bounds.empty());
    ScanGrid grid{.centre = bounds.center(), .spacing = spacing, .half_count = {}};
    for (int axis = 0; axis < 3; ++axis) {
        // Line k on one side is at (k + 0.5) h; a line on the border itself would meet nothing.
        const double half_cells = 0.5 * bounds.size()[axis] / spacing;
        grid.half_count[static_cast<size_t>(axis)] =
            std::max(1, static_cast<int>(std::ceil(half_cells - 0.5)));
    }
    return grid;
}

Vec3 point_on_line(const ScanGrid& grid, int axis, int u, int v, double along) {
    Vec3 p;
    p[axis] = along;
    p[u_axis(axis)] = grid.coordinate(u_axis(axis), u);
    p[v_axis(axis)] = grid.coordinate(v_axis(axis), v);
    return p;
}

std::vector<Vec3> boundary_points(const Dbm& dbm) {
    std::vector<Vec3> points;
    points.reserve(point_count(dbm));
    for_each_line(dbm, [&](int axis, int u, int v) {
        for (const Interval& i : dbm.families[static_cast<size_t>(axis)].line(u, v)) {
            points.push_back(point_on_line(dbm.grid, axis, u, v, i.lower));
            points.push_back(point_on_line(dbm.grid, axis, u, v, i.upper));
        }
    });
    return points;
}

size_t point_count(const Dbm& dbm) {
    size_t count = 0;
    for_each_line(dbm, [&](int axis, int u, int v) {
        count += 2 * dbm.families[static_cast<size_t>(axis)].line(u, v).size();
    });
    return count;
}

size_t line_count(const Dbm& dbm) {
    size_t count = 0;
    for (const ScanLines& family : dbm.families)
        count += static_cast<size_t>(family.u_count()) * static_cast<size_t>(family.v_count());
    return count;
}

double memory_estimate(const Aabb& bounds, double spacing) {
    return lines_for(bounds, spacing) * bytes_per_line;
}

Result<Dbm> empty_dbm(const Aabb& bounds, double spacing, double memory_limit) {
    assert(!bounds.empty());
    if (!(spacing > 0.0) || !std::isfinite(spacing))
        return fail(ErrorCode::invalid_value,
                    fmt::format("the mesh size must be a length above 0 mm, not {}", spacing));
    const double bytes = memory_estimate(bounds, spacing);
    constexpr double most_lines = 2147483647.0; // lines are counted in 31 bits
    constexpr double gib = 1024.0 * 1024.0 * 1024.0;
    const double limit = std::min(memory_limit, most_lines * bytes_per_line);
    if (!(bytes <= limit))
        return fail(ErrorCode::invalid_value,
                    fmt::format("a mesh size of {} mm needs {:.3g} scan lines and {:.3g} GiB (the "
                                "limit is {:.3g} GiB); {:.2g} mm would do",
                                spacing, lines_for(bounds, spacing), bytes / gib, limit / gib,
                                fitting_spacing(bounds, spacing, limit)));

    Dbm dbm{.grid = scan_grid(bounds, spacing), .families = {}};
    for (int axis = 0; axis < 3; ++axis)
        dbm.families[static_cast<size_t>(axis)] =
            ScanLines(axis, dbm.grid.count(u_axis(axis)), dbm.grid.count(v_axis(axis)));
    return dbm;
}

Result<Dbm> checked_not_empty(Dbm dbm) {
    if (point_count(dbm) == 0)
        return fail(
            ErrorCode::invalid_value,
            fmt::format("the mesh size of {} mm is larger than the body: no scan line crosses it",
                        dbm.grid.spacing));
    return dbm;
}

Result<Dbm> scan_lines_of(const Aabb& bounds, double spacing, const LineFunction& line,
                          double memory_limit) {
    FEELER_TRY(Dbm dbm, empty_dbm(bounds, spacing, memory_limit));
    for_each_line(dbm, [&](int axis, int u, int v) {
        IntervalList found =
            line(axis, dbm.grid.coordinate(u_axis(axis), u), dbm.grid.coordinate(v_axis(axis), v));
        if (!found.empty()) dbm.families[static_cast<size_t>(axis)].edit(u, v) = std::move(found);
    });
    return checked_not_empty(std::move(dbm));
}

Result<Dbm> scan(const Primitive& primitive, double spacing, double memory_limit) {
    FEELER_TRY(const Primitive checked, checked_primitive(primitive));
    const LineFunction line = [&](int axis, double u, double v) {
        return std::visit([&](const auto& shape) { return line_of(shape, axis, u, v); }, checked);
    };
    return scan_lines_of(bounds(checked), spacing, line, memory_limit);
}

} // namespace core
