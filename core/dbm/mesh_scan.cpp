#include "core/dbm/mesh_scan.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "core/geom/line_crossing.h"

namespace core {
namespace {

/// A crossing of a line with the surface, and the change of the winding number there.
struct TriangleCrossing {
    uint32_t line;
    int32_t step;
    double depth;
};

bool comes_before(const TriangleCrossing& a, const TriangleCrossing& b) {
    if (a.line != b.line) return a.line < b.line;
    if (a.depth != b.depth) return a.depth < b.depth;
    return a.step > b.step; // either order is correct, but it must be fixed
}

struct LineScan {
    IntervalList matter;
    bool shells_overlap = false;
    bool sound = true; // winding never below 0, and 0 at the end
    double unsound_at = 0.0;
};

/// Reads the sorted crossings of one line. Segments up to `rounding` long are ignored.
LineScan read_line(std::span<const TriangleCrossing> crossings, double rounding) {
    LineScan scan;
    int winding = 0;
    Interval piece{0.0, -infinity}; // the last piece found; the next one may continue it
    double inside_since = 0.0;
    const auto finish_piece = [&] {
        if (piece.length() > rounding) scan.matter.add(piece);
    };
    for (size_t i = 0; i < crossings.size(); ++i) {
        const double at = crossings[i].depth;
        const int before = winding;
        winding += crossings[i].step;
        if (before <= 0 && winding >= 1) inside_since = at;
        if (before >= 1 && winding <= 0) {
            if (inside_since - piece.upper > rounding) {
                finish_piece();
                piece = {inside_since, at};
            } else {
                piece.upper = at;
            }
        }
        const double next = i + 1 < crossings.size() ? crossings[i + 1].depth : at;
        const bool lasts = next - at > rounding;
        scan.shells_overlap |= winding >= 2 && lasts;
        const bool wrong = (winding < 0 && lasts) || (winding != 0 && i + 1 == crossings.size());
        if (wrong && scan.sound) {
            scan.sound = false;
            scan.unsound_at = at;
        }
    }
    finish_piece();
    return scan;
}

double rounding_of(const Aabb& bounds, int axis) {
    return 1e-11 * std::max(std::abs(bounds.min[axis]), std::abs(bounds.max[axis]));
}

tl::unexpected<Error> unsound_mesh(int axis, double u, double v, double along) {
    Vec3 p;
    p[axis] = along;
    p[u_axis(axis)] = u;
    p[v_axis(axis)] = v;
    return fail(ErrorCode::invalid_value,
                fmt::format("the mesh is open or partly inside out near ({:.6g}, {:.6g}, {:.6g}): "
                            "repair it where its surface passes through itself",
                            p.x, p.y, p.z));
}

/// The first line at or after `position`, or the first or last line if it lies beyond them.
int line_after(const ScanGrid& grid, int axis, double position) {
    const int half_count = grid.half_count[static_cast<size_t>(axis)];
    const double i = std::ceil((position - grid.centre[axis]) / grid.spacing + half_count - 0.5);
    return static_cast<int>(std::clamp(i, 0.0, grid.count(axis) - 1.0));
}

/// The crossings of one triangle with one family, row by row.
class TriangleRaster {
public:
    TriangleRaster(const ScanGrid& grid, int axis, std::vector<TriangleCrossing>& crossings)
        : grid_(grid), axis_(axis), crossings_(crossings) {}

    void add(const ProjectedTriangle& triangle) const {
        const auto& [a, b, c] = triangle.corner;
        const double lowest = std::min({a.y, b.y, c.y});
        const double highest = std::max({a.y, b.y, c.y});
        // One more line on either side: the estimate is rounded, but the decision on each line is
        // exact.
        const int first = std::max(0, line_after(grid_, v_axis(axis_), lowest) - 1);
        const int last = line_after(grid_, v_axis(axis_), highest);
        for (int v = first; v <= last; ++v) add_row(triangle, v);
    }

private:
    void add_row(const ProjectedTriangle& triangle, int v) const {
        const double height = grid_.coordinate(v_axis(axis_), v);
        double left = infinity;
        double right = -infinity;
        for (size_t i = 0; i < 3; ++i) {
            const Vec2& a = triangle.corner[i];
            const Vec2& b = triangle.corner[(i + 1) % 3];
            if ((a.y <= height) == (b.y <= height)) continue;
            const double u = a.x + (height - a.y) / (b.y - a.y) * (b.x - a.x);
            left = std::min(left, u);
            right = std::max(right, u);
        }
        if (left > right) return;
        const int first = std::max(0, line_after(grid_, u_axis(axis_), left) - 1);
        const int last = line_after(grid_, u_axis(axis_), right);
        for (int u = first; u <= last; ++u) add_line(triangle, u, v, height);
    }

