#include "app/bench/bench_scene.h"

#include <cmath>

#include "app/base/stopwatch.h"
#include "core/base/math.h"
#include "core/dbm/mesh_scan.h"

namespace app {
namespace {

using core::Transform;
using core::translation;
using core::Vec3;

const std::vector<double> paper_mesh_sizes = {0.5, 1.0, 1.5, 2.0};
const std::vector<double> fine_and_coarse = {0.5, 1.0};

const Vec3 askew = glm::normalize(Vec3(1.0, 0.35, 0.2));

Transform turned_by(const Vec3& angles_deg) { return {core::rotation_xyz_deg(angles_deg), {}}; }

/// Two spheres of 50 mm; B is turned, then moved along the direction.
BenchScene spheres(const Vec3& direction, const Vec3& angles_deg) {
    BenchScene scene{.name = "spheres",
                     .a = core::Sphere{25.0},
                     .b = core::Sphere{25.0},
                     .mesh_sizes = paper_mesh_sizes};
    for (const double gap : {0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 50.0})
        scene.poses.push_back({gap, translation((50.0 + gap) * direction) * turned_by(angles_deg)});
    return scene;
}

BenchScene askew_spheres() {
    BenchScene scene = spheres(askew, Vec3(0.0));
    scene.direction = "generic";
    scene.title = "Two spheres of 50 mm, moved apart along (1, 0.35, 0.2)";
    return scene;
}

BenchScene turned_spheres() {
    BenchScene scene = spheres(askew, {10.0, 20.0, 30.0});
    scene.direction = "turned";
    scene.title = "Two spheres of 50 mm, moved apart along (1, 0.35, 0.2), one of them turned by "
                  "10, 20 and 30 degrees about X, Y and Z";
    return scene;
}

/// Two rings at right angles, linked.
///
/// The centre circle of B crosses the plane of A's at s = offset - ring from A's centre. While 0 <=
/// s < ring, that is its nearest point to A's circle, ring - s away. At s = 0, every point of B is
/// equally near.
BenchScene linked_tori() {
    const Torus torus{25.0, 5.0};
    BenchScene scene{.name = "linked-tori",
                     .direction = "turned",
                     .title =
                         "Two linked tori of 60 mm, tubes of 10 mm, at right angles, turned "
                         "each about its own axis; at 15 mm their distance is the same all around",
                     .a = torus,
                     .b = torus,
                     .mesh_sizes = fine_and_coarse};
    for (const double gap : {0.5, 1.0, 2.0, 5.0, 10.0, 15.0}) {
        const double offset = 2.0 * (torus.ring - torus.tube) - gap;
        scene.poses.push_back({gap, turned_by({0.0, 0.0, 25.0}) * translation({offset, 0.0, 0.0})
                                        * turned_by({90.0, 0.0, 0.0})
                                        * turned_by({0.0, 0.0, 17.0})});
    }
    return scene;
}

/// A pin off the centre of a bore, farther from its floor than from its wall.
BenchScene pin_in_cup() {
    const Cup cup{25.0, 40.0, 20.0, 35.0};
    const core::Cylinder pin{8.0, 30.0};
    BenchScene scene{.name = "pin-in-cup",
                     .direction = "turned",
                     .title = "A pin of 16 mm in a cup with a bore of 40 mm, turned about its axis",
                     .a = cup,
                     .b = pin,
                     .mesh_sizes = fine_and_coarse};
    const double floor = 0.5 * cup.height - cup.depth;
    for (const double gap : {0.5, 1.0, 2.0, 5.0, 10.0}) {
        const double off_axis = cup.bore - pin.radius - gap;
        const double lift = floor + 20.0 + 0.5 * pin.height;
        scene.poses.push_back({gap, turned_by({0.0, 0.0, 25.0}) * translation({off_axis, 0.0, lift})
                                        * turned_by({0.0, 0.0, 17.0})});
    }
    return scene;
}

/// A holder's flat end above a flat stock.
BenchScene holder_over_stock(double angle_deg) {
    const core::Box stock{{100.0, 100.0, 30.0}}, holder{{40.0, 40.0, 60.0}};
    BenchScene scene{.name = "holder-over-stock",
                     .direction = "axis",
                     .title = "A holder of 40 x 40 mm above a stock of 100 x 100 mm, face to face",
                     .a = stock,
                     .b = holder,
                     .mesh_sizes = {0.5}};
    if (angle_deg != 0.0) {
        scene.direction = "turned";
        scene.title += ", the holder turned by 30 degrees about Z";
    }
    for (const double gap : {1.0, 2.0, 5.0, 10.0, 15.0}) {
        const double lift = 0.5 * (stock.size.z + holder.size.z) + gap;
        scene.poses.push_back(
            {gap, translation({7.3, -4.6, lift}) * turned_by({0.0, 0.0, angle_deg})});
    }
    return scene;
}

core::Result<core::Dbm> scanned(const core::Primitive& body, double mesh_size) {
    return core::scan(body, mesh_size);
}

template <typename Body>
core::Result<core::Dbm> scanned(const Body& body, double mesh_size) {
    return core::scan_lines_of(bounds(body), mesh_size, [&](int axis, double u, double v) {
        return line_of(body, axis, u, v);
    });
}

} // namespace

BenchScene paper_scene() {
    BenchScene scene = spheres({1.0, 0.0, 0.0}, Vec3(0.0));
    scene.direction = "axis";
    scene.title = "Two spheres of 50 mm, moved apart along X, as in the paper";
    return scene;
}

std::vector<BenchScene> bench_scenes() {
    return {paper_scene(), askew_spheres(),        turned_spheres(),       linked_tori(),
            pin_in_cup(),  holder_over_stock(0.0), holder_over_stock(30.0)};
}

core::Result<std::vector<core::Vec3>> points_of(const BenchBody& body, double mesh_size) {
    FEELER_TRY(const core::Dbm dbm,
               std::visit([&](const auto& shape) { return scanned(shape, mesh_size); }, body));
    return core::boundary_points(dbm);
}

namespace {

core::IntervalList symmetric(double half) {
    return core::IntervalList(core::Interval{-half, half});
}

/// Half the chord of a circle on a line at this distance from its centre; 0 if they do not meet.
double half_chord(double radius, double distance) {
    return std::sqrt(std::max(0.0, radius * radius - distance * distance));
}

/// A line perpendicular to Z, at distance `aside` from the axis, between two circles around it.
core::IntervalList across_ring(double outer, double inner, double aside) {
    core::IntervalList matter = symmetric(half_chord(outer, aside));
    const double hole = half_chord(inner, aside);
    matter.subtract({-hole, hole});
    return matter;
}

} // namespace

core::IntervalList line_of(const Torus& torus, int axis, double u, double v) {
    if (axis == 2) return symmetric(half_chord(torus.tube, core::hypot(u, v) - torus.ring));
    const double aside = axis == 0 ? u : v, height = axis == 0 ? v : u;
    const double half = half_chord(torus.tube, height);
    if (half == 0.0) return {};
    return across_ring(torus.ring + half, torus.ring - half, aside);
}

core::IntervalList line_of(const Cup& cup, int axis, double u, double v) {
    const double top = 0.5 * cup.height, floor = top - cup.depth;
    if (axis == 2) {
        const double from_axis = core::hypot(u, v);
        if (from_axis >= cup.radius) return {};
        return core::IntervalList(core::Interval{-top, from_axis < cup.bore ? floor : top});
    }
    const double aside = axis == 0 ? u : v, height = axis == 0 ? v : u;
    if (height < -top || height >= top) return {};
    return across_ring(cup.radius, height < floor ? 0.0 : cup.bore, aside);
}

core::Aabb bounds(const Torus& torus) {
    const core::Vec3 corner(torus.ring + torus.tube, torus.ring + torus.tube, torus.tube);
    return {-corner, corner};
}

core::Aabb bounds(const Cup& cup) {
    const core::Vec3 corner(cup.radius, cup.radius, 0.5 * cup.height);
    return {-corner, corner};
}

namespace {

/// Bound of the error of double precision, mm: below 1e-9 within 2 m, growing with the coordinates.
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
