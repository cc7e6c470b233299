#include <random>

#include <gtest/gtest.h>

#include "render/body_mesh.h"
#include "render/picking.h"
#include "tests/render/sample_scene.h"

namespace render {
namespace {

const Viewport window{900, 600};

/// A scene of the stock and fixtures, made once.
const Scene& sample() {
    static const Scene scene = [] {
        Scene made = sample_scene(0.8);
        std::erase_if(made.bodies, [](const Body& body) { return body.role == BodyRole::holder; });
        return made;
    }();
    return scene;
}

Camera above() {
    Camera camera = seen_from(Camera(), StandardView::top);
    camera.target = {0, 0, 0};
    return camera;
}

Vec2 seen(const Camera& camera, const Vec3& point) {
    return project(camera, window, point)->position;
}

TEST(PickStock, NamesTheBlockThatCut) {
    const Camera camera = above();
    const auto hole = pick_stock(sample(), ray_through(camera, window, seen(camera, {28, 2, -14})));
    ASSERT_TRUE(hole);
    EXPECT_NEAR(hole->at.point.z, -14.0, 1e-3);
    EXPECT_GT(hole->at.normal.z, 0.999);
    ASSERT_TRUE(hole->block);
    std::vector<PathPoint> path;
    sample_moves(path);
    const auto bottom = std::find_if(path.begin(), path.end(), [](const PathPoint& p) {
        return p.position == glm::vec3(28, 2, -14);
    });
    EXPECT_EQ(*hole->block, bottom->block);
    const auto raw = pick_stock(sample(), ray_through(camera, window, seen(camera, {40, 25, 0})));
    ASSERT_TRUE(raw);
    EXPECT_FALSE(raw->block);
    EXPECT_NEAR(raw->at.point.z, 0.0, 1e-4);
}

TEST(PickStock, AgreesWithLookingAtEveryTriangle) {
    std::mt19937 random(9);
    std::uniform_real_distribution<> x(0, window.width), y(0, window.height), turn(-3, 3);
    size_t hits = 0, misses = 0;
    for (int i = 0; i < 150; ++i) {
        Camera camera;
        camera.yaw = turn(random);
        camera.pitch = 0.5 * turn(random);
        camera.target = {0, 0, -15};
        camera.distance = 200;
        const Ray ray = ray_through(camera, window, {x(random), y(random)});
        double nearest = core::infinity;
        for (const auto& brick : sample().stock)
            if (const auto hit = pick_mesh(brick->mesh, ray))
                nearest = std::min(nearest, hit->distance);
        const auto hit = pick_stock(sample(), ray);
        EXPECT_EQ(hit.has_value(), nearest < core::infinity);
        if (hit) {
            EXPECT_EQ(hit->at.distance, nearest);
        }
        ++(hit ? hits : misses);
    }
    EXPECT_GT(hits, 30u);
    EXPECT_GT(misses, 30u);
}

TEST(PickMesh, MeetsABallWhereItIs) {
    const TriangleMesh ball = ball_mesh(10.0, 48);
    std::mt19937 random(10);
    std::normal_distribution<> any;
    for (int i = 0; i < 300; ++i) {
        const Vec3 from = 40.0 * glm::normalize(Vec3(any(random), any(random), any(random)));
        const Vec3 aim = 0.6 * Vec3(any(random), any(random), any(random));
        const auto hit = pick_mesh(ball, {from, glm::normalize(aim - from)});
        ASSERT_TRUE(hit);
        EXPECT_NEAR(glm::length(hit->point), 10.0, 0.05);
        EXPECT_GT(glm::dot(hit->normal, glm::normalize(hit->point)), 0.99);
        EXPECT_GT(glm::dot(hit->normal, from - hit->point), 0.0); // its front
        EXPECT_FALSE(pick_mesh(ball, {from, glm::normalize(from - aim)}));
        EXPECT_FALSE(pick_mesh(ball, {Vec3(0.0), glm::normalize(from)})); // no backs
    }
}

TEST(PickMesh, AgreesWithLookingAtEveryTriangle) {
    TriangleMesh mesh = mesh_of(core::RevolvedProfile{{{0, 30, 20, 10, 0}, {20, 25, 40, 25, 0}}});
    TriangleMesh plain = mesh;
    plain.boxes.clear();
    ASSERT_GT(mesh.boxes.size(), 5u);
    std::mt19937 random(12);
    std::normal_distribution<> any;
    size_t hits = 0;
    for (int i = 0; i < 500; ++i) {
        const Vec3 from = 90.0 * glm::normalize(Vec3(any(random), any(random), any(random)));
        const Vec3 aim = 20.0 * Vec3(any(random), any(random), any(random));
        const Ray ray{from, glm::normalize(aim - from)};
        const auto fast = pick_mesh(mesh, ray), slow = pick_mesh(plain, ray);
        ASSERT_EQ(fast.has_value(), slow.has_value());
        if (fast) {
            EXPECT_EQ(fast->distance, slow->distance);
        }
        hits += fast ? 1 : 0;
    }
    EXPECT_GT(hits, 150u);
    EXPECT_LT(hits, 450u);
}

TEST(PickBody, NamesTheNearestAndLooksThroughGlass) {
    Scene scene = sample();
    const Camera camera = above();
    const Ray ray = ray_through(camera, window, seen(camera, {32, -20, 9}));
    const auto clamp = pick_body(scene, ray);
    ASSERT_TRUE(clamp);
    EXPECT_EQ(scene.bodies[clamp->body].name, "clamp-1");
    EXPECT_NEAR(clamp->at.point.z, 9.0, 1e-6);
    scene.bodies[clamp->body].alpha = 0.5;
    const auto through = pick_body(scene, ray);
    EXPECT_TRUE(!through || through->body != clamp->body);
    EXPECT_EQ(pick_body(scene, ray, false)->body, clamp->body);
    scene.bodies[clamp->body].visible = false;
    EXPECT_TRUE(pick_stock(scene, ray));
}

TEST(PickBody, FindsBodiesThatAreTurnedAndMoved) {
    Scene scene;
    Body body{.name = "bar",
              .mesh = std::make_shared<const TriangleMesh>(
                  mesh_of(core::Primitive(core::Box{{100, 10, 10}}))),
              .stock_from_body = {core::rotation_xyz_deg({0, 0, 90}), {200, 0, 0}}};
    scene.bodies = {body};
    const auto hit = pick_body(scene, {{200, 45, 50}, {0, 0, -1}});
    ASSERT_TRUE(hit);
    EXPECT_LT(glm::distance(hit->at.point, Vec3(200, 45, 5)), 1e-6);
    EXPECT_LT(glm::distance(hit->at.normal, Vec3(0, 0, 1)), 1e-6);
    EXPECT_FALSE(pick_body(scene, {{245, 0, 50}, {0, 0, -1}}));
}

TEST(Pick, DoesNotSeeWhatASectionTookAway) {
    Scene scene = sample();
    scene.section = SectionPlane{{0, 0, 1}, -20.0};
    const Camera camera = above();
    scene.stock_visible = false;
    const Pick found = pick(scene, camera, window, seen(camera, {40, 25, -30}));
    EXPECT_FALSE(found.stock);
    ASSERT_TRUE(found.body);
    EXPECT_LT(found.surface()->point.z, -30.0) << scene.bodies[found.body->body].name;
}

/// What lies behind the face of a section cannot be seen, so it is not what was pointed at.
TEST(Pick, MeetsTheFaceThatASectionMakes) {
    Scene scene = sample();
    scene.section = SectionPlane{{0, 0, 1}, -20.0};
    const Camera camera = above();
    const Pick found = pick(scene, camera, window, seen(camera, {40, 25, -20}));
    ASSERT_TRUE(found.stock);
    EXPECT_FALSE(found.body);
    EXPECT_FALSE(found.stock->block) << "no block has cut within the material";
    EXPECT_NEAR(found.stock->at.point.z, -20.0, 1e-9);
    scene.section->normal = {0, 0, -1}; // the lower part is cut away, and the eye is above
    scene.section->offset = 20.0;
    const Pick top = pick(scene, camera, window, seen(camera, {40, 25, 0}));
    ASSERT_TRUE(top.stock);
    EXPECT_NEAR(top.stock->at.point.z, 0.0, 1e-4);
}

TEST(PickBody, MeetsTheFaceThatASectionMakes) {
    Scene scene;
    scene.bodies = {{.name = "box",
                     .mesh = std::make_shared<const TriangleMesh>(
                         mesh_of(core::Primitive(core::Box{{10, 10, 10}}))),
                     .stock_from_body = {core::rotation_xyz_deg({0, 0, 90}), {100, 0, 50}}}};
    scene.section = SectionPlane{{0, 0, 1}, 52.0};
    const auto hit = pick_body(scene, {{101, 1, 90}, {0, 0, -1}});
    ASSERT_TRUE(hit);
    EXPECT_LT(glm::distance(hit->at.point, Vec3(101, 1, 52)), 1e-9);
    EXPECT_LT(glm::distance(hit->at.normal, Vec3(0, 0, 1)), 1e-9);
    EXPECT_FALSE(pick_body(scene, {{120, 1, 90}, {0, 0, -1}}));
}

/// Every piece, one after the other.
double nearest_piece(const ToolPath& path, const Camera& camera, const Vec2& cursor) {
    double best = core::infinity;
    for (size_t i = 1; i < path.points.size(); ++i) {
        if (path.points[i].begins) continue;
        const Vec2 a = seen(camera, Vec3(path.points[i - 1].position));
        const Vec2 b = seen(camera, Vec3(path.points[i].position));
        const double size = glm::dot(b - a, b - a);
        const double t = size > 0 ? std::clamp(glm::dot(cursor - a, b - a) / size, 0.0, 1.0) : 0.0;
        best = std::min(best, glm::distance(cursor, a + t * (b - a)));
    }
    return best;
}

TEST(PickPath, AgreesWithLookingAtEveryPiece) {
    std::mt19937 random(11);
    std::uniform_real_distribution<> x(250, 650), y(150, 450);
    const ToolPath& path = *sample().path;
    Camera camera;
    camera.distance = 300;
    size_t found = 0, none = 0;
    for (int i = 0; i < 400; ++i) {
        const Vec2 cursor(x(random), y(random));
        const auto hit = pick_path(path, camera, window, cursor, 6.0);
        const double expected = nearest_piece(path, camera, cursor);
        EXPECT_EQ(hit.has_value(), expected <= 6.0);
        if (hit) {
            EXPECT_LE(hit->pixels, expected + 1.0 + 1e-9);
        }
        ++(hit ? found : none);
    }
    EXPECT_GT(found, 60u);
    EXPECT_GT(none, 60u);
}

TEST(PickPath, NamesTheBlockOfThePiece) {
    const ToolPath& path = *sample().path;
    Camera camera;
    camera.distance = 250;
    const Vec3 middle = 0.5 * (Vec3(path.points[3].position) + Vec3(path.points[4].position));
    const auto hit = pick_path(path, camera, window, seen(camera, middle));
    ASSERT_TRUE(hit);
    EXPECT_LT(hit->pixels, 1.0);
    EXPECT_EQ(hit->block, path.points[hit->point].block);
}

TEST(Pick, DoesNotSeeAPathBehindASurface) {
    const Camera camera = seen_from(above(), StandardView::bottom);
    const Pick found = pick(sample(), camera, window, seen(camera, {-10, -6, -3}));
    EXPECT_TRUE(found.surface());
    EXPECT_FALSE(found.path);
    const Pick from_above = pick(sample(), above(), window, seen(above(), {0, -6, -9}));
    EXPECT_TRUE(from_above.path);
}

} // namespace
} // namespace render
