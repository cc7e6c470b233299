#include "core/distance/measured_body.h"

#include <cmath>

#include <fmt/format.h>

#include "core/dbm/cutter.h"
#include "core/dbm/mesh_scan.h"
#include "core/distance/rounding.h"

namespace core {
namespace {

/// Bytes that a body takes for each byte of its scan: the engine's tree over the points, the tree
/// over the lines, and that over the boxes of an outer model.
constexpr double exact_share = 3.5, scanned_share = 6.0, outer_share = 11.0;

Result<double> checked_reach(const Aabb& box) {
    const double reach = box.reach();
    if (reach <= farthest_coordinate) return reach;
    return fail(ErrorCode::invalid_value,
                fmt::format("the body reaches {:.3g} mm from its origin, more than the {:.0e} mm "
                            "that can be measured",
                            reach, farthest_coordinate));
}

/// The bytes that a body of this size would take, if they are within the limit.
Result<double> checked_memory(const Aabb& box, double spacing, double share, double limit) {
    if (!(spacing > 0.0) || !std::isfinite(spacing))
        return fail(ErrorCode::invalid_value,
                    fmt::format("the mesh size must be a length above 0 mm, not {}", spacing));
    constexpr double gib = 1024.0 * 1024.0 * 1024.0;
    const double bytes = share * memory_estimate(box, spacing);
    if (bytes <= limit) return bytes;
    double wider = spacing;
    while (share * memory_estimate(box, wider) > limit && wider < farthest_coordinate)
        wider *= 1.05;
    return fail(ErrorCode::invalid_value,
                fmt::format("measuring the body with a mesh size of {} mm would take {:.3g} GiB of "
                            "memory (the limit is {:.3g} GiB); {:.3g} mm would do",
                            spacing, bytes / gib, limit / gib, wider));
}

ExactPart part_of(const Sphere& s) { return {convex_sphere(s.radius), Vec3(0.0), s.radius}; }

ExactPart part_of(const Box& b) {
    const Vec3 half = 0.5 * b.size;
    return {convex(Aabb{-half, half}), Vec3(0.0), std::min({half.x, half.y, half.z})};
}

ExactPart part_of(const ProfileElement& e) {
    const double middle = 0.5 * (e.z0 + e.z1), r = 0.5 * (e.r0 + e.r1);
    const double side = std::hypot(e.z1 - e.z0, e.r1 - e.r0);
    const double to_side = side > 0.0 ? r * (e.z1 - e.z0) / side : 0.0;
    return {convex(e), {0.0, 0.0, middle}, std::min(0.5 * (e.z1 - e.z0), to_side) + e.margin};
}

ExactPart part_of(const Cylinder& c) {
    return part_of(ProfileElement{-0.5 * c.height, c.radius, 0.5 * c.height, c.radius, 0.0});
}

Result<RevolvedProfile> checked(const RevolvedProfile& profile) {
    if (profile.empty())
        return fail(ErrorCode::missing_value, "the profile has no pieces, it is an empty body");
    for (size_t i = 0; i < profile.elements.size(); ++i) {
        const ProfileElement& e = profile.elements[i];
        const bool sizes = e.r0 >= 0.0 && e.r1 >= 0.0 && e.margin >= 0.0 && e.z0 <= e.z1
                           && (e.margin == 0.0 || e.z0 == e.z1);
        const Aabb box = bounds(e);
        if (sizes && is_finite(box.min) && is_finite(box.max) && part_of(e).depth > 0.0) continue;
        return fail(ErrorCode::invalid_value,
                    fmt::format("piece {} of the profile is no body: it needs finite sizes, radii "
                                "of 0 or more, volume, and an upper rim above the lower one, or "
                                "at its height if there is a margin",
                                i + 1));
    }
    return profile;
}

/// What the three kinds of shapes have in common once they are known to be bodies.
Result<MeasuredBody> scanned_body(const Aabb& box, double spacing, double memory_limit,
                                  const std::function<Result<Dbm>()>& scan_it) {
    MeasuredBody body;
    FEELER_TRY(body.reach, checked_reach(box));
    FEELER_TRY([[maybe_unused]] const double bytes,
               checked_memory(box, spacing, exact_share, memory_limit));
    FEELER_TRY(const Dbm lines, scan_it());
    body.points = boundary_points(lines);
    return body;
}

Result<MeasuredBody> body_of(const Primitive& shape, double spacing, double memory_limit) {
    FEELER_TRY(const Primitive primitive, checked_primitive(shape));
    FEELER_TRY(MeasuredBody body, scanned_body(bounds(primitive), spacing, memory_limit, [&] {
                   return scan(primitive, spacing, memory_limit);
               }));
    body.parts = {std::visit([](const auto& p) { return part_of(p); }, primitive)};
    return body;
}

Result<MeasuredBody> body_of(const RevolvedProfile& shape, double spacing, double memory_limit) {
    FEELER_TRY(const RevolvedProfile profile, checked(shape));
    const Aabb box = bounds(profile);
    const LineFunction line = [&](int axis, double u, double v) {
        return line_intervals(profile, axis, u, v);
    };
    FEELER_TRY(MeasuredBody body, scanned_body(box, spacing, memory_limit, [&] {
                   return scan_lines_of(box, spacing, line, memory_limit);
               }));
    for (const ProfileElement& e : profile.elements) body.parts.push_back(part_of(e));
    return body;
}

Result<MeasuredBody> body_of(const SolidMesh& solid, double spacing, double memory_limit) {
    if (!solid.mesh || !solid.bvh || solid.mesh->triangles.empty())
        return fail(ErrorCode::missing_value, "the mesh holds no triangles, it is an empty body");
    for (const Vec3& v : solid.mesh->vertices)
        if (!is_finite(v))
            return fail(ErrorCode::invalid_value,
                        "a corner of the mesh has a coordinate that is not finite");
    FEELER_TRY(MeasuredBody body, scanned_body(solid.mesh->bounds(), spacing, memory_limit, [&] {
                   return scan(*solid.mesh, spacing, memory_limit);
               }));
    body.parts = {{solid, Vec3(0.0), 0.0}};
    return body;
}

/// The grid's lines as its families hold them, all of it finite.
Result<double> checked_grid(const Dbm& lines) {
    const ScanGrid& grid = lines.grid;
    bool sound = is_finite(grid.centre) && std::isfinite(grid.spacing) && grid.spacing > 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        const ScanLines& family = lines.families[static_cast<size_t>(axis)];
        sound = sound && family.u_count() == grid.count(u_axis(axis))
                && family.v_count() == grid.count(v_axis(axis))
                && (family.axis() == axis || family.u_count() == 0);
    }
    if (sound) return grid.spacing;
    return fail(ErrorCode::invalid_value,
                "the scan lines do not fit their grid: it needs a finite middle, a mesh size above "
                "0 mm, and as many lines as the families hold");
}

/// The stretches of matter, one box each.
std::vector<Aabb> stretches(const Dbm& lines) {
    std::vector<Aabb> all;
    for (int axis = 0; axis < 3; ++axis) {
        const ScanLines& family = lines.families[static_cast<size_t>(axis)];
        for (int v = 0; v < family.v_count(); ++v)
            for (int u = 0; u < family.u_count(); ++u)
                for (const Interval& i : family.line(u, v))
                    all.push_back({point_on_line(lines.grid, axis, u, v, i.lower),
                                   point_on_line(lines.grid, axis, u, v, i.upper)});
    }
    return all;
}

bool is_of_grid(const OuterModel& model, const ScanGrid& grid) {
    return model.grid.centre == grid.centre && model.grid.spacing == grid.spacing
           && model.grid.half_count == grid.half_count;
}

/// Whether the columns are as many as the grid has cells, one family to an axis, and all finite.
bool is_sound(const OuterModel& model) {
    bool sound = is_finite(model.box.min) && is_finite(model.box.max) && !model.families.empty();
    unsigned axes_seen = 0;
    for (const ScanLines& family : model.families) {
        const int axis = family.axis();
        const unsigned bit = 1U << static_cast<unsigned>(axis);
        sound = sound && (axes_seen & bit) == 0
                && family.u_count() == model.grid.count(u_axis(axis)) + 1
                && family.v_count() == model.grid.count(v_axis(axis)) + 1;
        axes_seen |= bit;
        for (int v = 0; sound && v < family.v_count(); ++v)
            for (int u = 0; u < family.u_count(); ++u)
                for (const Interval& i : family.line(u, v))
                    sound = sound && std::isfinite(i.lower) && std::isfinite(i.upper);
    }
    return sound;
}

Result<BoxTree> checked_outer(const OuterModel& model, const Dbm& lines, const Aabb& matter,
                              double error) {
    if (!is_of_grid(model, lines.grid) || !is_sound(model))
        return fail(ErrorCode::invalid_value,
                    "the outer model has no columns, or those of another grid than the scan "
                    "lines, or some that are not finite");
    const Aabb box = model.box.grown(error);
    const bool in_box = glm::all(glm::lessThanEqual(box.min, matter.min))
                        && glm::all(glm::lessThanEqual(matter.max, box.max));
    if (!in_box || !holds(model, lines, error))
        return fail(ErrorCode::invalid_value,
                    "the outer model does not hold the matter on the scan lines");
    return box_tree(boxes_of(model));
}

} // namespace

