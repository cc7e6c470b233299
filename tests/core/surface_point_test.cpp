#include <random>

#include <gtest/gtest.h>

#include "core/dbm/contour.h"
#include "tests/support/meshes.h"
#include "tests/support/stock_oracle.h"

namespace core {
namespace {

using test_support::CutBox;
using test_support::outside_tilted_sweep;

double outside_cut(const CutBox::Cut& cut, const Vec3& p) {
    return outside_tilted_sweep(cut.flutes, cut.orientation, cut.from, cut.to, p);
}

struct Seen {
    int raw = 0, smooth = 0, edges = 0;
};

/// The point must be on the surface of the named cut, with the normal towards the inside of the
/// cut.
void expect_true_surface(const CutBox& world, const SurfacePoint& s, Seen& seen) {
    ASSERT_NEAR(glm::length(s.normal), 1.0, 1e-9);
    if (!s.block) {
        ++seen.raw;
        EXPECT_GT(distance_squared(s.point + 1e-4 * s.normal, world.box), 0.0);
        return;
    }
    const CutBox::Cut& cut = world.cuts[*s.block];
    EXPECT_NEAR(outside_cut(cut, s.point), 0.0, 1e-6);
    Vec3 slope(0.0);
    for (int k = 0; k < 3; ++k) {
        Vec3 step(0.0);
        step[k] = 1e-5;
        slope[k] = outside_cut(cut, s.point + step) - outside_cut(cut, s.point - step);
    }
    // Leaving the stock is entering the cut. On an edge the slope is between those of the faces.
    const bool smooth = glm::dot(glm::normalize(slope), s.normal) < -0.9999;
    ++(smooth ? seen.smooth : seen.edges);
}

/// The surface at all ends of one family.
std::vector<SurfacePoint> surface_points(const CutModel& model, int axis) {
    const ScanLines& family = model.lines.families[static_cast<size_t>(axis)];
    std::vector<SurfacePoint> points;
    for (int v = 0; v < family.v_count(); ++v)
        for (int u = 0; u < family.u_count(); ++u)
            for (size_t i = 0; i < family.line(u, v).size(); ++i)
                for (const bool upper : {false, true})
                    points.push_back(surface_point(model, {axis, u, v, i, upper}));
    return points;
}

void expect_true_surfaces(bool tilted, unsigned seed) {
    std::mt19937 rng(seed);
    Seen seen;
    for (int i = 0; i < 12; ++i) {
        const size_t count = 1 + static_cast<size_t>(i) % 6;
        const CutBox world = tilted ? test_support::random_tilted_cut_box(rng, count, 0.0)
                                    : test_support::random_cut_box(rng, count, 0.0);
        const CutModel model = world.model(0.7);
        for (int axis = 0; axis < 3; ++axis)
            for (const SurfacePoint& s : surface_points(model, axis))
                expect_true_surface(world, s, seen);
        ASSERT_FALSE(::testing::Test::HasFailure()) << i;
    }
    EXPECT_GT(seen.raw, 3000);
    EXPECT_GT(seen.smooth, 2000);
    EXPECT_LT(seen.edges, seen.smooth / 20);
}

TEST(SurfacePoint, KnowsTheCutAndItsNormal) { expect_true_surfaces(false, 901); }

TEST(SurfacePoint, KnowsThoseOfTiltedTools) { expect_true_surfaces(true, 902); }

TEST(SurfacePoint, NamesTheLastMoveThatCutThere) {
    CutModel model = make_cut_model({SolidBox{{{0, 0, 0}, {20, 20, 20}}}, 0.0}, 1.0).value();
    const auto cutter = std::make_shared<const Cutter>(make_cutter({{{0, 3, 40, 3, 0}}}, 0.0));
    cut(model, {cutter, {-5, 10, 15}, {25, 10, 15}, Mat3(1.0), 7});
    cut(model, {cutter, {-5, 10, 12}, {10, 10, 12}, Mat3(1.0), 8});
    const auto floor_at = [&](int u) { return surface_point(model, {2, u, 10, 0, true}); };
    EXPECT_EQ(floor_at(4).block, 8u);
    EXPECT_EQ(floor_at(4).point.z, 12.0);
    EXPECT_EQ(floor_at(16).block, 7u);
    EXPECT_EQ(floor_at(16).normal, Vec3(0, 0, 1));
    EXPECT_EQ(surface_point(model, {2, 4, 10, 0, false}).block, std::nullopt);
}

TEST(SurfacePoint, KnowsTheNormalsOfRawStock) {
    const auto all_along = [](const Solid& solid, const auto& normal) {
        const CutModel model = make_cut_model(solid, 0.5).value();
        size_t points = 0;
        for (int axis = 0; axis < 3; ++axis)
            for (const SurfacePoint& s : surface_points(model, axis)) {
                ++points;
                EXPECT_GT(glm::dot(s.normal, normal(s.point)), 0.999);
            }
        EXPECT_GT(points, 200u);
    };
    all_along({SolidCylinder{{1, 2, 3}, 4.0, 9.0, 0}, 0.0}, [](const Vec3& p) {
        if (std::abs(p.x - 1.0) < 1e-9) return Vec3(-1, 0, 0);
        if (std::abs(p.x - 10.0) < 1e-9) return Vec3(1, 0, 0);
        return glm::normalize(Vec3(0.0, p.y - 2.0, p.z - 3.0));
    });
    const Mesh box = test_support::box_mesh({0, 0, 0}, {5, 6, 7});
    all_along({solid_mesh(box), 0.0}, [](const Vec3& p) {
        for (int k = 0; k < 3; ++k) {
            Vec3 n(0.0);
            n[k] = 1.0;
            if (std::abs(p[k]) < 1e-9) return -n;
            if (std::abs(p[k] - (5.0 + k)) < 1e-9) return n;
        }
        return Vec3(0.0);
    });
}

} // namespace
} // namespace core
