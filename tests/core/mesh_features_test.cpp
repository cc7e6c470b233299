#include <algorithm>
#include <filesystem>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "core/geom/mesh_features.h"
#include "core/geom/mesh_file.h"
#include "core/geom/mesh_sides.h"
#include "tests/support/feature_bodies.h"
#include "tests/support/meshes.h"

namespace core {
namespace {

using test_support::ball_mesh;
using test_support::bored_block;
using test_support::box_mesh;
using test_support::in_single_precision;
using test_support::moved;
using test_support::prism_mesh;
using test_support::ProfilePoint;
using test_support::random_pose;
using test_support::rounded_box;
using test_support::rounded_rectangle;
using test_support::shuffled;
using test_support::torus_mesh;
using test_support::turned_mesh;

using Profile = std::vector<ProfilePoint>;

constexpr double full_turn = 2.0 * std::numbers::pi;

MeshFeatures features_of_asset(const std::string& name) {
    const auto file = read_mesh(std::filesystem::path(FEELER_SOURCE_DIR) / "assets/meshes" / name);
    EXPECT_TRUE(file.has_value()) << name;
    return file ? features_of(file->mesh) : MeshFeatures{};
}

/// Whether some point of the list is within `tolerance` of p.
template <typename List, typename PointOf>
bool has_near(const List& list, const Vec3& p, double tolerance, const PointOf& point_of) {
    return std::any_of(list.begin(), list.end(), [&](const auto& item) {
        return glm::distance(point_of(item), p) <= tolerance;
    });
}

size_t count_of(const MeshFeatures& features, RoundKind kind) {
    return static_cast<size_t>(
        std::count_if(features.walls.begin(), features.walls.end(),
                      [&](const RoundWall& wall) { return wall.kind == kind; }));
}

void expect_same_numbers(const MeshFeatures& a, const MeshFeatures& b) {
    EXPECT_EQ(a.faces.size(), b.faces.size());
    EXPECT_EQ(a.edges.size(), b.edges.size());
    EXPECT_EQ(a.corners.size(), b.corners.size());
    EXPECT_EQ(a.circles.size(), b.circles.size());
    EXPECT_EQ(a.walls.size(), b.walls.size());
}

/// Every index that a feature holds exists.
void expect_consistent(const MeshFeatures& f, const Mesh& mesh) {
    const auto expect_index = [](uint32_t index, size_t size) {
        EXPECT_TRUE(index == no_index || index < size);
    };
    ASSERT_EQ(f.face_of.size(), mesh.triangles.size());
    ASSERT_EQ(f.wall_of.size(), mesh.triangles.size());
    for (const uint32_t face : f.face_of) expect_index(face, f.faces.size());
    for (const uint32_t wall : f.wall_of) expect_index(wall, f.walls.size());
    for (const StraightEdge& e : f.edges) {
        EXPECT_LT(e.faces[0], f.faces.size());
        expect_index(e.faces[1], f.faces.size());
        EXPECT_GT(glm::distance(e.from, e.to), 0.0);
    }
    for (const FeatureCorner& c : f.corners) EXPECT_GE(c.faces.size(), 3u);
    for (const FeatureCircle& c : f.circles) {
        expect_index(c.face, f.faces.size());
        expect_index(c.wall, f.walls.size());
        EXPECT_NEAR(glm::length(c.axis), 1.0, 1e-9);
        EXPECT_TRUE(is_finite(c.center) && c.radius > 0.0);
    }
    for (const RoundWall& w : f.walls)
        for (const uint32_t rim : w.rims) expect_index(rim, f.circles.size());
    for (const PlanarFace& face : f.faces) {
        EXPECT_NEAR(glm::length(face.normal), 1.0, 1e-9);
        EXPECT_TRUE(is_finite(face.centroid) && is_finite(face.center) && face.area > 0.0);
    }
}

TEST(MeshFeatures, OfABoxAreExact) {
    const MeshFeatures f = features_of(box_mesh({-1, -2, 3}, {5, 4, 10}));
    ASSERT_EQ(f.faces.size(), 6u);
    EXPECT_EQ(f.edges.size(), 12u);
    EXPECT_EQ(f.corners.size(), 8u);
    EXPECT_TRUE(f.circles.empty() && f.walls.empty());
    const auto top = std::find_if(f.faces.begin(), f.faces.end(),
                                  [](const PlanarFace& a) { return a.normal == Vec3(0, 0, 1); });
    ASSERT_NE(top, f.faces.end());
    EXPECT_NEAR(top->area, 36.0, 1e-12);
    EXPECT_NEAR(glm::distance(top->center, Vec3(2, 1, 10)), 0.0, 1e-12);
    EXPECT_EQ(top->loops.size(), 1u);
    EXPECT_EQ(top->loops[0].size(), 4u);
    for (const FeatureCorner& corner : f.corners) {
        EXPECT_NEAR(glm::distance(corner.point, corner.sharp), 0.0, 1e-12);
        EXPECT_EQ(corner.faces.size(), 3u);
    }
}

TEST(MeshFeatures, OfABoredBlockAreFoundInAnyPoseInSinglePrecision) {
    std::mt19937 rng(7);
    for (const uint32_t chords : {8u, 16u, 40u, 104u, 504u})
        for (int i = 0; i < 12; ++i) {
            const Transform pose = i == 0 ? Transform{} : random_pose(rng, 200.0);
            const Mesh plain = bored_block(50.0, 30.0, 12.0, chords);
            const Mesh mesh = in_single_precision(shuffled(moved(plain, pose), rng));
            const MeshFeatures f = features_of(mesh);
            expect_consistent(f, mesh);
            // The sides of an octagon are faces too, as those of a nut.
            const size_t flats = chords == 8 ? 8 : 0;
            EXPECT_EQ(f.faces.size(), 6 + flats) << chords;
            EXPECT_EQ(f.edges.size(), 12 + flats) << chords;
            EXPECT_EQ(f.corners.size(), 8u) << chords;
            ASSERT_EQ(f.circles.size(), 2u) << chords;
            ASSERT_EQ(f.walls.size(), 1u) << chords;
            EXPECT_TRUE(f.walls[0].through() && f.walls[0].is_cylinder());
            for (const double z : {0.0, 30.0}) {
                const Vec3 center = pose * Vec3(0, 0, z);
                EXPECT_TRUE(has_near(f.circles, center, 2e-5,
                                     [](const FeatureCircle& c) { return c.center; }));
                for (const double x : {-50.0, 50.0})
                    for (const double y : {-50.0, 50.0})
                        EXPECT_TRUE(has_near(f.corners, pose * Vec3(x, y, z), 1e-4,
                                             [](const FeatureCorner& c) { return c.sharp; }));
            }
            for (const FeatureCircle& c : f.circles) {
                EXPECT_NEAR(c.radius, 12.0, 2e-5);
                EXPECT_NEAR(c.inscribed_radius, 12.0 * std::cos(std::numbers::pi / chords), 1e-4);
                EXPECT_EQ(c.kind, RoundKind::bore);
                EXPECT_FALSE(c.arc || c.outer);
                EXPECT_EQ(c.wall, 0u);
                EXPECT_NEAR(std::abs(glm::dot(c.axis, pose.rotation[2])), 1.0, 1e-9);
            }
            const double bore_area = 0.5 * chords * 144.0 * std::sin(full_turn / chords);
            for (const PlanarFace& face : f.faces) {
                if (face.loops.size() != 2) continue;
                EXPECT_NEAR(face.area, 1e4 - bore_area, 1e-1);
                EXPECT_EQ(face.loops[0].size(), 4u);
                EXPECT_NEAR(face.half[0], 50.0, 1e-4);
            }
        }
}

/// Base, boss with a chamfer, counterbore, and a drilled hole with its tip.
const Profile stepped = {{0, 0},   {30, 0},  {30, 20}, {15, 20}, {15, 38}, {13, 40},
                         {10, 40}, {10, 35}, {5, 35},  {5, 10},  {0, 7}};

TEST(MeshFeatures, OfATurnedPartAreItsSteps) {
    std::mt19937 rng(8);
    for (const uint32_t chords : {12u, 13u, 36u, 500u})
        for (const bool twist : {false, true}) {
            const Transform pose = random_pose(rng, 100.0);
            const Mesh mesh = in_single_precision(moved(turned_mesh(stepped, chords, twist), pose));
            const MeshFeatures f = features_of(mesh);
            expect_consistent(f, mesh);
            EXPECT_EQ(f.faces.size(), 4u) << chords;
            EXPECT_EQ(f.edges.size() + f.corners.size(), 0u) << chords;
            EXPECT_EQ(f.circles.size(), 9u) << chords;
            ASSERT_EQ(f.walls.size(), 6u) << chords;
            EXPECT_EQ(count_of(f, RoundKind::bore), 3u);
            for (const RoundWall& wall : f.walls) {
                EXPECT_TRUE(wall.full);
                EXPECT_FALSE(wall.through());
                EXPECT_NEAR(std::abs(glm::dot(wall.axis(), pose.rotation[2])), 1.0, 1e-8);
            }
            const auto wall_of_radius = [&](double from, double to) {
                return std::any_of(f.walls.begin(), f.walls.end(), [&](const RoundWall& w) {
                    const auto [least, most] = std::minmax(w.radius_from, w.radius_to);
                    return std::abs(least - from) < 1e-3 && std::abs(most - to) < 1e-3;
                });
            };
            for (const double r : {30.0, 15.0, 10.0, 5.0}) EXPECT_TRUE(wall_of_radius(r, r)) << r;
            EXPECT_TRUE(wall_of_radius(13.0, 15.0) && wall_of_radius(0.0, 5.0)) << chords;
        }
}

TEST(MeshFeatures, TellBlindBoresFromThroughBores) {
    const MeshFeatures blind =
        features_of(turned_mesh(Profile{{0, 0}, {30, 0}, {30, 30}, {10, 30}, {10, 5}, {0, 5}}, 40));
    const MeshFeatures through =
        features_of(turned_mesh(Profile{{10, 0}, {30, 0}, {30, 30}, {12, 30}, {10, 28}}, 40));
    for (const RoundWall& w : blind.walls) EXPECT_FALSE(w.through());
    EXPECT_EQ(count_of(through, RoundKind::bore), 2u); // with its countersink
    for (const RoundWall& w : through.walls) EXPECT_EQ(w.through(), w.kind == RoundKind::bore);
}

TEST(MeshFeatures, FindConesThatGoOnInCylinders) {
    const MeshFeatures f =
        features_of(turned_mesh(Profile{{10, 0}, {40, 0}, {40, 60}, {12, 60}, {10, 20}}, 40));
    EXPECT_EQ(f.walls.size(), 3u);
    EXPECT_EQ(f.circles.size(), 5u);
    const MeshFeatures spindle =
        features_of(turned_mesh(Profile{{0, 0}, {20, 10}, {20, 30}, {0, 40}}, 40));
    EXPECT_EQ(spindle.walls.size(), 3u);
    EXPECT_EQ(spindle.circles.size(), 2u);
}

TEST(MeshFeatures, OfFreeFormsHaveNoFaces) {
    std::mt19937 rng(9);
    for (const uint32_t n : {24u, 60u, 200u})
        for (const bool posed : {false, true}) {
            const Transform pose = posed ? random_pose(rng, 60.0) : Transform{};
            for (const Mesh& mesh : {ball_mesh(5.0, n, n), ball_mesh(50.0, n, 2 * n),
                                     torus_mesh(20.0, 5.0, 2 * n, n + 1)}) {
                const MeshFeatures f = features_of(in_single_precision(moved(mesh, pose)));
                EXPECT_EQ(f.faces.size(), 0u) << n;
                EXPECT_EQ(f.edges.size() + f.corners.size() + f.circles.size(), 0u) << n;
                EXPECT_EQ(f.walls.size(), 0u) << n;
            }
        }
}

TEST(MeshFeatures, OfFilletsAreArcsAndPartsOfWalls) {
    std::mt19937 rng(10);
    for (const uint32_t chords : {3u, 4u, 6u, 30u, 100u})
        for (const double half_y : {25.0, 6.5}) {
            const Transform pose = random_pose(rng, 100.0);
            const Mesh mesh = in_single_precision(
                moved(prism_mesh(rounded_rectangle(40.0, half_y, 5.0, chords), 0, 10), pose));
            const MeshFeatures f = features_of(mesh);
            EXPECT_EQ(f.faces.size(), 6u) << chords;
            EXPECT_EQ(f.edges.size(), 8u) << chords; // none where a fillet begins
            EXPECT_EQ(f.corners.size(), 0u) << chords;
            ASSERT_EQ(f.circles.size(), 8u) << chords;
            ASSERT_EQ(f.walls.size(), 4u) << chords;
            for (const FeatureCircle& c : f.circles) {
                EXPECT_TRUE(c.arc);
                EXPECT_NEAR(c.angle, std::numbers::pi / 2, 1e-3);
                EXPECT_NEAR(c.radius, 5.0, 1e-3);
                EXPECT_NEAR(glm::distance(c.middle, c.center), c.radius, 1e-5);
                EXPECT_EQ(c.kind, RoundKind::boss);
                EXPECT_NE(c.wall, no_index);
            }
            for (const double x : {-35.0, 35.0})
                for (const double y : {5.0 - half_y, half_y - 5.0})
                    EXPECT_TRUE(has_near(f.circles, pose * Vec3(x, y, 10), 1e-3,
                                         [](const FeatureCircle& c) { return c.center; }));
            for (const RoundWall& w : f.walls) EXPECT_FALSE(w.full);
        }
}

TEST(MeshFeatures, FindWallsBetweenFilletsWithoutCircularEdges) {
    Profile profile = {{0, 0}, {30, 0}, {30, 20}};
    for (int i = 0; i <= 8; ++i) { // a fillet of 5 mm at the foot of a boss of radius 15
        const double a = std::numbers::pi / 16 * i;
        profile.push_back({20 - 5 * std::sin(a), 25 - 5 * std::cos(a)});
    }
    for (int i = 0; i < 6; ++i) {
        const double a = std::numbers::pi / 12 * i;
        profile.push_back({13 + 2 * std::cos(a), 40 + 2 * std::sin(a)});
    }
    profile.push_back({13, 42});
    profile.push_back({0, 42});
    const MeshFeatures f = features_of(turned_mesh(profile, 48));
    EXPECT_EQ(f.faces.size(), 3u);
    ASSERT_EQ(f.walls.size(), 2u);
    EXPECT_NEAR(f.walls[1].radius_to, 15.0, 1e-9);
    EXPECT_NEAR(glm::distance(f.walls[1].from, f.walls[1].to), 15.0, 1e-9);
    EXPECT_EQ(f.circles.size(), 6u); // with those where the fillets begin and end
}

TEST(MeshFeatures, OfARoundedBoxAreSixFacesAndTwelveFillets) {
    std::mt19937 rng(15);
    for (const uint32_t chords : {3u, 4u, 6u, 12u})
        for (const double radius : {2.0, 5.0}) {
            const Transform pose = random_pose(rng, 100.0);
            const Mesh mesh =
                in_single_precision(moved(rounded_box({40, 25, 10}, radius, chords), pose));
            const MeshFeatures f = features_of(mesh);
            expect_consistent(f, mesh);
            EXPECT_EQ(f.faces.size(), 6u) << chords;
            EXPECT_EQ(f.edges.size() + f.corners.size(), 0u) << chords;
            EXPECT_EQ(f.walls.size(), 12u) << chords;
            for (const RoundWall& w : f.walls) {
                EXPECT_NEAR(w.radius_from, radius, 1e-3);
                EXPECT_EQ(w.kind, RoundKind::boss);
                const Vec3 axis = glm::abs(w.axis() * pose.rotation);
                EXPECT_NEAR(std::max({axis.x, axis.y, axis.z}), 1.0, 1e-10);
            }
        }
}

TEST(MeshFeatures, DoNotTakePolygonsForCircles) {
    const Profile nut = {{0, 0}, {11, 0}, {11, 18}, {0, 18}};
    const MeshFeatures hexagon = features_of(turned_mesh(nut, 6));
    EXPECT_EQ(hexagon.faces.size(), 8u);
    EXPECT_EQ(hexagon.edges.size(), 18u);
    EXPECT_EQ(hexagon.corners.size(), 12u);
    EXPECT_TRUE(hexagon.circles.empty());
    // All its corners are on a circle.
    const std::vector<glm::dvec2> chamfered = {{10, -9}, {10, 9},   {9, 10},   {-9, 10},
                                               {-10, 9}, {-10, -9}, {-9, -10}, {9, -10}};
    const MeshFeatures square = features_of(prism_mesh(chamfered, 0, 5));
    EXPECT_EQ(square.faces.size(), 10u);
    EXPECT_EQ(square.edges.size(), 24u);
    EXPECT_TRUE(square.circles.empty() && square.walls.empty());
    std::vector<glm::dvec2> uneven; // ten sides of 45 and 27 degrees
    for (int i = 0; i < 5; ++i)
        for (const double turn : {72.0 * i, 72.0 * i + 45.0})
            uneven.emplace_back(20 * std::cos(full_turn * turn / 360),
                                20 * std::sin(full_turn * turn / 360));
    EXPECT_TRUE(features_of(prism_mesh(uneven, 0, 5)).circles.empty());
    std::vector<glm::dvec2> ellipse;
    for (int i = 0; i < 64; ++i)
        ellipse.emplace_back(20 * std::cos(full_turn * i / 64),
                             19.5 * std::sin(full_turn * i / 64));
    EXPECT_TRUE(features_of(prism_mesh(ellipse, 0, 50)).circles.empty());
}

TEST(MeshFeatures, KeepFacesThatMeetAtSmallAngles) {
    const std::vector<glm::dvec2> roof = {{-30, 0}, {30, 0},     {30, 10},
                                          {10, 13}, {-10, 13.5}, {-30, 10}};
    const MeshFeatures f = features_of(prism_mesh(roof, 0, 50, {0, 5}));
    EXPECT_EQ(f.faces.size(), 8u);
    EXPECT_EQ(f.edges.size(), 18u);
    EXPECT_EQ(f.corners.size(), 12u);
}

TEST(MeshFeatures, OfBadlyTriangulatedFacesAreWhole) {
    std::mt19937 rng(11);
    std::uniform_real_distribution<double> random(0.0, 1.0);
    for (int i = 0; i < 200; ++i) {
        // Splits triangles at random points inside them, which gives slivers, and at random points
        // of an edge in both of its triangles, which gives corners of 180 degrees.
        Mesh mesh = box_mesh({-40, -30, 0}, {40, 30, 15});
        for (int k = 0; k < 150; ++k) {
            const MeshSides sides = sides_of(mesh);
            const auto side = static_cast<uint32_t>(rng() % sides.mates.size());
            const uint32_t mate = sides.mates[side];
            const Vec3 a = mesh.vertices[start_of(mesh, side)];
            const Vec3 b = mesh.vertices[end_of(mesh, side)];
            const auto added = static_cast<uint32_t>(mesh.vertices.size());
            mesh.vertices.push_back(a + random(rng) * random(rng) * (b - a));
            for (const uint32_t s : {side, mate}) {
                const auto [p, q, r] = std::array{start_of(mesh, s), end_of(mesh, s),
                                                  end_of(mesh, MeshSides::next(s))};
                mesh.triangles[s / 3] = {p, added, r};
                mesh.triangles.push_back({added, q, r});
            }
        }
        mesh = in_single_precision(moved(mesh, random_pose(rng, 100.0)));
        const MeshFeatures f = features_of(mesh);
        expect_consistent(f, mesh);
        EXPECT_EQ(f.faces.size(), 6u) << i;
        EXPECT_EQ(f.edges.size(), 12u) << i;
        EXPECT_EQ(f.corners.size(), 8u) << i;
    }
}

/// Coordinates as OpenSCAD writes them.
Mesh with_six_digits(Mesh mesh) {
    for (Vec3& v : mesh.vertices)
        for (int k = 0; k < 3; ++k) v[k] = static_cast<float>(std::stod(fmt::format("{:g}", v[k])));
    return mesh;
}

TEST(MeshFeatures, AreFoundInFilesWithSixDigits) {
    std::mt19937 rng(14);
    for (const double reach : {20.0, 60.0, 100.0, 300.0})
        for (int i = 0; i < 30; ++i) {
            const Transform pose = random_pose(rng, reach);
            const MeshFeatures bored =
                features_of(with_six_digits(moved(bored_block(30.0, 30.0, 12.0, 40), pose)));
            EXPECT_EQ(bored.faces.size(), 6u) << reach;
            EXPECT_EQ(bored.edges.size(), 12u) << reach;
            EXPECT_EQ(bored.circles.size(), 2u) << reach;
            EXPECT_EQ(bored.walls.size(), 1u) << reach;
            const MeshFeatures filleted = features_of(with_six_digits(
                moved(prism_mesh(rounded_rectangle(40.0, 25.0, 6.0, 8), 0, 10), pose)));
            EXPECT_EQ(filleted.faces.size(), 6u) << reach;
            EXPECT_EQ(filleted.circles.size(), 8u) << reach;
            EXPECT_EQ(filleted.walls.size(), 4u) << reach;
        }
}

TEST(MeshFeatures, DoNotDependOnTheOrderOfTheTriangles) {
    std::mt19937 rng(12);
    const Mesh mesh = turned_mesh(stepped, 36);
    const MeshFeatures plain = features_of(mesh);
    for (int i = 0; i < 10; ++i) expect_same_numbers(plain, features_of(shuffled(mesh, rng)));
}

TEST(MeshFeatures, OfTheShippedMeshes) {
    const struct {
        const char* name;
        size_t faces, edges, corners, circles, walls;
    } cases[] = {{"blank.stl", 26, 48, 24, 0, 0},   {"vise-116.stl", 16, 42, 28, 0, 0},
                 {"clamp.stl", 11, 27, 18, 0, 0},   {"step-block.stl", 14, 36, 24, 0, 0},
                 {"chuck.stl", 3, 0, 0, 6, 3},      {"stud.stl", 5, 0, 0, 8, 4},
                 {"roughed.stl", 11, 24, 14, 2, 2}, {"vise6-moving-jaw.stl", 7, 15, 10, 0, 0}};
    for (const auto& c : cases) {
        const MeshFeatures f = features_of_asset(c.name);
        EXPECT_EQ(f.faces.size(), c.faces) << c.name;
        EXPECT_EQ(f.edges.size(), c.edges) << c.name;
        EXPECT_EQ(f.corners.size(), c.corners) << c.name;
        EXPECT_EQ(f.circles.size(), c.circles) << c.name;
        EXPECT_EQ(f.walls.size(), c.walls) << c.name;
    }
}

TEST(MeshFeatures, OfTheChuckHaveItsBore) {
    const MeshFeatures f = features_of_asset("chuck.stl");
    const auto bore = std::find_if(f.walls.begin(), f.walls.end(),
                                   [](const RoundWall& w) { return w.through(); });
    ASSERT_NE(bore, f.walls.end());
    // Its sides are within the material, so the bore is never too wide.
    EXPECT_NEAR(bore->radius_from, 20.0, 1e-5);
    EXPECT_NEAR(glm::distance(bore->from, bore->to), 66.0, 1e-5);
    EXPECT_NEAR(std::abs(bore->axis().x), 1.0, 1e-12);
    // Those of its outside enclose the circle.
    const double outside = f.circles[f.walls[0].rims[0]].inscribed_radius;
    EXPECT_NEAR(outside, 80.0, 1e-4);
}

TEST(MeshFeatures, OfDamagedMeshesDoNotFail) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(features_of(Mesh{}).faces.empty());
    Mesh box = box_mesh(Vec3(0.0), Vec3(10.0));
    box.vertices[3] = Vec3(nan);
    expect_consistent(features_of(box), box);
    box.vertices[3] = Vec3(infinity, 0.0, 1e300);
    expect_consistent(features_of(box), box);
    box.triangles[2] = {0, 1, 4711};
    box.triangles[3] = {5, 5, 6};
    expect_consistent(features_of(box), box);
    Mesh open = box_mesh(Vec3(0.0), Vec3(10.0));
    open.triangles.resize(10);
    expect_consistent(features_of(open), open);
    Mesh twice = box_mesh(Vec3(0.0), Vec3(10.0)); // every edge has four triangles
    twice.triangles.insert(twice.triangles.end(), twice.triangles.begin(), twice.triangles.end());
    expect_consistent(features_of(twice), twice);
    Mesh point; // all in one place
    point.vertices.assign(3, Vec3(1.0));
    point.triangles = {{0, 1, 2}, {2, 1, 0}};
    expect_consistent(features_of(point), point);
    Mesh flat = box_mesh(Vec3(0.0), Vec3(10.0, 10.0, 0.0));
    expect_consistent(features_of(flat), flat);
    Mesh huge = box_mesh(Vec3(-1e200), Vec3(1e200));
    expect_consistent(features_of(huge), huge);
}

TEST(MeshFeatures, OfRandomTrianglesEnd) {
    std::mt19937 rng(13);
    for (int i = 0; i < 300; ++i) {
        Mesh mesh;
        const uint32_t grid = 2 + rng() % 4, vertices = 4 + rng() % 20;
        for (uint32_t v = 0; v < vertices; ++v)
            mesh.vertices.emplace_back(rng() % grid, rng() % grid, rng() % grid);
        for (uint32_t t = rng() % 80; t > 0; --t)
            mesh.triangles.push_back({static_cast<uint32_t>(rng() % vertices),
                                      static_cast<uint32_t>(rng() % vertices),
                                      static_cast<uint32_t>(rng() % vertices)});
        expect_consistent(features_of(mesh), mesh);
    }
}

} // namespace
} // namespace core
