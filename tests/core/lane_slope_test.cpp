#include <bit>
#include <random>

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include "core/base/math.h"
#include "core/dbm/lane_cut.h"

namespace {

using namespace core;

/// The results for a chunk of lines compared with line_interval.
struct Compared {
    int met = 0, both_missed = 0;
    double longest = -infinity, shortest = infinity; // excess of the lanes' interval at an end
};

/// Random moves, most of them up or down, some of them nearly or exactly level or vertical.
CutterSweep random_move(std::mt19937& rng, const std::shared_ptr<const Cutter>& cutter) {
    const auto within = [&](double reach) {
        return std::uniform_real_distribution<double>(-reach, reach)(rng);
    };
    CutterSweep sweep{cutter, {within(2), within(2), within(2)}, {}};
    Vec3 by(within(4), within(4), within(4));
    const auto kind = rng() % 8;
    if (kind == 0) by.z *= 0.01;
    if (kind == 1) by.x *= 0.01, by.y *= 0.01;
    if (kind == 2) by.x = 0.0;
    if (kind == 3) by.y = 0.0;
    if (kind == 4) by.z = 0.0;
    if (kind == 5) by.x = by.y = 0.0;
    sweep.to = sweep.from + by;
    return sweep;
}

Compared compare(const RevolvedProfile& flutes, unsigned seed) {
    std::mt19937 rng(seed);
    const auto cutter = std::make_shared<const Cutter>(make_cutter(flutes, 0.0));
    Compared all;
    for (int round = 0; round < 300; ++round) {
        const CutterSweep sweep = random_move(rng, cutter);
        const int axis = static_cast<int>(rng() % 3);
        const Aabb box = bounds(sweep);
        const int ua = u_axis(axis), va = v_axis(axis);
        const auto between = [&](int along) {
            return std::uniform_real_distribution<double>(box.min[along], box.max[along])(rng);
        };
        std::array<double, CornerStretches::size> u;
        for (double& position : u) position = between(ua);
        const double v = between(va);
        CornerStretches found;
        for (const Cutter::Piece& piece : cutter->pieces) {
            const LanePlan plan = lane_plan(piece.around, sweep, axis);
            EXPECT_TRUE(plan.by_lanes);
            lane_cut().stretches(plan, u.data(), v, 0xffffff, found);
            for (size_t i = 0; i < u.size(); ++i) {
                const auto truth = line_interval(piece.around, sweep, axis, u[i], v);
                const bool met = found.lower[i] < found.upper[i];
                if (!truth || !met) {
                    all.both_missed += !truth && !met;
                    // A line that only grazes the body may be missed.
                    if (truth) all.shortest = std::min(all.shortest, -truth->length());
                    if (met) all.longest = std::max(all.longest, found.upper[i] - found.lower[i]);
                    continue;
                }
                ++all.met;
                for (const double longer :
                     {truth->lower - found.lower[i], found.upper[i] - truth->upper}) {
                    all.longest = std::max(all.longest, longer);
                    all.shortest = std::min(all.shortest, longer);
                }
            }
        }
    }
    return all;
}

void expect_equal(const RevolvedProfile& flutes, double shorter) {
    const Compared all = compare(flutes, 7);
    EXPECT_GT(all.met, 2000);
    EXPECT_GT(all.both_missed, 300);
    EXPECT_LT(all.longest, 1e-8);
    EXPECT_GT(all.shortest, -shorter);
}

TEST(LaneSlope, MeetsWideningConesAsLineByLine) {
    expect_equal({{{0, 1, 10, 3, 0}}}, 1e-7);
    expect_equal({{{0, 0, 1.8, 3, 0}}}, 1e-7);
    expect_equal({{{0, 2, 0.3, 3, 0}}}, 1e-7);
}

TEST(LaneSlope, MeetsNarrowingConesAsLineByLine) {
    expect_equal({{{0, 3, 2, 1, 0}}}, 1e-7);
    expect_equal({{{0, 3, 8, 2.5, 0}}}, 1e-7);
}

TEST(LaneSlope, MeetsRoundedCornersAsLineByLine) {
    expect_equal({{{1, 2, 1, 2, 1}}}, 1e-6);
    expect_equal({{{0.2, 2.8, 0.2, 2.8, 0.2}}}, 1e-6);
    expect_equal({{{2.5, 0.5, 2.5, 0.5, 2.5}}}, 1e-6);
}

/// A ball of cones, its tip a little flat, and above its equator an undercut: what a ball nose with
/// flutes that end below the top of the ball is made of.
RevolvedProfile ball_of_cones(double radius, int cones, double up_to) {
    RevolvedProfile ball;
    double z0 = 0.0, r0 = 0.05;
    for (int i = 1; i <= cones; ++i) {
        const double angle = up_to * i / cones;
        const double z1 = radius * (1.0 - core::cos(angle)), r1 = radius * core::sin(angle);
        ball.elements.push_back({z0, r0, z1, r1, 0.0});
        z0 = z1;
        r0 = r1;
    }
    return ball;
}

TEST(LaneSlope, MeetsManyConesAsLineByLine) {
    expect_equal(ball_of_cones(3.0, 20, 1.5707), 1e-7);
    expect_equal(ball_of_cones(3.0, 20, 2.2), 1e-7);
    RevolvedProfile form = ball_of_cones(2.0, 7, 1.4);
    const ProfileElement last = form.elements.back();
    form.elements.push_back({last.z1, last.r1, last.z1 + 3.0, last.r1 + 0.1, 0.0});
    form.elements.push_back({last.z1 + 3.0, last.r1 + 0.1, last.z1 + 6.0, last.r1 + 0.1, 0.0});
    form.elements.push_back({last.z1 + 6.0, last.r1 + 0.1, last.z1 + 7.0, last.r1 - 1.0, 0.0});
    expect_equal(form, 1e-7);
    expect_equal({{{1, 2, 1, 2, 1}, {1, 3, 5, 3, 0}, {5, 3, 6, 2.5, 0}, {6, 2.5, 7, 1.5, 0}}},
                 1e-6);
}

TEST(LaneSlope, LeavesOutNoConeThatMatters) {
    // With all cones, and with one at a time: the hull is the same.
    const RevolvedProfile ball = ball_of_cones(3.0, 12, 2.5);
    const auto cutter = std::make_shared<const Cutter>(make_cutter(ball, 0.0));
    ASSERT_EQ(cutter->pieces.size(), 1U);
    std::mt19937 rng(5);
    for (int round = 0; round < 300; ++round) {
        const CutterSweep sweep = random_move(rng, cutter);
        const int axis = round % 3;
        std::array<double, CornerStretches::size> u;
        for (size_t i = 0; i < u.size(); ++i) u[i] = -5.0 + 0.4 * static_cast<double>(i);
        const double v = -2.0 + 0.02 * round;
        CornerStretches all;
        lane_cut().stretches(lane_plan(ball, sweep, axis), u.data(), v, 0xffffff, all);
        CornerStretches hull;
        hull.lower.fill(infinity);
        hull.upper.fill(-infinity);
        for (const ProfileElement& one : ball.elements) {
            const RevolvedProfile alone{{one}};
            CornerStretches part;
            lane_cut().stretches(lane_plan(alone, sweep, axis), u.data(), v, 0xffffff, part);
            for (size_t i = 0; i < u.size(); ++i) {
                hull.lower[i] = std::min(hull.lower[i], part.lower[i]);
                hull.upper[i] = std::max(hull.upper[i], part.upper[i]);
            }
        }
        for (size_t i = 0; i < u.size(); ++i) {
            ASSERT_EQ(all.lower[i] < all.upper[i], hull.lower[i] < hull.upper[i]);
            if (!(hull.lower[i] < hull.upper[i])) continue;
            EXPECT_NEAR(all.lower[i], hull.lower[i], 1e-9) << round << " " << i;
            EXPECT_NEAR(all.upper[i], hull.upper[i], 1e-9) << round << " " << i;
        }
    }
}

/// A hash of what random moves of the cutter sweep; any changed bit changes it.
uint64_t hash_of_stretches(const RevolvedProfile& flutes) {
    std::mt19937 rng(11);
    const auto cutter = std::make_shared<const Cutter>(make_cutter(flutes, 0.0));
    uint64_t hash = 1469598103934665603ULL;
    for (int round = 0; round < 200; ++round) {
        const CutterSweep sweep = random_move(rng, cutter);
        const LanePlan plan = lane_plan(cutter->pieces[0].around, sweep, round % 3);
        std::array<double, CornerStretches::size> u;
        for (size_t i = 0; i < u.size(); ++i) u[i] = -6.0 + 0.5 * static_cast<double>(i);
        CornerStretches found;
        lane_cut().stretches(plan, u.data(), -3.0 + 0.05 * round, 0xffffff, found);
        for (size_t i = 0; i < u.size(); ++i)
            for (const double end : {found.lower[i], found.upper[i]})
                hash = (hash ^ std::bit_cast<uint64_t>(end)) * 1099511628211ULL;
    }
    return hash;
}

TEST(LaneSlope, GivesTheSameBitsOnEveryInstructionSet) {
    const auto choose = [](int64_t targets) {
        hwy::SetSupportedTargetsForTest(targets);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    };
    const std::vector<RevolvedProfile> shapes = {
        {{{0, 1, 10, 3, 0}}}, {{{0, 0, 1.8, 3, 0}}}, {{{0, 3, 2, 1, 0}}}, {{{1, 2, 1, 2, 1}}}};
    for (const RevolvedProfile& flutes : shapes) {
        const uint64_t hash = hash_of_stretches(flutes);
        for (int64_t left = hwy::SupportedTargets() & HWY_TARGETS; left != 0; left &= left - 1) {
            choose(left & -left);
            EXPECT_EQ(hash_of_stretches(flutes), hash) << hwy::TargetName(left & -left);
            choose(0);
        }
    }
}

} // namespace