Result<MeasuredBody> measured_body(const BodyShape& shape, double spacing, double memory_limit) {
    return std::visit([&](const auto& kind) { return body_of(kind, spacing, memory_limit); },
                      shape);
}

Result<MeasuredBody> measured_body(const Dbm& lines, const std::optional<OuterModel>& outer,
                                   double memory_limit) {
    FEELER_TRY([[maybe_unused]] const double spacing, checked_grid(lines));
    std::vector<Aabb> matter = stretches(lines);
    Aabb box;
    for (const Aabb& stretch : matter) {
        if (!is_finite(stretch.min) || !is_finite(stretch.max))
            return fail(ErrorCode::invalid_value, "matter on a scan line ends at no number");
        box.extend(stretch);
    }
    if (matter.empty())
        return fail(ErrorCode::missing_value,
                    "no scan line holds matter, it is an empty body or one that is smaller than "
                    "the mesh size");
    const Aabb on_lines = box;
    if (outer) box.extend(outer->box);
    MeasuredBody body;
    FEELER_TRY(body.reach, checked_reach(box));
    FEELER_TRY(
        [[maybe_unused]] const double bytes,
        checked_memory(box, lines.grid.spacing, outer ? outer_share : scanned_share, memory_limit));
    body.scanned.emplace();
    if (outer) {
        FEELER_TRY(body.scanned->outer,
                   checked_outer(*outer, lines, on_lines, scan_rounding(body.reach)));
    }
    body.points = boundary_points(lines);
    body.scanned->lines = box_tree(std::move(matter));
    return body;
}

Result<MeasuredBody> taken_into(DistanceEngine& engine, MeasuredBody body) {
    FEELER_TRY(body.in_engine, engine.add(body.points));
    return body;
}

} // namespace core
