#include <random>

#include <gtest/gtest.h>

#include "core/geom/box_mesh.h"
#include "hwsim/body_cover.h"

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

} // namespace
} // namespace hwsim
