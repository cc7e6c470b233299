#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/geom/mesh.h"
#include "hwsim/body_cover.h"
#include "hwsim/tool_model.h"

namespace hwsim {
namespace {

using core::ExactBody;
using core::Vec3;

/// How far a point is from a body; 0 inside.
double outside(const ExactBody& body, const Vec3& p) {
    return separation(core::convex_segment(p, p), body).lower;
}

bool holds(const std::vector<Record>& posts, const Vec3& p) {
    for (const Record& post : posts)
        if (std::abs(p.x - length_of(post.base[0])) <= length_of(post.half)
            && std::abs(p.y - length_of(post.base[1])) <= length_of(post.half)
            && p.z >= length_of(post.base[2]) && p.z <= length_of(post.base[2] + post.run))
            return true;
    return false;
}

TEST(PostsRound, HoldEveryPointOfABody) {
    const core::Transform tilted{core::rotation_xyz_deg({30, 20, 0}), {5, -3, 2}};
    const std::vector<ExactBody> bodies = {
        core::convex(core::Aabb{{3, 4, 5}, {9, 12, 6}}),
        posed(core::convex(core::ProfileElement{-2, 3, 5, 4, 0.5}), core::translation({9, -8, 7})),
        posed(core::convex(core::ProfileElement{-2, 3, 5, 4, 0.5}), tilted),
        posed(core::convex(core::Aabb{{3, 4, 5}, {9, 12, 6}}), tilted), core::convex_sphere(4.2)};
    std::mt19937 rng(1);
    for (const ExactBody& body : bodies) {
        const double h = 0.8;
        const std::vector<Record> posts = posts_round(body, h).value();
        const core::Aabb box = bounds(body);
        int inside = 0;
        for (int i = 0; i < 4'000; ++i) {
            std::uniform_real_distribution<double> share(0.0, 1.0);
            const double x = share(rng), y = share(rng), z = share(rng);
            const Vec3 p = box.min + Vec3(x, y, z) * box.size();
            if (outside(body, p) > 0.0) continue;
            ++inside;
            ASSERT_TRUE(holds(posts, p));
        }
        EXPECT_GT(inside, 400);
    }
}

TEST(PostsRound, ReachLittleFartherThanABox) {
    const core::Aabb box{{3, 4, 5}, {29, 32, 6}};
    const std::vector<Record> posts = posts_round(core::convex(box), 1.0).value();
    EXPECT_LT(posts.size(), 200U);
    for (const Record& post : posts) {
        const Vec3 at(length_of(post.base[0]), length_of(post.base[1]), length_of(post.base[2]));
        EXPECT_GE(at.x - length_of(post.half), box.min.x - 0.13);
        EXPECT_LE(at.y + length_of(post.half), box.max.y + 0.13);
        EXPECT_NEAR(at.z, box.min.z, 2 * lsb);
    }
}

bool in_cylinder(const std::vector<Record>& cylinders, const Vec3& p, double more = 0.0) {
    for (const Record& c : cylinders)
        if (std::hypot(p.x - length_of(c.base[0]), p.y - length_of(c.base[1]))
                <= length_of(c.half) + more
            && p.z >= length_of(c.base[2]) - more && p.z <= length_of(c.base[2] + c.run) + more)
            return true;
    return false;
}

core::Mat3 random_turn(std::mt19937& rng) {
    std::uniform_real_distribution<double> angle(-180.0, 180.0);
    const double a = angle(rng), b = angle(rng), c = angle(rng);
    return core::rotation_xyz_deg({a, b, c});
}

TEST(PostsRound, HoldEveryPointOfABodyOfRevolutionHoweverItIsTurned) {
    const core::RevolvedProfile mill{{{-1, 0, 0, 3, 0.0}, {0, 3, 12, 3, 0.0}, {12, 5, 20, 6, 0.4}}};
    std::mt19937 rng(2);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    for (int turn = 0; turn < 12; ++turn) {
        const core::Mat3 orientation =
            turn == 0 ? core::rotation_xyz_deg({90, 0, 0}) : random_turn(rng);
        const double h = 0.6;
        const std::vector<Record> posts = posts_round(mill, h, orientation).value();
        const auto cylinders = cylinders_round(posts);
        for (int i = 0; i < 2'000; ++i) {
            const core::ProfileElement& e = mill.elements[static_cast<size_t>(i) % 3];
            const double t = share(rng), angle = 7.0 * share(rng);
            // A good half of them on the surface.
            const double r = (e.r0 + t * (e.r1 - e.r0)) * std::min(1.0, 2.0 * share(rng));
            const Vec3 p(r * std::cos(angle), r * std::sin(angle), e.z0 + t * (e.z1 - e.z0));
            ASSERT_TRUE(holds(posts, orientation * p));
        }
        // Nothing of them is farther out than half a cell's diagonal and what a cylinder adds.
        for (const Record& c : cylinders) {
            const Vec3 low(length_of(c.base[0]), length_of(c.base[1]), length_of(c.base[2]));
            const Vec3 in_body = glm::transpose(orientation) * low;
            EXPECT_LT(
                outside(posed(core::convex(core::ProfileElement{-1, 6, 20, 6, 0.4}), {}), in_body),
                1.7 * h);
        }
    }
}

/// Where a ray from the middle of a convex body leaves it, from inside.
Vec3 surface_point(const ExactBody& body, std::mt19937& rng) {
    std::normal_distribution<double> any;
    const double x = any(rng), y = any(rng), z = any(rng);
    const core::Aabb box = bounds(body);
    const Vec3 middle = 0.5 * (box.min + box.max);
    const Vec3 way = glm::length(box.size()) * glm::normalize(Vec3(x, y, z));
    double inside = 0.0, beyond = 1.0;
    for (int i = 0; i < 60; ++i) {
        const double half = 0.5 * (inside + beyond);
        (outside(body, middle + half * way) == 0.0 ? inside : beyond) = half;
    }
    return middle + inside * way;
}

TEST(CubesRound, HoldTheSurfaceOfABodyHoweverItIsTurned) {
    const std::vector<ExactBody> bodies = {
        core::convex(core::Aabb{{3, 4, 5}, {29, 22, 16}}),
        solid_mesh(core::mesh_of({{-7, -3, -9}, {4, 13, 2}})),
        posed(core::convex(core::ProfileElement{-2, 6, 15, 8, 0.5}),
              core::translation({9, -8, 7}))};
    std::mt19937 rng(3);
    for (const ExactBody& body : bodies) {
        const CubeCover cubes = cubes_round(body, 1.3);
        const core::Aabb box = bounds(body);
        const Vec3 count = box.size() / 1.3;
        EXPECT_LT(cubes.centres.size(), (count.x + 1) * (count.y + 1) * (count.z + 1) * 0.8)
            << "inner records are omitted";
        for (int turn = 0; turn < 6; ++turn) {
            const core::Mat3 orientation = turn == 0 ? core::Mat3(1.0) : random_turn(rng);
            const std::vector<Record> cylinders = cylinders_round(cubes, orientation).value();
            for (int i = 0; i < 500; ++i)
                ASSERT_TRUE(in_cylinder(cylinders, orientation * surface_point(body, rng), 1e-6));
        }
    }
}

} // namespace
} // namespace hwsim
