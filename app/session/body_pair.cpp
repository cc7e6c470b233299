#include "app/session/body_pair.h"

#include "app/session/stopwatch.h"
#include "core/dbm/mesh_scan.h"

namespace app {
namespace {

/// What double precision may be off by, mm: below 1e-9 within 2 m, growing with the coordinates.
double rounding(const core::Aabb& box) {
    const core::Vec3 farthest = glm::max(glm::abs(box.min), glm::abs(box.max));
    return 1e-9 * std::max(1.0, std::max({farthest.x, farthest.y, farthest.z}) / 2000.0);
}

core::ExactBody exact(const MeasuredBody& body) {
    if (const auto* mesh = std::get_if<core::SolidMesh>(&body)) return *mesh;
    const auto& primitive = std::get<core::Primitive>(body);
    if (const auto* sphere = std::get_if<core::Sphere>(&primitive))
        return core::convex_sphere(sphere->radius);
    if (const auto* box = std::get_if<core::Box>(&primitive))
        return core::convex(core::Aabb{-0.5 * box->size, 0.5 * box->size});
    const auto& c = std::get<core::Cylinder>(primitive);
    return core::convex(
        core::ProfileElement{-0.5 * c.height, c.radius, 0.5 * c.height, c.radius, 0.0});
}

void find_points(const core::ClosestPair& pair, BodyPairDistance& found) {
    found.distance = pair.distance;
    found.node_tests = pair.node_tests;
    found.point_tests = pair.point_tests;
}

void find_bounds(const core::Separation& bounds, double slack, BodyPairDistance& found) {
    found.lower = std::max(0.0, bounds.lower - slack);
    found.upper = bounds.upper > 0.0 ? bounds.upper + slack : 0.0;
    found.on_a = bounds.point_a;
    found.on_b = bounds.point_b;
    found.at = bounds.time_a;
}

} // namespace

core::Result<std::vector<core::Vec3>> points_of(const MeasuredBody& body, double mesh_size) {
    const auto scanned = std::holds_alternative<core::Primitive>(body)
                             ? core::scan(std::get<core::Primitive>(body), mesh_size)
                             : core::scan(*std::get<core::SolidMesh>(body).mesh, mesh_size);
    if (!scanned) return tl::unexpected(scanned.error());
    return core::boundary_points(*scanned);
}

core::Result<BodyPairDistance> measure(const MeasuredBody& a, const MeasuredBody& b,
                                       const core::Transform& a_from_b, const core::Vec3& sweep,
                                       double mesh_size, core::DistanceEngine& engine) {
    BodyPairDistance found{.engine = std::string(engine.name())};
    const Stopwatch modelling;
    FEELER_TRY(const auto points_a, points_of(a, mesh_size));
    FEELER_TRY(const auto points_b, points_of(b, mesh_size));
    found.points_a = points_a.size();
    found.points_b = points_b.size();
    found.model_seconds = modelling.seconds();

    const Stopwatch building;
    FEELER_TRY(const core::PointBody in_a, engine.add(points_a));
    FEELER_TRY(const core::PointBody in_b, engine.add(points_b));
    found.build_seconds = building.seconds();

    const Stopwatch asking;
    FEELER_TRY(const core::ClosestPair pair,
               engine.closest_pair(in_a, in_b, a_from_b, {.sweep = sweep}));
    find_points(pair, found);
    found.query_seconds = asking.seconds();

    const Stopwatch proving;
    const core::ExactBody exact_a = exact(a), exact_b = exact(b);
    const double slack = rounding(core::bounds(exact_a)) + rounding(core::bounds(exact_b))
                         + 1e-12 * (glm::length(a_from_b.translation) + glm::length(sweep));
    find_bounds(core::separation(exact_a, exact_b, a_from_b, sweep), slack, found);
    found.exact_seconds = proving.seconds();
    return found;
}

} // namespace app
