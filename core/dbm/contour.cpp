#include "core/dbm/contour.h"

#include "core/geom/triangle_distance.h"

namespace core {
namespace {

/// How far beyond an edge an end is still taken for the edge's own, mm.
constexpr double contour_slack = 1e-6;

} // namespace

IndexRange places_within(const ScanGrid& grid, int axis, const Interval& matter) {
    const double start = grid.coordinate(axis, 0);
    const int last = grid.count(axis) - 1;
    const auto clipped = [&](double index, int low, int high) {
        return static_cast<int>(std::clamp(index, static_cast<double>(low), high + 0.0));
    };
    IndexRange range{clipped(std::ceil((matter.lower - start) / grid.spacing) - 1.0, 0, last + 1),
                     clipped(std::floor((matter.upper - start) / grid.spacing) + 1.0, -1, last)};
    while (range.first <= last && grid.coordinate(axis, range.first) < matter.lower) ++range.first;
    while (range.last >= 0 && grid.coordinate(axis, range.last) > matter.upper) --range.last;
    return range;
}

Crossing crossing_at(const Dbm& lines, int axis, const std::array<int, 3>& node, bool from_inside) {
    const ScanGrid& grid = lines.grid;
    const int u = node[static_cast<size_t>(u_axis(axis))] - 1;
    const int v = node[static_cast<size_t>(v_axis(axis))] - 1;
    const int step = node[static_cast<size_t>(axis)] - 1;
    const double low = grid.coordinate(axis, step), high = grid.coordinate(axis, step + 1);
    const LineView matter = lines.families[static_cast<size_t>(axis)].line(u, v);
    Crossing crossing{{axis, u, v, 0, from_inside}, 0.5 * (low + high)};
    double best = contour_slack;
    for (size_t i = 0; i < matter.size(); ++i) {
        const double here = from_inside ? matter[i].upper : matter[i].lower;
        const double beyond = std::max({low - here, here - high, 0.0});
        if (beyond > best || (crossing.found && beyond == best)) continue;
        best = beyond;
        crossing.along = here;
        crossing.end.interval = i;
        crossing.found = true;
    }
    crossing.along = std::clamp(crossing.along, low, high);
    return crossing;
}

std::optional<uint32_t> sweep_at(const Dbm& lines, const LineEnd& end) {
    const EndMarks marks =
        lines.families[static_cast<size_t>(end.axis)].marks(end.u, end.v, end.interval);
    const uint32_t mark = end.upper ? marks.upper : marks.lower;
    return mark > 0 ? std::optional(mark - 1) : std::nullopt;
}

CrossedEdge crossed_edge(const CutModel& model, const Crossing& crossing) {
    const LineEnd& end = crossing.end;
    CrossedEdge edge;
    if (crossing.found) {
        edge = {{Vec3(0.0), surface_point(model, end).normal}, sweep_at(model.lines, end)};
    }
    // A line does not end at a face that it runs along.
    const double outward = end.upper ? 1.0 : -1.0;
    if (!crossing.found || edge.plane.normal[end.axis] * outward < 1e-6) {
        edge.plane.normal = Vec3(0.0);
        edge.plane.normal[end.axis] = outward;
    }
    edge.plane.place = point_on_line(model.lines.grid, end.axis, end.u, end.v, crossing.along);
    return edge;
}

Aabb vertex_room(const ScanGrid& grid, const Aabb& bounds, const std::array<int, 3>& cell) {
    // Where a sharp edge leaves its cell through a side that lines pass on both flanks, only the
    // cell knows of it: vertices may stand in the cell beyond.
    const auto corner = [&](int by) {
        const Vec3 node(grid.coordinate(0, cell[0] - 1 + by), grid.coordinate(1, cell[1] - 1 + by),
                        grid.coordinate(2, cell[2] - 1 + by));
        return glm::clamp(node, bounds.min, bounds.max);
    };
    return {corner(-1), corner(2)};
}

double distance_to(const Triangle& triangle, const Vec3& point) {
    return glm::distance(point, nearest_point(triangle, point));
}

Diagonal better_diagonal(const std::array<Vec3, 4>& corners, const Vec3& point) {
    double away[2];
    for (size_t k = 0; k < 2; ++k)
        away[k] = std::min(distance_to({corners[k], corners[k + 1], corners[k + 2]}, point),
                           distance_to({corners[k], corners[k + 2], corners[(k + 3) % 4]}, point));
    const size_t k = away[1] < away[0] - 1e-9 ? 1 : 0;
    return {k, away[k]};
}

} // namespace core
