#include <algorithm>
#include <bit>
#include <random>

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include "core/base/math.h"
#include "core/dbm/cut_model.h"
#include "core/dbm/lane_cut.h"

namespace {

using namespace core;

/// The results for a chunk of lines compared with line_interval.
struct Compared {
    int met = 0, both_missed = 0, by_lanes = 0;
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

/// A random orientation; some turn about one axis only, some by next to nothing or a right angle.
Mat3 random_orientation(std::mt19937& rng) {
    const auto angle = [&] {
        const double any = std::uniform_real_distribution<double>(-180.0, 180.0)(rng);
        const auto kind = rng() % 8;
        return kind == 0 ? 0.0 : kind == 1 ? 90.0 : kind == 2 ? 1e-5 * any : any;
    };
    return rotation_xyz_deg({angle(), angle(), angle()});
}

Compared compare(const RevolvedProfile& flutes, unsigned seed, bool tilted = false) {
    std::mt19937 rng(seed);
    const auto cutter = std::make_shared<const Cutter>(make_cutter(flutes, 0.0));
    Compared all;
    for (int round = 0; round < 300; ++round) {
        CutterSweep sweep = random_move(rng, cutter);
        if (tilted) sweep.orientation = random_orientation(rng);
        const int axis = static_cast<int>(rng() % 3);
        const Aabb box = bounds(sweep);
        const int ua = u_axis(axis), va = v_axis(axis);
        const auto between = [&](int along) {
            return std::uniform_real_distribution<double>(box.min[along], box.max[along])(rng);
        };
        std::array<double, CornerStretches::size> u;
        for (double& position : u) position = between(ua);
        std::sort(u.begin(), u.end());
        const double v = between(va);
        CornerStretches found;
        for (const Cutter::Piece& piece : cutter->pieces) {
            const LanePlan plan = lane_plan(piece.around, sweep, axis);
            EXPECT_TRUE(plan.by_lanes || tilted);
            all.by_lanes += plan.by_lanes;
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

/// Tilted tools: cones, cylinders and balls in lanes, as exact as line by line.
TEST(TiltedLanes, GiveTheSameAsLineByLine) {
    const RevolvedProfile cylinder{{{0, 1.5, 4, 1.5, 0}}};
    const RevolvedProfile cone{{{0, 0.3, 3, 1.8, 0}}},
        drill{{{0, 0.0, 1, 1.0, 0}, {1, 1.0, 4, 1.0, 0}}};
    const RevolvedProfile ball{{{1, 0, 1, 0, 1}, {1, 1, 5, 1, 0}}};
    const RevolvedProfile narrowing{{{0, 1.5, 2, 0.5, 0}}}, disc{{{0, 2, 0.1, 2, 0}}};
    for (const RevolvedProfile& flutes : {cylinder, cone, drill, ball, narrowing, disc})
        for (unsigned seed = 1; seed <= 8; ++seed) {
            const Compared all = compare(flutes, seed, true);
            EXPECT_GT(all.met, 500);
            EXPECT_GT(all.by_lanes, 200) << "of 300 moves";
            EXPECT_LT(all.longest, 1e-8);
            EXPECT_GT(all.shortest, -1e-6);
        }
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

/// The least and the greatest difference between what is left on the lines of a cut stock and what
/// is left of the raw stock after removing what the move sweeps, line by line.
Interval differences_after(const CutModel& model, const CutModel& raw, const CutterSweep& sweep) {
    Interval found{0.0, 0.0};
    for (int axis = 0; axis < 3; ++axis) {
        const ScanLines& now = model.lines.families[static_cast<size_t>(axis)];
        const ScanLines& before = raw.lines.families[static_cast<size_t>(axis)];
        for (int v = 0; v < now.v_count(); ++v)
            for (int u = 0; u < now.u_count(); ++u) {
                IntervalList expected;
                for (const Interval& matter : before.line(u, v)) expected.add(matter);
                const Vec3 at = point_on_line(model.lines.grid, axis, u, v, 0.0);
                for (const Cutter::Piece& piece : sweep.cutter->pieces)
                    if (const auto gone = line_interval(piece.around, sweep, axis, at[u_axis(axis)],
                                                        at[v_axis(axis)]))
                        expected.subtract(*gone);
                double left = 0.0, right = 0.0;
                for (const Interval& matter : now.line(u, v)) left += matter.length();
                for (const Interval& matter : expected) right += matter.length();
                found.lower = std::min(found.lower, left - right);
                found.upper = std::max(found.upper, left - right);
            }
    }
    return found;
}

TEST(LaneSlope, CutsWhatElementsThatAreLeftOutSpan) {
    // A thin sheet between the lowest element and the highest, at rest and on short moves.
    std::vector<RevolvedProfile> shapes = {{{{0, 1, 1, 3, 0}, {1, 3, 5, 4, 0}, {5, 4, 10, 4, 0}}},
                                           {{{1, 2, 1, 2, 1}, {1, 3, 5, 4, 0}, {5, 4, 10, 4, 0}}}};
    shapes.push_back(ball_of_cones(3.0, 20, 1.5707));
    shapes.back().elements.push_back({3.0, 3.0, 12.0, 3.0, 0.0});
    std::mt19937 rng(3);
    const auto within = [&](double reach) {
        return std::uniform_real_distribution<double>(-reach, reach)(rng);
    };
    for (const RevolvedProfile& shape : shapes) {
        const auto cutter = std::make_shared<const Cutter>(make_cutter(shape, 0.0));
        for (int round = 0; round < 40; ++round) {
            const double low = within(5.0) + 5.0;
            const Solid sheet{SolidBox{{{-6, -6, low}, {6, 6, low + 0.6}}}, 0.0};
            CutModel model = *make_cut_model(sheet, 0.4);
            const CutModel raw = model;
            const Vec3 from(within(1), within(1), within(1));
            const Vec3 by = round % 4 == 0 ? Vec3(0.0) : Vec3(within(1), within(1), within(1));
            const CutterSweep sweep{cutter, from, from + by};
            cut(model, sweep);
            const Interval off = differences_after(model, raw, sweep);
            EXPECT_GT(off.lower, -1e-7) << round;
            EXPECT_LT(off.upper, 2e-6) << round;
        }
    }
}

TEST(LaneSlope, MeetsBallsOnNearlyVerticalMovesAsLineByLine) {
    const RevolvedProfile ball{{{3, 0, 3, 0, 3}}};
    const auto cutter = std::make_shared<const Cutter>(make_cutter(ball, 0.0));
    std::mt19937 rng(9);
    const auto within = [&](double reach) {
        return std::uniform_real_distribution<double>(-reach, reach)(rng);
    };
    int met = 0;
    for (int round = 0; round < 2000; ++round) {
        const double drift = std::ldexp(1.0, -static_cast<int>(rng() % 30));
        const Vec3 from(within(2), within(2), within(2));
        const CutterSweep sweep{cutter, from,
                                from + Vec3(drift * within(1), drift * within(1), within(10))};
        std::array<double, CornerStretches::size> u;
        for (double& position : u) position = from.x + within(3.2);
        std::sort(u.begin(), u.end());
        const double v = from.y + within(3.2);
        CornerStretches found;
        lane_cut().stretches(lane_plan(ball, sweep, 2), u.data(), v, 0xffffff, found);
        for (size_t i = 0; i < u.size(); ++i) {
            if (!(found.lower[i] < found.upper[i])) continue;
            // Some point of the move has the line inside the ball, up to a shift of 1e-12 mm.
            const double shift = u[i] < from.x ? 1e-12 : -1e-12;
            const auto truth = line_interval(ball, sweep, 2, u[i] + shift, v);
            ASSERT_TRUE(truth) << round;
            ++met;
            EXPECT_GT(found.lower[i], truth->lower - 1e-8) << round << " " << drift;
            EXPECT_LT(found.upper[i], truth->upper + 1e-8) << round << " " << drift;
        }
    }
    EXPECT_GT(met, 10'000);
}

TEST(LaneSlope, FindsTheEndsWhereAFirstGuessIsAtTheEdgeOfTheCircle) {
    constexpr double r = 0.32322775965981465, m = 0.037915565131352962;
    const RevolvedProfile disc{{{m, r, m, r, m}}};
    const auto cutter = std::make_shared<const Cutter>(make_cutter(disc, 0.0));
    const CutterSweep sweep{cutter,
                            {-0.13620420886192397, 1.2547209504453845, 1.988957178051419},
                            {2.7615482787691676, 1.2547209504453845, -3.6641583338149797}};
    std::array<double, CornerStretches::size> u;
    u.fill(-2.4368494403879661);
    CornerStretches found;
    lane_cut().stretches(lane_plan(disc, sweep, 1), u.data(), 1.7907291975555601, 0xffffff, found);
    EXPECT_NEAR(found.lower[0], 1.197036303, 1e-6);
    EXPECT_NEAR(found.upper[0], 1.312405598, 1e-6);
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
