#include <random>

#include <gtest/gtest.h>

#include "render/camera.h"

namespace render {
namespace {

const Viewport wide{1280, 800}, narrow{300, 900};
const Aabb box{{-40, -90, -10}, {60, 20, 35}};

Camera random_camera(std::mt19937& random) {
    const auto fraction = [&] { return std::uniform_real_distribution<>(-1.0, 1.0)(random); };
    Camera camera;
    camera.target = {100 * fraction(), 100 * fraction(), 50 * fraction()};
    camera.distance = 250.0 + 200.0 * fraction();
    camera.yaw = 3.1 * fraction();
    camera.pitch = 1.5 * fraction();
    camera.projection = fraction() > 0.0 ? Projection::perspective : Projection::orthographic;
    return camera;
}

std::vector<Vec3> corners(const Aabb& of) {
    std::vector<Vec3> all;
    for (int c = 0; c < 8; ++c)
        all.emplace_back((c & 1) != 0 ? of.max.x : of.min.x, (c & 2) != 0 ? of.max.y : of.min.y,
                         (c & 4) != 0 ? of.max.z : of.min.z);
    return all;
}

TEST(Camera, FramesTheWholeBox) {
    std::mt19937 random(1);
    for (int i = 0; i < 200; ++i)
        for (const Viewport& viewport : {wide, narrow}) {
            const Camera camera = framing(random_camera(random), viewport, box, 0.05);
            double nearest = 1.0;
            for (const Vec3& corner : corners(box)) {
                const auto seen = project(camera, viewport, corner);
                ASSERT_TRUE(seen);
                const Vec2 fraction = seen->position / Vec2(viewport.width, viewport.height);
                EXPECT_GE(std::min(fraction.x, fraction.y), 0.05 - 1e-9);
                EXPECT_LE(std::max(fraction.x, fraction.y), 0.95 + 1e-9);
                nearest = std::min({nearest, fraction.x - 0.05, fraction.y - 0.05,
                                    0.95 - fraction.x, 0.95 - fraction.y});
            }
            EXPECT_LT(nearest, 1e-6); // and no farther away than need be
        }
}

TEST(Camera, FramesTheSameDirections) {
    Camera camera;
    camera.yaw = 0.3;
    const Camera framed = framing(camera, wide, box);
    EXPECT_EQ(framed.yaw, camera.yaw);
    EXPECT_EQ(framed.pitch, camera.pitch);
    EXPECT_EQ(framing(camera, wide, Aabb()), camera);
}

TEST(Camera, SeesAPointWhereItsRayGoes) {
    std::mt19937 random(2);
    std::uniform_real_distribution<> x(0, wide.width), y(0, wide.height), deep(100, 700);
    for (int i = 0; i < 500; ++i) {
        const Camera camera = random_camera(random);
        const Vec2 position(x(random), y(random));
        const Ray ray = ray_through(camera, wide, position);
        EXPECT_NEAR(glm::length(ray.direction), 1.0, 1e-12);
        const auto seen = project(camera, wide, ray.origin + deep(random) * ray.direction);
        ASSERT_TRUE(seen);
        EXPECT_LT(glm::distance(seen->position, position), 1e-6);
    }
}

TEST(Camera, ProjectsAsOpenGlDoes) {
    std::mt19937 random(3);
    for (int i = 0; i < 200; ++i) {
        const Camera camera = framing(random_camera(random), wide, box);
        const Mat4 clip = clip_from_view(camera, wide, box) * view_from_scene(camera);
        for (const Vec3& corner : corners(box)) {
            const glm::dvec4 at = clip * glm::dvec4(corner, 1.0);
            const Vec3 device = Vec3(at) / at.w;
            EXPECT_LE(std::abs(device.z), 1.0); // between the near and the far plane
            const auto seen = project(camera, wide, corner);
            EXPECT_NEAR(seen->position.x, (0.5 + 0.5 * device.x) * wide.width, 1e-6);
            EXPECT_NEAR(seen->position.y, (0.5 - 0.5 * device.y) * wide.height, 1e-6);
        }
    }
}

TEST(Camera, ZoomsToTheCursor) {
    std::mt19937 random(4);
    std::uniform_real_distribution<> x(0, wide.width), y(0, wide.height), by(0.3, 3.0);
    for (int i = 0; i < 300; ++i) {
        const Camera camera = random_camera(random);
        const Vec2 cursor(x(random), y(random));
        const Ray ray = ray_through(camera, wide, cursor);
        const Vec3 at = point_under(camera, wide, cursor, camera.target + Vec3(3, 4, 5));
        EXPECT_LT(glm::length(glm::cross(at - ray.origin, ray.direction)), 1e-6);
        for (const auto& fixed : {std::optional(at), std::optional<Vec3>()}) {
            const Camera nearer = zoomed(camera, wide, cursor, by(random), fixed);
            const Vec3 point = fixed.value_or(point_under(camera, wide, cursor, camera.target));
            EXPECT_LT(glm::distance(project(nearer, wide, point)->position, cursor), 1e-6);
            EXPECT_NE(nearer.distance, camera.distance);
        }
    }
}

TEST(Camera, PanMovesWhatIsUnderTheCursorWithIt) {
    std::mt19937 random(5);
    std::uniform_real_distribution<> x(0, wide.width), y(0, wide.height);
    for (int i = 0; i < 300; ++i) {
        const Camera camera = random_camera(random);
        const Vec2 from(x(random), y(random)), to(x(random), y(random));
        const Vec3 level = camera.target + Vec3(5, -7, 3);
        const Vec3 held = point_under(camera, wide, from, level);
        const Camera moved = panned(camera, wide, from, to, level);
        EXPECT_LT(glm::distance(project(moved, wide, held)->position, to), 1e-6);
        EXPECT_EQ(moved.distance, camera.distance);
    }
}

TEST(Camera, OrbitKeepsItsTarget) {
    std::mt19937 random(6);
    for (int i = 0; i < 300; ++i) {
        const Camera camera = random_camera(random);
        const Camera turned = orbited(camera, wide, {120, -35});
        EXPECT_NE(turned.yaw, camera.yaw);
        EXPECT_EQ(turned.target, camera.target);
    }
}

TEST(Camera, NeverTurnsUpsideDown) {
    Camera camera;
    for (int i = 0; i < 50; ++i) {
        camera = orbited(camera, wide, {3, 90});
        EXPECT_GE(axes(camera).up.z, -1e-12);
    }
    EXPECT_NEAR(axes(camera).backward.z, 1.0, 1e-12);
}

TEST(Camera, StandardViewsShowTheirSides) {
    const auto seen = [](StandardView view) { return axes(seen_from(Camera(), view)); };
    const auto is = [](const Vec3& a, const Vec3& b) { return glm::distance(a, b) < 1e-9; };
    EXPECT_TRUE(is(seen(StandardView::top).backward, {0, 0, 1}));
    EXPECT_TRUE(is(seen(StandardView::top).right, {1, 0, 0}));
    EXPECT_TRUE(is(seen(StandardView::top).up, {0, 1, 0}));
    EXPECT_TRUE(is(seen(StandardView::front).backward, {0, -1, 0}));
    EXPECT_TRUE(is(seen(StandardView::front).right, {1, 0, 0}));
    EXPECT_TRUE(is(seen(StandardView::right).backward, {1, 0, 0}));
    EXPECT_TRUE(is(seen(StandardView::back).backward, {0, 1, 0}));
    EXPECT_TRUE(is(seen(StandardView::left).backward, {-1, 0, 0}));
    EXPECT_TRUE(is(seen(StandardView::bottom).backward, {0, 0, -1}));
    EXPECT_TRUE(is(seen(StandardView::bottom).right, {1, 0, 0}));
    const Vec3 iso = seen(StandardView::iso).backward;
    EXPECT_TRUE(is(iso, glm::normalize(Vec3(1, -1, 1))));
}

TEST(Camera, KeepsItsScaleWithoutPerspective) {
    Camera camera;
    const double with = pixel_size(camera, wide, camera.target);
    camera.projection = Projection::orthographic;
    EXPECT_NEAR(pixel_size(camera, wide, camera.target), with, 1e-12);
    EXPECT_NEAR(pixel_size(camera, wide, camera.target + Vec3(50, 50, 50)), with, 1e-12);
}

TEST(Camera, LeavesOutOnlyBoxesOfWhichNoPointIsSeen) {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> place(-300.0, 300.0), size(1.0, 60.0), turn(-3.0, 3.0);
    int left_out = 0;
    for (int i = 0; i < 2000; ++i) {
        Camera camera;
        camera.yaw = turn(random);
        camera.pitch = 0.5 * turn(random);
        camera.projection = i % 2 == 0 ? Projection::perspective : Projection::orthographic;
        camera.distance = 150.0;
        const Vec3 low(place(random), place(random), place(random));
        const Aabb some{low, low + Vec3(size(random), size(random), size(random))};
        const Mat4 clip =
            clip_from_view(camera, wide, {Vec3(-300), Vec3(360)}) * view_from_scene(camera);
        const bool kept = may_be_seen(some, clip);
        left_out += kept ? 0 : 1;
        for (int k = 0; k < 125; ++k) {
            const Vec3 share(k % 5 / 4.0, k / 5 % 5 / 4.0, k / 25 / 4.0);
            const Vec3 point = some.min + share * some.size();
            const glm::dvec4 p = clip * glm::dvec4(point, 1.0);
            const bool seen =
                p.w > 0.0 && std::abs(p.x) <= p.w && std::abs(p.y) <= p.w && std::abs(p.z) <= p.w;
            EXPECT_TRUE(kept || !seen);
        }
    }
    EXPECT_GT(left_out, 500);
}

TEST(Camera, NoticesThatNothingIsInSight) {
    const Viewport viewport{800, 600};
    Camera camera = framing(Camera(), viewport, {{-10, -10, -10}, {10, 10, 10}});
    EXPECT_TRUE(is_in_sight(camera, viewport, {{-10, -10, -10}, {10, 10, 10}}));
    EXPECT_TRUE(is_in_sight(camera, viewport, {{-1e4, -1e4, -1e4}, {1e4, 1e4, 1e4}})); // around it
    EXPECT_FALSE(is_in_sight(camera, viewport, {{500, 500, 0}, {510, 510, 10}}));
    EXPECT_FALSE(is_in_sight(camera, viewport, {{0, 0, 0}, {0.1, 0.1, 0.1}})); // a dot
    EXPECT_FALSE(is_in_sight(camera, viewport, {}));
    const Vec3 behind = eye(camera) + 50.0 * axes(camera).backward;
    EXPECT_FALSE(is_in_sight(camera, viewport, {behind - Vec3(5.0), behind + Vec3(5.0)}));
    std::mt19937 random(3);
    std::uniform_real_distribution<double> place(-300.0, 300.0), size(20.0, 200.0);
    for (int i = 0; i < 500; ++i) { // whatever is framed is in sight
        const Vec3 low(place(random), place(random), place(random));
        const Aabb box{low, low + Vec3(size(random), size(random), size(random))};
        EXPECT_TRUE(is_in_sight(framing(camera, viewport, box), viewport, box));
    }
}

} // namespace
} // namespace render