    void add_line(const ProjectedTriangle& triangle, int u, int v, double height) const {
        const Vec2 p(grid_.coordinate(u_axis(axis_), u), height);
        const int step = crossing_step(triangle, p);
        if (step == 0) return;
        const auto line =
            static_cast<uint32_t>(v) * static_cast<uint32_t>(grid_.count(u_axis(axis_)))
            + static_cast<uint32_t>(u);
        crossings_.push_back({line, -step, crossing_depth(triangle, p)});
    }

    const ScanGrid& grid_;
    int axis_;
    std::vector<TriangleCrossing>& crossings_;
};

std::vector<TriangleCrossing> crossings_with(const Mesh& mesh, const ScanGrid& grid, int axis) {
    std::vector<TriangleCrossing> crossings;
    const TriangleRaster raster(grid, axis, crossings);
    for (size_t i = 0; i < mesh.triangles.size(); ++i) raster.add(project(mesh.triangle(i), axis));
    std::sort(crossings.begin(), crossings.end(), comes_before);
    return crossings;
}

/// Fills one family; returns whether shells overlap.
Result<bool> scan_family(const Mesh& mesh, const ScanGrid& grid, double rounding,
                         ScanLines& family) {
    const std::vector<TriangleCrossing> crossings = crossings_with(mesh, grid, family.axis());
    const auto u_count = static_cast<uint32_t>(family.u_count());
    bool shells_overlap = false;
    for (size_t first = 0, last = 0; first < crossings.size(); first = last) {
        while (last < crossings.size() && crossings[last].line == crossings[first].line) ++last;
        LineScan scan = read_line(std::span(crossings).subspan(first, last - first), rounding);
        const int u = static_cast<int>(crossings[first].line % u_count);
        const int v = static_cast<int>(crossings[first].line / u_count);
        if (!scan.sound)
            return unsound_mesh(family.axis(), grid.coordinate(u_axis(family.axis()), u),
                                grid.coordinate(v_axis(family.axis()), v), scan.unsound_at);
        shells_overlap |= scan.shells_overlap;
        if (!scan.matter.empty()) family.edit(u, v) = std::move(scan.matter);
    }
    return shells_overlap;
}

} // namespace

namespace {

Result<MeshScan> scan_within(const Mesh& mesh, const Aabb& box, double spacing,
                             double memory_limit) {
    if (mesh.triangles.empty()) return fail(ErrorCode::invalid_value, "the mesh has no triangles");
    FEELER_TRY(Dbm dbm, empty_dbm(box, spacing, memory_limit));
    bool shells_overlap = false;
    for (int axis = 0; axis < 3; ++axis) {
        FEELER_TRY(const bool overlap, scan_family(mesh, dbm.grid, rounding_of(mesh.bounds(), axis),
                                                   dbm.families[static_cast<size_t>(axis)]));
        shells_overlap |= overlap;
    }
    FEELER_TRY(Dbm met, checked_not_empty(std::move(dbm)));
    return MeshScan{std::move(met), shells_overlap};
}

} // namespace

Result<MeshScan> scan_mesh(const Mesh& mesh, double spacing, double memory_limit) {
    return scan_within(mesh, mesh.bounds(), spacing, memory_limit);
}

Result<Dbm> scan(const Mesh& mesh, const Aabb& box, double spacing, double memory_limit) {
    FEELER_TRY(MeshScan scan, scan_within(mesh, box, spacing, memory_limit));
    return std::move(scan.dbm);
}

Result<Dbm> scan(const Mesh& mesh, double spacing, double memory_limit) {
    FEELER_TRY(MeshScan scan, scan_mesh(mesh, spacing, memory_limit));
    return std::move(scan.dbm);
}

namespace {

LineScan read_line_of(const Mesh& mesh, int axis, double u, double v) {
    std::vector<TriangleCrossing> crossings;
    const Vec2 p(u, v);
    for (size_t i = 0; i < mesh.triangles.size(); ++i) {
        const ProjectedTriangle triangle = project(mesh.triangle(i), axis);
        const int step = crossing_step(triangle, p);
        if (step != 0) crossings.push_back({0, -step, crossing_depth(triangle, p)});
    }
    std::sort(crossings.begin(), crossings.end(), comes_before);
    return read_line(crossings, rounding_of(mesh.bounds(), axis));
}

} // namespace

Result<IntervalList> scan_line(const Mesh& mesh, int axis, double u, double v) {
    LineScan scan = read_line_of(mesh, axis, u, v);
    if (!scan.sound) return unsound_mesh(axis, u, v, scan.unsound_at);
    return std::move(scan.matter);
}

IntervalList matter_on_line(const Mesh& mesh, int axis, double u, double v) {
    return read_line_of(mesh, axis, u, v).matter;
}

} // namespace core
