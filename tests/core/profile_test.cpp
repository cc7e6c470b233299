#include <random>

#include <gtest/gtest.h>

#include "core/geom/profile.h"
#include "tests/support/profile_oracle.h"

namespace core {
namespace {

using test_support::outline;
using test_support::outside;

const RevolvedProfile flat{{{0, 5, 20, 5, 0}}};
const RevolvedProfile ball{{{4, 0, 4, 0, 4}, {4, 4, 20, 4, 0}}};
const RevolvedProfile bull{{{1, 4, 1, 4, 1}, {1, 5, 20, 5, 0}}};
const RevolvedProfile drill{{{0, 0, 3, 5, 0}, {3, 5, 30, 5, 0}}};
const RevolvedProfile taper{{{0, 1, 20, 4, 0}}};
const RevolvedProfile chamfer{{{0, 0.5, 4.5, 5, 0}, {4.5, 5, 12, 5, 0}}};
const RevolvedProfile slot{{{0, 10, 4, 10, 0}, {4, 4, 20, 4, 0}}};
const RevolvedProfile steps{{{0, 3, 10, 3, 0}, {10, 6, 15, 8, 0}, {15, 12, 20, 12, 0}}};
const RevolvedProfile waist{{{0, 8, 6, 2, 0}, {6, 2, 12, 8, 0}}};
const RevolvedProfile short_pieces{
    {{0, 4, 1, 4, 0}, {1, 4, 1.02, 5, 0}, {1.02, 5, 1.05, 3, 0}, {1.05, 3, 8, 3.5, 0}}};
const RevolvedProfile dovetail{{{0, 10, 5, 6, 0}, {5, 4, 20, 4, 0}}};

// A ball of radius 1 mm with a flank tangential to it at 3-4-5, 0.4 mm above the tip.
const RevolvedProfile round_taper{
    {{1, 0, 1, 0, 1}, {0.4, 0.8, 12.4, 9.8, 0}, {12.4, 9.8, 20, 9.8, 0}}};
const RevolvedProfile round_bull{{{1, 2, 1, 2, 1}, {0.2, 2.6, 3.2, 6.6, 0}}};
const RevolvedProfile thin_disc{{{0, 2, 3, 2, 0}, {3, 8, 3.08, 8, 0}, {3.08, 2, 9, 2, 0}}};
const RevolvedProfile teeth{{{0, 4, 0.5, 4, 0},
                             {0.5, 4, 1, 5, 0},
                             {1, 5, 1.25, 5, 0},
                             {1.25, 5, 1.75, 4, 0},
                             {1.75, 4, 2.25, 4, 0}}};

const std::vector<RevolvedProfile> convex_ones = {flat,  ball,    bull,        drill,
                                                  taper, chamfer, round_taper, round_bull};
const std::vector<RevolvedProfile> others = {slot,     steps,     waist, short_pieces,
                                             dovetail, thin_disc, teeth};

std::vector<RevolvedProfile> all() {
    std::vector<RevolvedProfile> profiles = convex_ones;
    profiles.insert(profiles.end(), others.begin(), others.end());
    return profiles;
}

/// Distance in the half-plane to the outline of the union of the pieces.
double to_surface(const std::vector<Vec3>& line, const Vec3& p) {
    double least = infinity;
    for (const Vec3& q : line) least = std::min(least, glm::distance(p, q));
    return least;
}

constexpr double outline_step = 0.01;

/// Calls act(profile, by, p, outside, distance to the surface) for points near the surface.
template <typename Act>
void for_points(const std::vector<RevolvedProfile>& profiles, const Act& act) {
    std::mt19937 rng(21);
    for (const RevolvedProfile& profile : profiles) {
        const std::vector<Vec3> line = outline(profile, outline_step);
        for (const double by : {0.05, 0.3}) {
            std::uniform_real_distribution<double> away(-1.5 * by, 1.5 * by);
            for (int i = 0; i < 3000; ++i) {
                Vec3 p = line[rng() % line.size()] + Vec3(away(rng), 0.0, away(rng));
                p.x = std::abs(p.x);
                act(profile, by, p, outside(profile, p), to_surface(line, p));
            }
        }
    }
}

TEST(Profile, IsConvexOnlyWithoutSeamsThatTurnOutwards) {
    for (const RevolvedProfile& p : convex_ones) EXPECT_TRUE(is_convex(p));
    for (const RevolvedProfile& p : others) EXPECT_FALSE(is_convex(p));
    EXPECT_FALSE(is_convex({}));
    EXPECT_FALSE(is_convex({{{0, 5, 5, 5, 0}, {6, 5, 9, 5, 0}}})); // a gap
    EXPECT_FALSE(is_convex({{{0, 2, 5, 3, 0}, {5, 3, 9, 5, 0}}})); // steeper above
    EXPECT_FALSE(is_convex({{{0, 2, 5, 3, 0}, {9, 1, 9, 1, 1}}})); // a ball above a cone
    EXPECT_TRUE(is_convex({{{0, 2, 5, 3, 0}, {5, 3, 9, 1, 0}}}));
    EXPECT_FALSE(is_convex({{{1, 0, 1, 0, 1}, {0.4, 0.8, 12.4, 9.9, 0}}}));   // not tangential
    EXPECT_FALSE(is_convex({{{1, 0, 1, 0, 1}, {0.4, 0.81, 12.4, 9.81, 0}}})); // not on the rounding
    EXPECT_FALSE(is_convex({{{1, 0, 1, 0, 1}, {0.4, 0.8, 1.9, 1.925, 0}}}));  // the ball is higher
}

TEST(ProfileShrunkWithin, KeepsItsDistanceFromTheSurface) {
    int kept = 0, dropped = 0;
    for_points(all(), [&](const auto& profile, double by, const Vec3& p, double out, double near) {
        if (outside(shrunk_within(profile, by), p) > 0.0) {
            ++dropped;
            return;
        }
        ++kept;
        EXPECT_LT(out, 0.0);
        EXPECT_GE(near, by - 1e-9);
    });
    EXPECT_GT(kept, 1000);
    EXPECT_GT(dropped, 10000);
}

TEST(ProfileShrunkWithin, LeavesNoMoreThanASeamOut) {
    for_points(convex_ones,
               [&](const auto& profile, double by, const Vec3& p, double out, double near) {
                   if (out > 0.0 || near < by * 1.01 + outline_step) return;
                   const RevolvedProfile inner = shrunk_within(profile, by);
                   double seam = infinity;
                   for (const ProfileElement& e : profile.elements)
                       seam = std::min({seam, std::abs(p.z - e.z0), std::abs(p.z - e.z1)});
                   EXPECT_LE(seam > by ? outside(inner, p) : 0.0, 1e-9);
               });
}

TEST(ProfileShrunkAround, HoldsWhatIsDeeperAndNothingOutside) {
    int deep = 0, out_of_it = 0;
    for_points(all(), [&](const auto& profile, double by, const Vec3& p, double out, double near) {
        const double inner = outside(shrunk_around(profile, by), p);
        if (out > 1e-9) {
            ++out_of_it;
            EXPECT_GT(inner, 0.0) << p.x << ' ' << p.z;
        }
        if (out < 0.0 && near > by + outline_step) {
            ++deep;
            EXPECT_LE(inner, 1e-9) << p.x << ' ' << p.z << " by " << by << " near " << near
                                   << " profile of " << profile.elements.size();
        }
    });
    EXPECT_GT(deep, 1000);
    EXPECT_GT(out_of_it, 10000);
}

TEST(ProfileShrunkAround, ClearsTheWallsAndTheFloorThatItTouched) {
    for (const RevolvedProfile& profile : convex_ones) {
        const RevolvedProfile inner = shrunk_around(profile, 0.05);
        const double top = bounds(profile).max.z - 0.06;
        for (const Vec3& q : outline(profile, 0.1))
            EXPECT_GE(q.z < top ? outside(inner, q) : 1.0, 0.03) << q.x << ' ' << q.z;
    }
}

TEST(ProfileShrunkAround, ClearsTheCeilingOfAnUndercut) {
    const RevolvedProfile inner = shrunk_around(slot, 0.05);
    for (double r = 4.1; r < 10.0; r += 0.1) EXPECT_GE(outside(inner, {r, 0, 4}), 0.04) << r;
    EXPECT_LE(outside(inner, {3.9, 0, 4}), 0.0); // the neck passes through
}

TEST(ProfileGrown, HoldsWhatIsNearer) {
    int held = 0, far = 0;
    for_points(all(), [&](const auto& profile, double by, const Vec3& p, double out, double near) {
        const double beyond = outside(grown(profile, by), p);
        if (out <= 0.0 || near < by - outline_step) {
            ++held;
            EXPECT_LE(beyond, 1e-9);
        }
        if (out > 0.0 && near > 4.0 * by && is_convex(profile)) {
            ++far;
            EXPECT_GT(beyond, 0.0);
        }
    });
    EXPECT_GT(held, 10000);
}

TEST(ProfileBounds, HoldEveryPiece) {
    for (const RevolvedProfile& profile : all())
        for (const Vec3& q : outline(profile, 0.1)) {
            const Aabb box = bounds(profile);
            EXPECT_LE(q.x, box.max.x + 1e-9);
            EXPECT_LE(box.min.z, q.z + 1e-9);
            EXPECT_LE(q.z, box.max.z + 1e-9);
        }
}

} // namespace
} // namespace core
