#include <bit>
#include <random>

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include "core/dbm/lane_cut.h"

namespace {

using namespace core;

/// The results for a chunk of lines compared with line_interval.
struct Compared {
    int met = 0, both_missed = 0;
    double longest = -infinity, shortest = infinity; // excess of the lanes' interval at an end
};

/// Random moves up or down, some of them nearly level or nearly vertical.
CutterSweep random_move(std::mt19937& rng, const std::shared_ptr<const Cutter>& cutter) {
    const auto within = [&](double reach) {
        return std::uniform_real_distribution<double>(-reach, reach)(rng);
    };
    CutterSweep sweep{cutter, {within(2), within(2), within(2)}, {}};
    Vec3 by(within(4), within(4), within(4));
    const auto kind = rng() % 6;
    if (kind == 0) by.z *= 0.01;
    if (kind == 1) by.x *= 0.01, by.y *= 0.01;
    if (kind == 2) by.x = 0.0;
    if (kind == 3) by.y = 0.0;
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
