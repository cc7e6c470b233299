#include <algorithm>
#include <filesystem>
#include <random>

#include <gtest/gtest.h>

#include "core/distance/first_contact.h"
#include "core/geom/mesh_file.h"
#include "tests/support/feature_bodies.h"
#include "tests/support/meshes.h"

namespace core {
namespace {

using test_support::ball_mesh;
using test_support::bored_block;
using test_support::box_mesh;
using test_support::random_pose;
using test_support::torus_mesh;

const Vec3 down(0, 0, -1);

ExactBody mesh_box(const Vec3& min, const Vec3& max) { return solid_mesh(box_mesh(min, max)); }

ExactBody asset(const std::string& name) {
    auto file = read_mesh(std::filesystem::path(FEELER_SOURCE_DIR) / "assets/meshes" / name);
    EXPECT_TRUE(file.has_value()) << name;
    return solid_mesh(file ? file->mesh : Mesh{});
}

std::optional<double> travel(const ExactBody& a, const Transform& pose, const Vec3& direction,
                             const ExactBody& b, const Transform& b_pose = {},
                             const ContactGoal& goal = {}) {
    const PlacedBody support{&b, b_pose};
    const auto found = first_contact(a, pose, direction, {&support, 1}, {}, goal);
    return found ? std::optional(found->travel) : std::nullopt;
}

TEST(FirstContact, OfBoxesIsExact) {
    const ExactBody table = convex(Aabb{{-100, -100, -20}, {100, 100, 0}});
    for (const ExactBody& body :
         {ExactBody(convex(Aabb{{-5, -5, -5}, {5, 5, 5}})), mesh_box(Vec3(-5), Vec3(5))}) {
        EXPECT_EQ(travel(body, translation({0, 0, 40}), down, table), 35.0);
        EXPECT_EQ(travel(body, translation({104, 0, 40}), down, table), 35.0);
        EXPECT_FALSE(travel(body, translation({105, 0, 40}), down, table)); // edge above edge
        EXPECT_FALSE(travel(body, translation({0, 0, 40}), -down, table));
        EXPECT_FALSE(travel(body, translation({0, 0, 40}), down, table, {}, {.limit = 34.9}));
        EXPECT_TRUE(travel(body, translation({0, 0, 40}), down, table, {}, {.limit = 35.0}));
        const Vec3 oblique = glm::normalize(Vec3(3, 0, -4));
        EXPECT_NEAR(travel(body, translation({0, 0, 40}), oblique, table).value(), 43.75, 1e-9);
    }
}

TEST(FirstContact, LetsBodiesSlideAndLeave) {
    const ExactBody table = convex(Aabb{{-100, -100, -20}, {100, 100, 0}});
    const ExactBody wall = convex(Aabb{{50, -100, 0}, {60, 100, 80}});
    const ExactBody cylinder = convex(ProfileElement{0, 5, 10, 5, 0});
    for (const ExactBody& body : {ExactBody(convex(Aabb{{-5, -5, 0}, {5, 5, 10}})),
                                  mesh_box({-5, -5, 0}, {5, 5, 10}), cylinder}) {
        for (const double gap : {0.0, 1e-9, -1e-9, -5e-7}) {
            const Transform on_table = translation({0, 0, gap});
            EXPECT_FALSE(travel(body, on_table, {1, 0, 0}, table)) << gap;
            EXPECT_FALSE(travel(body, on_table, {0, 0, 1}, table)) << gap;
            EXPECT_NEAR(travel(body, on_table, down, table).value(), 0.0, 2e-6) << gap;
            const PlacedBody both[] = {{&table, {}}, {&wall, {}}};
            const auto found = first_contact(body, on_table, {1, 0, 0}, both);
            ASSERT_TRUE(found);
            EXPECT_NEAR(found->travel, 45.0, 1e-6);
            EXPECT_EQ(found->support, 1u);
        }
        // From outside on to the table, which is as high as the underside of the body.
        const ExactBody mesh_table = mesh_box({-100, -100, -20}, {100, 100, 0});
        for (const double gap : {0.0, 1e-9, -1e-9, -5e-7})
            for (const ExactBody& flush : {table, mesh_table}) {
                EXPECT_FALSE(travel(body, translation({-150, 0, gap}), {1, 0, 0}, flush)) << gap;
                EXPECT_FALSE(travel(flush, translation({-250, 0, -gap}), {1, 0, 0}, body)) << gap;
            }
        EXPECT_NEAR(travel(body, translation({-150, 0, -1e-3}), {1, 0, 0}, table).value(), 45.0,
                    1e-6);
        // Touching the wall, away from it and along it.
        EXPECT_FALSE(travel(body, translation({45, 0, 0}), {-1, 0, 0}, wall));
        EXPECT_FALSE(travel(body, translation({45, 0, 0}), {0, 1, 0}, wall));
        EXPECT_NEAR(travel(body, translation({45, 0, 0}), {1, 0, 0}, wall).value(), 0.0, 2e-6);
    }
}

TEST(FirstContact, KeepsABodyThatHasSunkInALittle) {
    const ExactBody table = convex(Aabb{{-100, -100, -20}, {100, 100, 0}});
    const ExactBody cylinder = convex(ProfileElement{0, 5, 10, 5, 0});
    for (const ExactBody& body : {mesh_box({-5, -5, 0}, {5, 5, 10}), cylinder}) {
        EXPECT_EQ(travel(body, translation({0, 0, -0.005}), down, table), 0.0);
        EXPECT_FALSE(travel(body, translation({0, 0, -0.005}), -down, table));
        EXPECT_FALSE(travel(body, translation({0, 0, -0.02}), down, table));
        EXPECT_EQ(travel(body, translation({0, 0, -0.02}), down, table, {}, {.sunk = 0.1}), 0.0);
        // Tilted across the surface.
        const Transform tilted{rotation_xyz_deg({10, 0, 0}), {0, 0, 0}};
        EXPECT_EQ(travel(mesh_box({-5, -5, 0}, {5, 5, 10}), tilted, down, table), 0.0);
    }
}

TEST(FirstContact, WithPlanesIsAtTheLowestPoint) {
    const FacePlane planes[] = {{{0, 0, -3}, {0, 0, 1}}, {{0, 0, 5}, {0, 0, -1}}};
    const ExactBody ball = convex_sphere(2.0);
    const auto found = first_contact(ball, translation({7, 8, 9}), down, {}, planes);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->travel, 10.0);
    EXPECT_EQ(found->support, 0u);
    EXPECT_FALSE(first_contact(ball, translation({7, 8, 9}), {1, 0, 0}, {}, planes));
    EXPECT_EQ(first_contact(ball, translation({7, 8, -9}), down, {}, planes)->travel, 0.0);
    EXPECT_FALSE(first_contact(ball, {}, down, {}));
    EXPECT_FALSE(first_contact(ExactBody(SolidMesh{}), {}, down, {}));
    EXPECT_FALSE(first_contact(ball, {}, Vec3(0.0), {}, planes));
}

TEST(FirstContact, OfBallsIsWhereTheirCentresAreApartByBothRadii) {
    std::mt19937 rng(1);
    std::uniform_real_distribution<double> aside(0.0, 1.2);
    int met = 0;
    for (int i = 0; i < 500; ++i) {
        const Transform at = random_pose(rng, 100.0);
        const Vec3 d = random_pose(rng, 1.0).rotation[2];
        const Vec3 across = glm::normalize(glm::cross(d, random_pose(rng, 1.0).rotation[0]));
        const double off = 8.0 * aside(rng);
        const Vec3 target = at.translation + 60.0 * d + off * across;
        const auto found = travel(ExactBody(convex_sphere(5.0)), at, d,
                                  ExactBody(convex_sphere(3.0)), translation(target));
        if (std::abs(off - 8.0) < 1e-3) continue;
        ASSERT_EQ(found.has_value(), off < 8.0) << off;
        if (!found) continue;
        ++met;
        const double expected = 60.0 - std::sqrt(64.0 - off * off);
        // Where the balls nearly pass each other, a little aside counts for much along.
        EXPECT_NEAR(*found, expected, 1e-6 / std::min(1.0, 0.5 * (8.0 - off))) << off;
    }
    EXPECT_GT(met, 300);
}

TEST(FirstContact, OfUprightCylindersAndBoxesIsKnown) {
    const ExactBody pin = convex(ProfileElement{0, 5, 40, 5, 0});
    const ExactBody jaw = convex(Aabb{{30, -50, 0}, {60, 50, 40}});
    EXPECT_NEAR(travel(pin, {}, {1, 0, 0}, jaw).value(), 25.0, 1e-6);
    EXPECT_NEAR(travel(jaw, {}, {-1, 0, 0}, pin).value(), 25.0, 1e-6);
    const Vec3 d = glm::normalize(Vec3(1, 1, 0));
    EXPECT_NEAR(travel(pin, {}, d, jaw).value(), 25.0 * std::sqrt(2.0), 2e-6);
    // On a block with a bore: the pin of radius 5 goes through, one of 13 rests on its rim.
    const ExactBody block = solid_mesh(bored_block(50.0, 30.0, 12.0, 40));
    EXPECT_FALSE(travel(pin, translation({0, 0, 80}), down, block));
    const ExactBody thick = convex(ProfileElement{0, 13, 40, 13, 0});
    EXPECT_NEAR(travel(thick, translation({0, 0, 80}), down, block).value(), 50.0, 1e-6);
    EXPECT_NEAR(travel(pin, translation({9, 0, 80}), down, block).value(), 50.0, 1e-6);
}

ExactBody random_body(std::mt19937& rng) {
    switch (rng() % 6) {
    case 0:
        return solid_mesh(torus_mesh(8.0, 3.0, 12, 8));
    case 1:
        return solid_mesh(ball_mesh(4.0, 6, 8));
    case 2:
        return solid_mesh(bored_block(7.0, 4.0, 3.0, 16));
    case 3:
        return convex(ProfileElement{-2, 3, 4, 1, 0});
    case 4:
        return convex(ProfileElement{-2, 3, 4, 2, 0.5});
    default:
        return convex(Aabb{{-1, -3, -2}, {2, 3, 1}});
    }
}

TEST(FirstContact, IsWhereTheDistanceBecomesZero) {
    std::mt19937 rng(2);
    int met = 0, missed = 0;
    for (int i = 0; i < 1000; ++i) {
        const ExactBody body = random_body(rng), support = random_body(rng);
        const Vec3 d = random_pose(rng, 1.0).rotation[2];
        const Transform pose = random_pose(rng, 9.0),
                        other{random_pose(rng, 1.0).rotation, 40.0 * d};
        // A graze would count as contact below, so nearly none is allowed.
        const auto found = travel(body, pose, d, support, other, {.graze = 1e-8});
        const Transform support_from_body = other.inverse() * pose;
        const Vec3 along = glm::transpose(other.rotation) * d;
        const auto gap_over = [&](double from, double to) {
            return separation(support, body, translation(from * along) * support_from_body,
                              (to - from) * along, {.tolerance = 1e-9});
        };
        if (!found) {
            EXPECT_GT(gap_over(0.0, 120.0).upper, 0.0) << i;
            ++missed;
            continue;
        }
        ++met;
        // Free before, and at once in contact after.
        EXPECT_GT(gap_over(0.0, *found - 1e-6).upper, 0.0) << i;
        EXPECT_LE(gap_over(*found + 1e-6, *found + 1e-6).upper, 1e-9) << i;
    }
    EXPECT_GT(met, 250);
    EXPECT_GT(missed, 200);
}

TEST(FirstContact, IsTheSameForTheMotionTheOtherWay) {
    std::mt19937 rng(3);
    for (int i = 0; i < 300; ++i) {
        const ExactBody a = random_body(rng), b = random_body(rng);
        const Vec3 d = random_pose(rng, 1.0).rotation[2];
        const Transform pose = random_pose(rng, 6.0),
                        other{random_pose(rng, 1.0).rotation, 40.0 * d};
        const auto there = travel(a, pose, d, b, other), back = travel(b, other, -d, a, pose);
        ASSERT_EQ(there.has_value(), back.has_value()) << i;
        if (!there) continue;
        EXPECT_NEAR(*there, *back, 1e-5) << i;
    }
}

TEST(FirstContact, ClosesTheJawsOfAViseOnItsStock) {
    const ExactBody bed = asset("vise6-body.stl"), fixed = asset("vise6-fixed-jaw.stl");
    const ExactBody jaw = asset("vise6-moving-jaw.stl");
    const ExactBody stock = convex(Aabb{{-60, -101.6, 10}, {60, 0, 50}});
    const PlacedBody supports[] = {{&bed, {}}, {&fixed, {}}, {&stock, {}}};
    // The jaw slides on the bed, flush with its top, and stops at the stock.
    const auto closed = first_contact(jaw, translation({0, -225, 0}), {0, 1, 0}, supports);
    ASSERT_TRUE(closed);
    EXPECT_EQ(closed->support, 2u);
    EXPECT_NEAR(closed->travel, 225.0 - 101.6, 1e-9);
    // Without stock at the fixed jaw.
    const auto empty = first_contact(jaw, translation({0, -225, 0}), {0, 1, 0}, {supports, 2});
    ASSERT_TRUE(empty);
    EXPECT_EQ(empty->support, 1u);
    EXPECT_NEAR(empty->travel, 225.0, 1e-9);
    // The stock, let go, falls on the bed between the jaws that touch it.
    const ExactBody closed_jaw = jaw;
    const PlacedBody under[] = {{&bed, {}}, {&fixed, {}}, {&jaw, translation({0, -101.6, 0})}};
    const auto fallen = first_contact(stock, {}, down, under);
    ASSERT_TRUE(fallen);
    EXPECT_EQ(fallen->support, 0u);
    EXPECT_NEAR(fallen->travel, 10.0, 1e-9);
}

TEST(FirstContact, PutsTheClampOnItsHeel) {
    const ExactBody clamp = asset("clamp.stl"), vise = asset("vise-116.stl");
    const FacePlane table{{0, 0, -40}, {0, 0, 1}};
    const auto found = first_contact(clamp, translation({300, 0, 7}), down, {}, {&table, 1});
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->travel, 25.0, 1e-9); // the heel is 22 below its origin
    const PlacedBody on{&vise, {}};
    const auto on_jaw =
        first_contact(clamp, translation({-55, 75, 120}), down, {&on, 1}, {&table, 1});
    ASSERT_TRUE(on_jaw);
    EXPECT_NEAR(on_jaw->travel, 120.0 - 50.0 - 22.0, 1e-9);
}

} // namespace
} // namespace core
