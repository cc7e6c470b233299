#include <map>

#include <gtest/gtest.h>

#include "core/motion/machine.h"
#include "render/body_mesh.h"
#include "render/line_pass.h"
#include "render/motion_path.h"
#include "render/setup_scene.h"
#include "tests/render/sample_scene.h"
#include "tests/support/meshes.h"

namespace render {
namespace {

using core::Vec3;

double volume(const TriangleMesh& mesh) {
    double six = 0.0;
    for (const TriangleMesh::Corners& t : mesh.triangles) {
        const auto at = [&](size_t i) { return Vec3(mesh.vertices[t[i]].position); };
        six += glm::dot(at(0), glm::cross(at(1), at(2)));
    }
    return six / 6.0;
}

bool is_closed(const TriangleMesh& mesh) {
    using Place = std::array<float, 3>;
    std::map<std::pair<Place, Place>, int> passes;
    for (const TriangleMesh::Corners& t : mesh.triangles)
        for (size_t k = 0; k < 3; ++k) {
            const auto at = [&](size_t i) {
                const glm::vec3& p = mesh.vertices[t[i % 3]].position;
                return Place{p.x, p.y, p.z};
            };
            const Place a = at(k), b = at(k + 1);
            passes[std::minmax(a, b)] += a < b ? 1 : -1;
        }
    return std::all_of(passes.begin(), passes.end(), [](const auto& p) { return p.second == 0; });
}

constexpr double pi = 3.14159265358979;

TEST(BodyMesh, IsClosedAndHasTheVolumeOfTheBody) {
    const auto check = [](const TriangleMesh& mesh, double expected) {
        EXPECT_TRUE(mesh.closed);
        EXPECT_TRUE(is_closed(mesh));
        EXPECT_NEAR(volume(mesh) / expected, 1.0, 0.012);
    };
    check(mesh_of(core::Primitive(core::Box{{10, 20, 30}})), 6000.0);
    check(mesh_of(core::Primitive(core::Sphere{12})), 4.0 / 3.0 * pi * 1728);
    check(mesh_of(core::Primitive(core::Cylinder{5, 40})), pi * 25 * 40);
    check(mesh_of(core::ExactBody(core::convex(core::Aabb{{0, 0, 0}, {1, 2, 3}}))), 6.0);
    check(mesh_of(core::Solid{core::SolidCylinder{{1, 2, 3}, 10, 50, 0}, 0.0}), pi * 100 * 50);
    check(mesh_of(core::convex_sphere(7.0)), 4.0 / 3.0 * pi * 343);
}

TEST(BodyMesh, HasThePositionOfTheBody) {
    const core::ConvexShape cone =
        core::posed(core::convex(core::ProfileElement{0.0, 6.0, 20.0, 2.0, 0.0}),
                    {core::rotation_xyz_deg({90, 0, 0}), {5, 6, 7}});
    const TriangleMesh mesh = mesh_of(cone);
    const core::Aabb expected = core::bounds(cone);
    EXPECT_LT(glm::distance(mesh.bounds.min, expected.min), 0.1);
    EXPECT_LT(glm::distance(mesh.bounds.max, expected.max), 0.1);
}

TEST(ProfileMesh, ShowsNoPieceWithinAnother) {
    // The flutes of a T-slot cutter reach into the neck.
    const core::RevolvedProfile profile{{{0, 10, 5, 10, 0}, {4.8, 4, 30, 4, 0}}};
    const std::vector<OutlinePoint> outline = outline_of(profile, 0.02);
    const std::vector<OutlinePoint> expected = {{0, 0}, {10, 0}, {10, 5}, {4, 5}, {4, 30}, {0, 30}};
    ASSERT_EQ(outline.size(), expected.size());
    for (size_t i = 0; i < expected.size(); ++i) {
        EXPECT_NEAR(outline[i].r, expected[i].r, 1e-9) << i;
        EXPECT_NEAR(outline[i].z, expected[i].z, 1e-9) << i;
    }
    EXPECT_NEAR(volume(mesh_of(profile)) / (pi * (100 * 5 + 16 * 25)), 1.0, 0.005);
}

TEST(ProfileMesh, FindsWhereFlanksCross) {
    const core::RevolvedProfile cross{{{0, 10, 10, 0, 0}, {0, 0, 10, 10, 0}}};
    double narrowest = 100.0;
    for (const OutlinePoint& p : outline_of(cross, 0.02))
        if (p.r > 0.0) narrowest = std::min(narrowest, p.r);
    EXPECT_NEAR(narrowest, 5.0, 1e-9);
}

TEST(ProfileMesh, IsSmoothRoundAndCrispAtRims) {
    const TriangleMesh ball_end =
        mesh_of(core::RevolvedProfile{{{8, 0, 8, 0, 8}, {8, 8, 30, 8, 0}}});
    EXPECT_TRUE(is_closed(ball_end));
    size_t on_ball = 0;
    for (const MeshVertex& v : ball_end.vertices) {
        const Vec3 p(v.position), n = unpacked_normal(v);
        if (p.z > 7.0) continue;
        EXPECT_GT(glm::dot(n, glm::normalize(p - Vec3(0, 0, 8))), 0.985);
        ++on_ball;
    }
    EXPECT_GT(on_ball, 100u);
    for (const auto& [a, b] : ball_end.edges) EXPECT_NEAR(a.z, 30.0F, 1e-5F); // the top rim alone
    EXPECT_GT(ball_end.edges.size(), 20u);
}

TEST(ShadedMesh, HasANormalForEachFaceOfABox) {
    const TriangleMesh mesh = mesh_of(core::Primitive(core::Box{{1, 1, 1}}));
    EXPECT_EQ(mesh.vertices.size(), 24u);
    EXPECT_EQ(mesh.edges.size(), 12u);
    EXPECT_EQ(sizeof(MeshVertex), 16u);
}

TEST(SetupScene, PlacesTheToolAtTheAxisPositions) {
    const core::Setup setup = sample_setup();
    const core::ToolAssembly tool = sample_tool();
    const core::AxisValues values{12.0, -7.0, 100.0};
    const std::vector<Body> bodies = tool_bodies(setup, tool, tool_meshes(tool), values);
    ASSERT_EQ(bodies.size(), 3u);
    EXPECT_EQ(bodies[0].role, BodyRole::flutes);
    EXPECT_EQ(bodies[2].role, BodyRole::holder);
    EXPECT_LT(bodies[2].alpha, 1.0);
    const Vec3 tip = tip_in_stock(setup, tool.length, values);
    EXPECT_LT(glm::distance(tip, Vec3(12.0, -7.0, 100.0 - tool.length)), 1e-9);
    EXPECT_NEAR(bounds(bodies[0]).min.z, tip.z, 1e-4);
    EXPECT_NEAR(bounds(bodies[0]).center().x, 12.0, 1e-4);
}

TEST(SetupScene, IsSeenFromAStockThatTurns) {
    core::Setup setup = sample_setup();
    core::MachineAxis& a = setup.machine.axes[3];
    a.present = true;
    a.direction = {1, 0, 0};
    a.side = core::Side::table;
    setup.machine.table = core::link_of(3);
    setup.stock_mount = {core::link_of(3), core::translation({0, 0, -50})};
    for (core::Fixture& fixture : setup.fixtures) fixture.mount = setup.stock_mount;
    core::AxisValues values{};
    const std::vector<Body> at_rest = setup_bodies(setup, setup_meshes(setup), values);
    const Vec3 tip = tip_in_stock(setup, 80.0, values);
    values[3] = 90.0;
    const std::vector<Body> turned = setup_bodies(setup, setup_meshes(setup), values);
    for (size_t i = 0; i < turned.size(); ++i) // on the table, as the stock is
        EXPECT_LT(glm::distance(bounds(turned[i]).max, bounds(at_rest[i]).max), 1e-9);
    const Vec3 after = tip_in_stock(setup, 80.0, values);
    EXPECT_LT(glm::distance(tip, Vec3(0, 0, -30)), 1e-9);
    EXPECT_NEAR(glm::length(after - Vec3(0, 0, 50)), 80.0, 1e-9); // about the axis
    EXPECT_NEAR(after.z, 50.0, 1e-9);
}

TEST(SetupScene, TellsVisesAndClampsByTheirNames) {
    for (const char* name : {"vise6-body", "Fixed JAW", "chuck", "vice bed"})
        EXPECT_TRUE(is_vise(name)) << name;
    for (const char* name : {"clamp left", "Strap-2"}) EXPECT_TRUE(is_clamp(name)) << name;
    for (const char* name : {"parallel-1", "table", "stud", ""}) {
        EXPECT_FALSE(is_vise(name)) << name;
        EXPECT_FALSE(is_clamp(name)) << name;
    }
}

TEST(SetupScene, LeavesOutFixturesThatAreNotThere) {
    core::Setup setup = sample_setup();
    setup.fixtures[1].is_there = false;
    const SetupMeshes meshes = setup_meshes(setup);
    EXPECT_EQ(setup_bodies(setup, meshes, {}).size(), setup.fixtures.size() - 1);
    std::vector<bool> there(setup.fixtures.size(), false);
    there[4] = true;
    const std::vector<Body> bodies = setup_bodies(setup, meshes, {}, there);
    ASSERT_EQ(bodies.size(), 1u);
    EXPECT_EQ(bodies[0].name, "clamp-1");
    EXPECT_EQ(bodies[0].role, BodyRole::clamp);
}

TEST(SetupScene, HasRoughVersionsOfLargeMeshesOnly) {
    core::Setup setup = sample_setup();
    setup.fixtures[0].body = core::solid_mesh(test_support::ball_mesh(40.0, 300, 400));
    SurfaceMaker maker;
    const SetupMeshes meshes = maker.meshes_of(setup);
    ASSERT_TRUE(meshes.fixtures[0]->rough);
    EXPECT_GT(meshes.fixtures[0]->triangles.size(), 200'000u);
    EXPECT_LE(meshes.fixtures[0]->rough->triangles.size(), 40'000u);
    EXPECT_NEAR(volume(*meshes.fixtures[0]->rough) / volume(*meshes.fixtures[0]), 1.0, 0.01);
    for (size_t i = 1; i < meshes.fixtures.size(); ++i) EXPECT_FALSE(meshes.fixtures[i]->rough);
    // It is made once, as long as set-ups have it.
    setup.fixtures[1].name = "other";
    EXPECT_EQ(maker.meshes_of(setup).fixtures[0], meshes.fixtures[0]);
    const core::ExactBody ball = std::exchange(setup.fixtures[0].body, setup.fixtures[1].body);
    maker.meshes_of(setup);
    setup.fixtures[0].body = ball;
    EXPECT_NE(maker.meshes_of(setup).fixtures[0], meshes.fixtures[0]);
}

TEST(ToolPath, FindsThePointsOfABlock) {
    std::vector<PathPoint> points;
    for (uint32_t i = 0; i < 500; ++i)
        points.push_back({.position = {static_cast<float>(i), 0, 0}, .block = i / 3});
    points[0].begins = true;
    const ToolPath path = tool_path(points);
    EXPECT_EQ(points_of_block(path, 7), (std::pair<size_t, size_t>(21, 24)));
    EXPECT_EQ(points_of_block(path, 4711), (std::pair<size_t, size_t>(0, 0)));
    EXPECT_NEAR(bounds_of_block(path, 7).min.x, 20.0, 1e-6); // from the end of the block before
    EXPECT_NEAR(bounds_of_block(path, 7).max.x, 23.0, 1e-6);
    EXPECT_NEAR(path.bounds.max.x, 499.0, 1e-6);
}

/// A step of a millimetre along X for each block.
ToolPath steps(uint32_t count) {
    std::vector<PathPoint> points;
    for (uint32_t i = 0; i < count; ++i)
        points.push_back({.position = {static_cast<float>(i), 0, 0}, .block = i});
    return tool_path(std::move(points));
}

std::pair<uint32_t, uint32_t> ends(const ToolPath& path) {
    return {path.points.front().block, path.points.back().block};
}

TEST(ToolPath, KeepsWhatIsNearABlock) {
    using Ends = std::pair<uint32_t, uint32_t>;
    const ToolPath path = steps(1000);
    // With the place from which the first of so many blocks goes.
    const PathReach blocks{.before = 30, .after = 8, .length_before = 0, .length_after = 0};
    EXPECT_EQ(ends(path_near(path, 500, blocks)), Ends(469, 508));
    EXPECT_TRUE(path_near(path, 500, blocks).points[0].begins);
    const PathReach way{.before = 0, .after = 0, .length_before = 99.5, .length_after = 9.5};
    EXPECT_EQ(ends(path_near(path, 500, way)), Ends(400, 510));
    const PathReach all{.before = 5000, .after = 5000, .most = 7};
    EXPECT_EQ(ends(path_near(path, 500, all)), Ends(493, 507));
    EXPECT_EQ(ends(path_near(path, 0, blocks)), Ends(0, 8));
    EXPECT_EQ(ends(path_near(path, 999, blocks)), Ends(968, 999));
    EXPECT_TRUE(path_near(tool_path({}), 0, {}).points.empty());
}

TEST(ToolPath, KeepsWhatIsNearABlockThatDoesNotMove) {
    std::vector<PathPoint> points = steps(20).points;
    std::erase_if(points, [](const PathPoint& point) { return point.block == 10; });
    const ToolPath near = path_near(
        tool_path(points), 10, {.before = 2, .after = 2, .length_before = 0, .length_after = 0});
    EXPECT_EQ(ends(near), (std::pair<uint32_t, uint32_t>(7, 12)));
}

core::Leg leg(const core::AxisValues& from, const core::AxisValues& to) {
    return {.positions = {from, to}};
}

TEST(MotionPath, FollowsTheLegsOfADogLeg) {
    const core::Setup setup = sample_setup();
    std::vector<PathPoint> points;
    const core::Path path{{leg({0, 0, 100}, {10, 10, 100}), leg({10, 10, 100}, {30, 10, 100})}};
    append_motion(points, setup, 80.0, path, {.block = 3, .rapid = true});
    append_motion(points, setup, 80.0, {{leg({30, 10, 100}, {30, 10, 90})}}, {.block = 4});
    ASSERT_EQ(points.size(), 4u);
    EXPECT_TRUE(points[0].begins);
    EXPECT_EQ(points[1].position, glm::vec3(10, 10, 20));
    EXPECT_TRUE(points[2].rapid && !points[2].begins);
    EXPECT_EQ(points[3].position, glm::vec3(30, 10, 10));
    EXPECT_EQ(points[3].block, 4u);
    append_motion(points, setup, 70.0, {{leg({30, 10, 90}, {31, 10, 90})}}, {.block = 5});
    EXPECT_TRUE(points[4].begins); // a tool of another length
}

TEST(MotionPath, BendsWhereTheTableTurns) {
    core::Setup setup = sample_setup();
    core::MachineAxis& c = setup.machine.axes[5];
    c.present = true;
    c.direction = {0, 0, 1};
    c.side = core::Side::table;
    setup.machine.table = core::link_of(5);
    setup.stock_mount.link = core::link_of(5);
    std::vector<PathPoint> points;
    core::AxisValues from{40, 0, 50}, to = from;
    to[5] = 90.0;
    append_motion(points, setup, 50.0, {{leg(from, to)}}, {});
    EXPECT_GE(points.size(), 30u);
    for (const PathPoint& p : points) EXPECT_NEAR(glm::length(p.position), 40.0, 1e-4);
    EXPECT_NEAR(std::abs(points.back().position.y), 40.0, 1e-4);
}

TEST(MotionPath, OmitsAnUnknownPath) {
    const core::Setup setup = sample_setup();
    std::vector<PathPoint> points;
    core::Leg unknown{.positions = {{0, 0, 0}, {10, 0, 0}, {0, 10, 0}, {10, 10, 0}},
                      .straight = false,
                      .start_known = false,
                      .certain = {{10, 10, 0}}};
    append_motion(points, setup, 0.0, {{unknown}}, {});
    ASSERT_EQ(points.size(), 1u);
    EXPECT_TRUE(points[0].begins);
}

/// A raster over hills, with pieces in violation and a gap.
std::vector<PathPoint> raster() {
    std::vector<PathPoint> points;
    for (uint32_t i = 0; i < 20'000; ++i) {
        const float x = static_cast<float>(i % 200) * 0.25F, y = static_cast<float>(i / 200) * 0.4F;
        points.push_back({.position = {x, y, 3.0F * std::sin(x * 0.3F) * std::cos(y * 0.2F)},
                          .block = i,
                          .state = i % 700 < 9 ? ClearanceState::violation : ClearanceState::clear,
                          .rapid = i % 200 == 0,
                          .begins = i == 0 || i == 5000});
    }
    return points;
}

TEST(SimplifiedPath, StaysWithinItsToleranceAndKeepsStates) {
    const std::vector<PathPoint> points = raster();
    for (const double tolerance : {0.01, 0.1}) {
        const std::vector<PathPoint> kept = simplified(points, tolerance);
        EXPECT_LT(kept.size(), points.size() / (tolerance > 0.05 ? 6 : 2));
        size_t next = 0; // blocks tell which point is which
        double farthest = 0.0;
        for (size_t i = 1; i < kept.size(); ++i) {
            const Vec3 a(kept[i - 1].position), b(kept[i].position), by = b - a;
            for (; next <= kept[i].block; ++next) {
                const PathPoint& p = points[next];
                if (next > kept[i - 1].block) {
                    EXPECT_EQ(p.state, kept[i].state);
                    EXPECT_EQ(p.rapid, kept[i].rapid);
                    EXPECT_EQ(p.begins, kept[i].begins);
                }
                const double t =
                    std::clamp(glm::dot(Vec3(p.position) - a, by) / glm::dot(by, by), 0.0, 1.0);
                farthest = std::max(farthest, glm::distance(Vec3(p.position), a + t * by));
            }
        }
        EXPECT_EQ(next, points.size());
        EXPECT_LE(farthest, tolerance * 1.001);
        EXPECT_GT(farthest, 0.5 * tolerance); // no more points than need be
    }
}

TEST(VisiblePath, LeavesOutNothingThatIsSeen) {
    const ToolPath path = tool_path(raster());
    const Viewport viewport{800, 500};
    Camera camera;
    camera.target = {10, 10, 0};
    camera.distance = 25;
    const auto ranges = visible_ranges(path, clip_from_view(camera, viewport, path.bounds)
                                                 * view_from_scene(camera));
    size_t drawn = 0, seen = 0;
    for (const PathRange& range : ranges) drawn += range.last - range.first;
    for (size_t i = 1; i < path.points.size(); ++i) {
        const auto at = project(camera, viewport, Vec3(path.points[i].position));
        if (!at || at->position.x < 0 || at->position.y < 0 || at->position.x > viewport.width
            || at->position.y > viewport.height || at->depth < 1.0)
            continue;
        ++seen;
        EXPECT_TRUE(std::any_of(ranges.begin(), ranges.end(), [&](const PathRange& range) {
            return range.first <= i && i < range.last;
        })) << i;
    }
    EXPECT_GT(seen, 200u);
    EXPECT_LT(drawn, path.points.size() * 3 / 4);
}

TEST(Scene, BoundsHoldAllThatIsVisible) {
    Scene scene = sample_scene(2.0);
    const core::Aabb all = bounds(scene);
    EXPECT_NEAR(all.min.z, -100.0, 1e-4);
    EXPECT_GT(all.max.z, 140.0); // the holder
    const core::Aabb work = work_bounds(scene);
    EXPECT_LT(work.max.z, 30.0);
    EXPECT_NEAR(work.min.z, -66.0, 1e-4); // without the machine's table
    for (Body& body : scene.bodies) body.visible = false;
    scene.path_visible = false;
    scene.witness.reset();
    EXPECT_NEAR(bounds(scene).min.z, -30.0, 1e-3);
}

} // namespace
} // namespace render
