#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "render/body_mesh.h"
#include "render/ground.h"
#include "tests/render/sample_scene.h"

namespace render {
namespace {

TEST(Grid, HasStepsOfOneTwoAndFive) {
    const auto expect = [](double least, bool inch, double fine, double coarse) {
        const GridStep step = step_of_at_least(least, inch);
        EXPECT_NEAR(step.fine, fine, 1e-12 * fine) << least;
        EXPECT_NEAR(step.coarse, coarse, 1e-12 * coarse) << least;
    };
    expect(0.96, false, 1.0, 10.0);
    expect(1.0, false, 1.0, 10.0);
    expect(1.1, false, 2.0, 10.0);
    expect(3.2, false, 5.0, 50.0);
    expect(9.6, false, 10.0, 100.0);
    expect(1.6, true, 2.54, 25.4);
    expect(3.2, true, 5.08, 25.4);
}

TEST(Grid, LeavesRoomBetweenLinesAtEveryZoom) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> power(-3.0, 6.0);
    for (int i = 0; i < 2000; ++i) {
        const double least = std::pow(10.0, power(random));
        for (const bool inch : {false, true}) {
            const GridStep step = step_of_at_least(least, inch);
            EXPECT_GE(step.fine, least);
            if (step.fine > 0.01) {
                EXPECT_LE(step.fine / least, 2.5 * (1.0 + 1e-12)) << least;
            }
            const double ratio = step.coarse / step.fine;
            EXPECT_NEAR(ratio, std::round(ratio), 1e-9);
        }
    }
    for (const double least : {0.0, -1.0, 1e300, std::nan("")}) {
        const GridStep step = step_of_at_least(least, false);
        EXPECT_TRUE(std::isfinite(step.fine) && step.fine > 0.0);
    }
}

TEST(Grid, LinesStayInPlaceWhenTheViewMoves) {
    const GridView view{{2.0, 10.0}, {0.7, -31.3}, 120.0};
    const std::vector<GridPoint> points = grid_lines(view);
    size_t strong = 0;
    for (size_t i = 0; i < points.size(); i += 2) {
        const int axis = points[i].position.x == points[i + 1].position.x ? 0 : 1;
        const double at = points[i].position[axis];
        const bool is_strong = std::fmod(at, 10.0) == 0.0;
        EXPECT_EQ(std::fmod(at, 2.0), 0.0);
        EXPECT_EQ(points[i].strength == 1.0F, is_strong);
        EXPECT_LE(std::abs(at - view.middle[axis]), is_strong ? view.reach : view.fine_reach());
        strong += is_strong ? 1 : 0;
    }
    EXPECT_EQ(points.size(), 2u * (2u * 60u + 2u * 12u)); // half the reach has 60 lines each way
    EXPECT_EQ(strong, 2u * 24u);
}

TEST(Grid, IsBoundedByWhatThePictureShows) {
    const Ground ground{core::translation({5, 6, -20})};
    Camera camera;
    camera.target = {100, 50, 0};
    const Viewport size{800, 600};
    const GridView view = grid_view(ground, camera, size);
    EXPECT_NEAR(view.middle.x, 95.0, 1e-9);
    EXPECT_NEAR(view.middle.y, 44.0, 1e-9);
    const core::Aabb box = ground_bounds(ground, camera, size);
    EXPECT_NEAR(box.min.z, -20.0, 1e-9);
    EXPECT_NEAR(box.max.x, 100.0 + view.reach, 1e-9);
}

Body box_at(const Vec3& low, const Vec3& high, BodyRole role = BodyRole::fixture) {
    Body body;
    body.role = role;
    body.mesh = std::make_shared<const TriangleMesh>(
        mesh_of(core::ExactBody(core::convex(core::Aabb{low, high}))));
    return body;
}

Scene on_ground(std::vector<Body> bodies) {
    Scene scene;
    scene.bodies = std::move(bodies);
    scene.ground = Ground{};
    return scene;
}

int shadow_at(const ShadowMask& mask, const Vec2& place) {
    const Vec2 at = (place - mask.origin) / mask.cell;
    const int column = static_cast<int>(at.x), row = static_cast<int>(at.y);
    if (column < 0 || row < 0 || column >= mask.columns || row >= mask.rows) return 0;
    return mask.values[static_cast<size_t>(row * mask.columns + column)];
}

TEST(Shadow, IsDarkBelowAndFadesBesideTheWork) {
    const ShadowMask mask = shadow_mask(on_ground({box_at({-20, -10, 0}, {20, 10, 30})}));
    EXPECT_GE(shadow_at(mask, {0, 0}), 250);
    const int edge = shadow_at(mask, {20, 0}), beside = shadow_at(mask, {22, 0});
    EXPECT_NEAR(edge, 128, 30);
    EXPECT_LT(beside, edge);
    EXPECT_GT(beside, 0);
    for (int i = 0; i < mask.columns; ++i) // nothing at the border, where the mask ends
        EXPECT_EQ(mask.values[static_cast<size_t>(i)], 0);
}

TEST(Shadow, IsLighterBelowWhatIsHigher) {
    const auto below = [](double height) {
        return shadow_at(
            shadow_mask(on_ground({box_at({-20, -20, height}, {20, 20, height + 10})})), {0, 0});
    };
    EXPECT_GT(below(0.0), below(5.0) + 20);
    EXPECT_GT(below(5.0), below(15.0) + 20);
    EXPECT_EQ(below(1000.0), 0);
}

TEST(Shadow, IsOfTheWorkNotOfToolAndTable) {
    EXPECT_TRUE(shadow_mask(on_ground({})).empty());
    EXPECT_TRUE(shadow_mask(on_ground({box_at({0, 0, 0}, {9, 9, 9}, BodyRole::machine),
                                       box_at({0, 0, 0}, {9, 9, 9}, BodyRole::holder)}))
                    .empty());
    Scene hidden = on_ground({box_at({0, 0, 0}, {9, 9, 9})});
    hidden.bodies[0].visible = false;
    EXPECT_TRUE(shadow_mask(hidden).empty());
}

TEST(Shadow, OfTrianglesIsThatOfTheirBox) {
    // A box of triangles against the same box, turned about Z together with the ground.
    Scene turned = on_ground({box_at({-20, -10, 4}, {20, 10, 30})});
    const core::Transform turn{core::rotation_xyz_deg({0, 0, 90}), {3, 4, 5}};
    turned.bodies[0].stock_from_body = turn;
    turned.ground->scene_from_ground = turn;
    EXPECT_EQ(shadow_mask(turned).values,
              shadow_mask(on_ground({box_at({-20, -10, 4}, {20, 10, 30})})).values);
}

TEST(Shadow, DoesNotDependOnTheOrderOfBodies) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> place(-50.0, 50.0), height(0.0, 40.0);
    for (int round = 0; round < 20; ++round) {
        std::vector<Body> bodies;
        for (int i = 0; i < 6; ++i) {
            const Vec3 low(place(random), place(random), height(random));
            bodies.push_back(box_at(low, low + Vec3(8, 12, 5)));
        }
        const ShadowMask whole = shadow_mask(on_ground(bodies));
        std::vector<Body> backwards(bodies.rbegin(), bodies.rend());
        EXPECT_EQ(shadow_mask(on_ground(backwards)).values, whole.values);
        for (const Body& body : bodies) {
            const Vec2 middle(body.mesh->bounds.center());
            const double least = body.mesh->bounds.min.z;
            const double left = std::max(1.0 - least / (0.6 * 100.0), 0.0);
            if (left > 0.6) {
                EXPECT_GT(shadow_at(whole, middle), 12);
            }
        }
    }
}

TEST(Shadow, KeyTellsWhetherItMustBeMadeAgain) {
    Scene scene = on_ground({box_at({0, 0, 0}, {9, 9, 9})});
    const ShadowKey before = shadow_key(scene);
    EXPECT_EQ(shadow_key(scene), before);
    scene.bodies.push_back(box_at({0, 0, 20}, {9, 9, 29}, BodyRole::flutes));
    EXPECT_EQ(shadow_key(scene), before);
    scene.bodies[0].stock_from_body = core::translation({1, 0, 0});
    EXPECT_NE(shadow_key(scene), before);
}

TEST(Shadow, SurvivesBodiesWithoutAPlace) {
    Scene scene = on_ground({box_at({0, 0, 0}, {9, 9, 9})});
    scene.bodies[0].stock_from_body = core::translation({std::nan(""), 0, 0});
    EXPECT_TRUE(shadow_mask(scene).empty());
}

} // namespace
} // namespace render
