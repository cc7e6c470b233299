#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "core/sim/leg/leg_check.h"
#include "core/sim/setup.h"

namespace core {
namespace {

/// A block of 100 x 100 x 30 with its top at Z 0 and a 10 mm end mill with a 40 mm holder that
/// starts 45 mm above the tip. Machine and stock frame are equal.
Setup block_setup() {
    Setup setup;
    setup.stock = {SolidBox{{{0, 0, -30}, {100, 100, 0}}}, 0.0};
    ToolDescription tool;
    tool.number = ToolNumber{1};
    tool.diameter = 10;
    tool.flute_length = 20;
    tool.shank = {{10, 10, 25}};
    tool.holder = {{40, 40, 50}};
    setup.tools.emplace(tool.number, *assemble(tool));
    return setup;
}

/// The objects that leg checks refer to.
struct Bench {
    Setup setup;
    std::vector<bool> there = std::vector<bool>(setup.fixtures.size(), true);
    CheckMemory memory = {};
    Statistics statistics = {};
    CutModel stock = *make_cut_model(setup.stock, setup.mesh_size);
    LegContext context{setup,
                       setup.tools.at(ToolNumber{1}),
                       FluteUse::cutting,
                       BlockIndex{7},
                       there,
                       memory,
                       statistics,
                       moving_bodies(setup, setup.tools.at(ToolNumber{1}))};
    PairBounds bounds{setup, memory};
    StockProbe probe{context, bounds};
    FluteCut flutes{context};

    /// A leg of the tip that takes one second.
    Leg leg(const Vec3& from, const Vec3& to) const {
        const double length = context.tool.length;
        const AxisValues a{from.x, from.y, from.z + length}, b{to.x, to.y, to.z + length};
        return {.positions = {a, b}, .end = 1.0};
    }
};

constexpr Pair flutes_and_stock{PartKind::flutes};
constexpr Pair holder_and_stock{PartKind::holder};

TEST(TrackedPairs, FindsAmongManyWhatWasAdded) {
    std::mt19937 random(20261128);
    for (const size_t fixtures : {1u, 3u, 60u, 400u}) {
        std::vector<Pair> all;
        for (size_t fixture = 0; fixture < fixtures; ++fixture)
            for (const PartKind part : {PartKind::flutes, PartKind::shank, PartKind::holder})
                all.push_back({part, fixture, fixture % 3});
        all.push_back({PartKind::flutes});
        std::shuffle(all.begin(), all.end(), random);
        TrackedPairs pairs;
        for (size_t i = 0; i < all.size(); ++i) {
            EXPECT_EQ(pairs.find(all[i]), nullptr);
            TrackedPair pair;
            pair.pair = all[i];
            pair.at_end = static_cast<double>(i);
            EXPECT_EQ(pairs.add(pair).at_end, pair.at_end);
        }
        const auto expect_all = [&](size_t from) {
            for (size_t i = 0; i < all.size(); ++i) {
                const TrackedPair* found = pairs.find(all[i]);
                ASSERT_EQ(found != nullptr, i >= from);
                if (found) {
                    EXPECT_EQ(found->at_end, static_cast<double>(i));
                }
            }
        };
        expect_all(0);
        pairs.sort();
        EXPECT_TRUE(std::is_sorted(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) {
            return is_before(a.pair, b.pair);
        }));
        EXPECT_FALSE(pairs[0].pair.fixture) << "the stock is first";
        expect_all(0);
        pairs.remove_if([](const TrackedPair& pair) { return pair.at_end < 2.0; });
        expect_all(2);
        const TrackedPairs copy = pairs;
        EXPECT_EQ(copy.find(all.back())->at_end, static_cast<double>(all.size() - 1));
    }
}

TEST(PairBounds, FindsTheBoundsOfManyPairsInAnyOrder) {
    core::Setup setup = block_setup();
    setup.fixtures.resize(60);
    CheckMemory memory;
    for (size_t fixture = 0; fixture < 50; ++fixture)
        memory.bounds.push_back({{PartKind::holder, fixture}, 1.0 + double(fixture), 0.0});
    std::vector<size_t> order(60);
    std::iota(order.begin(), order.end(), size_t{0});
    std::mt19937 random(1128);
    for (int round = 0; round < 5; ++round) {
        PairBounds bounds(setup, memory);
        TrackedPairs pairs;
        for (const size_t fixture : order) {
            const TrackedPair& begun = bounds.tracked_pair(pairs, {PartKind::holder, fixture});
            EXPECT_EQ(begun.at_end, fixture < 50 ? 1.0 + double(fixture) : TrackedPair().at_end);
        }
        std::shuffle(order.begin(), order.end(), random);
    }
}

TEST(PairBounds, CarriesABoundOverLegs) {
    core::Setup setup = block_setup();
    setup.detail = Detail::verdict;
    CheckMemory memory;
    memory.bounds = {{holder_and_stock, 30.0, 0.5}};
    PairBounds bounds(setup, memory);
    TrackedPairs pairs;
    bounds.begin_leg(4.0, true);
    TrackedPair& holder = bounds.tracked_pair(pairs, holder_and_stock);
    EXPECT_EQ(holder.at_end, 30.0);
    EXPECT_TRUE(bounds.can_skip(holder, pairs));
    EXPECT_EQ(holder.at_end, 26.0);
    EXPECT_EQ(holder.lower, 26.0);
    EXPECT_EQ(holder.drift, 4.5);
    bounds.end_leg();
    EXPECT_EQ(memory.bounds[0].apart, 26.0);
    // 26 mm minus 25.5 mm is less than the allowance of 1 mm.
    bounds.begin_leg(25.5, true);
    EXPECT_FALSE(bounds.can_skip(holder, pairs));
    EXPECT_EQ(holder.at_end, 26.0);
    EXPECT_EQ(holder.lower, 26.0);
}

TEST(PairBounds, KnowsTheTravelOfABodyThatTurnsOnlyWhileTheLegGoesOn) {
    const core::Setup setup = block_setup();
    CheckMemory memory;
    PairBounds bounds(setup, memory);
    const RelativeLeg turning{.travel = 0.5, .turns = true};
    const RelativeLeg still{.travel = 0.0};
    // A body at rest somewhere, or on any part of a path, may have come from anywhere.
    EXPECT_EQ(bounds.travel(turning), infinity);
    bounds.begin_leg(infinity, true);
    EXPECT_EQ(bounds.travel(turning), 0.5);
    EXPECT_EQ(bounds.travel(still), infinity);
    bounds.end_leg();
    EXPECT_EQ(bounds.travel(turning), infinity);
    bounds.begin_leg(infinity, false); // the hull of unknown paths
    EXPECT_EQ(bounds.travel(turning), infinity);
    bounds.begin_leg(4.0, true);
    EXPECT_EQ(bounds.travel(turning), 4.0);
}

TEST(PairBounds, SkipsOnlyPairsThatCannotDecide) {
    core::Setup setup = block_setup();
    CheckMemory memory;
    const Allowance allowance{1.0, 0.0};
    TrackedPair flutes;
    flutes.upper = 5.0; // with an allowance of 0: the margin is 5
    const TrackedPairs pairs = {flutes};
    const PairBounds bounds(setup, memory);
    setup.detail = Detail::every_pair;
    EXPECT_FALSE(bounds.cannot_decide(allowance, 40.0, pairs));
    setup.detail = Detail::deciding_pair;
    EXPECT_TRUE(bounds.cannot_decide(allowance, 6.1, pairs));
    EXPECT_FALSE(bounds.cannot_decide(allowance, 5.9, pairs));
    setup.detail = Detail::verdict;
    EXPECT_TRUE(bounds.cannot_decide(allowance, 1.1, pairs));
    EXPECT_FALSE(bounds.cannot_decide(allowance, 1.0, pairs));
    memory.off_path = 0.2; // of rounded corners
    EXPECT_FALSE(bounds.cannot_decide(allowance, 1.1, pairs));
}

TEST(PairBounds, AMeasurementReplacesTheBound) {
    TrackedPair known;
    known.lower = known.upper = 3.0;
    known.at_end = 12.0;
    known.drift = 2.0;
    PairClearance later;
    later.lower = 8.0;
    later.upper = 8.5;
    merge(known, later);
    EXPECT_EQ(known.lower, 3.0); // of the block
    EXPECT_EQ(known.upper, 3.0);
    EXPECT_EQ(known.at_end, 8.0);
    EXPECT_EQ(known.drift, 0.0);
}

TEST(StockProbe, BoundsTheDistanceToTheStock) {
    Bench bench{block_setup()};
    const Leg over = bench.leg({20, 20, 10}, {80, 20, 10});
    const MovingBody& flutes = bench.context.body_of(flutes_and_stock);
    const StockObservation seen = bench.probe.observe(flutes, over, bench.stock, infinity);
    const PairClearance pair = bench.probe.clearance(flutes, over, 0.0, seen, seen);
    EXPECT_EQ(pair.verdict, Verdict::clear);
    EXPECT_NEAR(pair.lower, 10.0, 1e-6);
    EXPECT_NEAR(pair.upper, 10.0, 1e-6);
    const auto have_room = [&](const Leg& leg, double room) {
        const RelativeLeg& way = bench.context.against_stock(flutes, leg);
        return bench.context.stays_apart(*flutes.profile, way, bench.stock, room);
    };
    EXPECT_TRUE(have_room(over, 9.999));
    EXPECT_FALSE(have_room(over, 10.001));
    // Room that is just proven counts, however the error of a chord is rounded.
    Leg chord = over;
    for (int i = 1; i < 50; ++i) {
        chord.path_error = 1e-4 * i;
        EXPECT_TRUE(have_room(chord, 0.5)) << i;
    }
}

TEST(StockProbe, FindsTheFirstMomentOfAnOverlap) {
    Bench bench{block_setup()};
    const Leg through = bench.leg({-50, 50, -10}, {50, 50, -10});
    const PairClearance pair{.pair = flutes_and_stock, .lower = 0.0};
    // The flutes, 10 mm wide, reach the face at X 0 when the tip is at X -5.
    EXPECT_NEAR(bench.probe.earliest(through, pair, 0.0, bench.stock), 0.45, 1e-4);
    EXPECT_NEAR(bench.probe.earliest(through, pair, 10.0, bench.stock), 0.35, 1e-4);
}

TEST(StockProbe, FindsTheFirstOfManyMomentsThatAreEquallyNear) {
    Bench bench{block_setup()};
    const Leg over = bench.leg({-50, 50, 10}, {150, 50, 10});
    // The flutes, 10 mm wide, come over the first scan line, at X 0.25, when the tip is at X -4.75.
    const PairClearance pair{
        .pair = flutes_and_stock, .lower = 9.99, .on_body = Vec3(70.0, 50.0, 0.0)};
    for (const std::optional<double> seen : {std::optional<double>(), {0.6}, {0.25}})
        EXPECT_NEAR(bench.probe.earliest(over, pair, 10.0, bench.stock, seen), 0.22625, 2e-4);
    EXPECT_EQ(bench.probe.earliest(over, pair, 10.0, bench.stock, 0.1), 0.1);
}

TEST(StockProbe, FindsTheFirstMomentBesideAWallThatOnlyLinesAcrossItShow) {
    Bench bench{block_setup()};
    const Leg down = bench.leg({-9, 50, 5}, {-9, 50, -18});
    const MovingBody& flutes = bench.context.body_of(flutes_and_stock);
    const StockObservation seen = bench.probe.observe(flutes, down, bench.stock, infinity);
    const PairClearance pair = bench.probe.clearance(flutes, down, 0.0, seen, seen);
    EXPECT_NEAR(pair.upper, 4.0, 0.01); // to a line along X, of which the first is at Z -0.25
    for (const double at : {0.9, 0.6, pair.time})
        EXPECT_NEAR(bench.probe.earliest(down, pair, pair.upper, bench.stock, at), 5.25 / 23, 3e-4);
}

TEST(StockProbe, FindsTheMomentOfAToolThatIsNotUprightInTheFrameOfTheStock) {
    core::Setup setup = block_setup();
    setup.stock_mount.link_from_body.rotation =
        rotation_xyz_deg({90, 0, 0}); // Y up, Z to the front
    Bench bench{setup};
    // Beside the edge along X, towards the end of that edge: nearest at the end.
    const Leg towards = bench.leg({-19.75, -8, 103}, {0.25, -8, 103});
    const MovingBody& flutes = bench.context.body_of(flutes_and_stock);
    const StockObservation seen = bench.probe.observe(flutes, towards, bench.stock, infinity);
    const PairClearance pair = bench.probe.clearance(flutes, towards, 0.0, seen, seen);
    EXPECT_NEAR(pair.upper, std::hypot(3.0, 3.25), 1e-6);
    EXPECT_NEAR(bench.probe.earliest(towards, pair, pair.upper, bench.stock, pair.time), 1.0, 1e-3);
}

TEST(FluteCut, RemovesWhatTheFlutesSweep) {
    Bench bench{block_setup()};
    const Leg slot = bench.leg({-20, 50, -4}, {120, 50, -4});
    EXPECT_NEAR(bench.flutes.along(slot, bench.stock), 100.0 * 10.0 * 4.0, 40.0);
    EXPECT_EQ(bench.flutes.along(slot, bench.stock), 0.0);
    EXPECT_EQ(bench.statistics.sweeps, 2u);
    EXPECT_EQ(bench.memory.cutters.size(), 1u); // computed once
    EXPECT_EQ(bench.stock.log.block(0), 7u);
}

TEST(FluteCut, KnowsItsOwnCutInAnExpendableFixture) {
    core::Setup setup = block_setup();
    setup.fixtures.push_back(
        {"tab", posed(convex(ProfileElement{-30, 5, 12, 5, 0}), translation({150, 50, 0})), true});
    Bench bench{setup};
    const Leg cut = bench.leg({130, 50, 2}, {150, 50, 2});
    const Leg back = bench.leg({150, 50, 2}, {130, 50, 2});
    const Leg beside = bench.leg({150, 50, 2}, {150, 60, 2});
    EXPECT_FALSE(bench.flutes.is_in_own_cut(back, 0));
    bench.flutes.note_cut(cut, 0);
    EXPECT_TRUE(bench.flutes.is_in_own_cut(back, 0));
    EXPECT_FALSE(bench.flutes.is_in_own_cut(beside, 0));
    bench.memory.off_path = 0.1; // rounded corners may have left material
    EXPECT_FALSE(bench.flutes.is_in_own_cut(back, 0));
}

TEST(FixtureCheck, MeasuresFixturesThatAreThere) {
    core::Setup setup = block_setup();
    for (const double x : {150.0, 200.0})
        setup.fixtures.push_back(
            {"post", posed(convex(ProfileElement{-30, 5, 12, 5, 0}), translation({x, 50, 0})),
             false});
    Bench bench{setup};
    bench.there[1] = false;
    FixtureCheck check(bench.context, bench.bounds, bench.flutes);
    TrackedPairs pairs;
    check.check(bench.leg({130, 20, 2}, {130, 80, 2}), 3.0, pairs);
    check.resolve_doubts(pairs);
    for (const TrackedPair& pair : pairs) {
        EXPECT_EQ(pair.pair.fixture, 0u);
        EXPECT_EQ(pair.verdict, Verdict::clear);
    }
    const TrackedPair& flutes = entry(pairs, {PartKind::flutes, 0}, setup);
    EXPECT_NEAR(flutes.upper, 20.0 - 5.0 - 5.0, 1e-6);
    EXPECT_NEAR(flutes.time, 3.5, 1e-3);
    EXPECT_EQ(flutes.at_end, flutes.lower);
}

TEST(StockProbe, SaysWhetherABodyIsClearAsAnObservationDoesWithLessWork) {
    Bench bench{block_setup()};
    const auto chord = [&](int k, double z) {
        const auto corner = [&](int i) {
            const double angle = 0.25 * i;
            return Vec3(50.0 + 20.0 * std::cos(angle), 50.0 + 20.0 * std::sin(angle), z);
        };
        return bench.leg(corner(k), corner(k + 1));
    };
    constexpr int chords = 12;
    for (int k = 0; k < chords; ++k) bench.flutes.along(chord(k, -25.0), bench.stock);
    // At Z-25 the shank rubs along the wall; at Z-28 it is 3 mm deep in the floor; at Z-43.5 the
    // holder is still clear, at Z-44.5 not.
    Statistics observed, asked;
    size_t clear = 0, questions = 0;
    for (int k = 0; k < chords; ++k)
        for (const double z : {-10.0, -25.0, -28.0, -43.5, -44.5, -60.0}) {
            const Leg leg = chord(k, z);
            for (const MovingBody& body : bench.context.bodies) {
                bench.statistics = {};
                const StockObservation seen = bench.probe.observe(body, leg, bench.stock, 50.0);
                const Verdict verdict = bench.probe.clearance(body, leg, 0.0, seen, seen).verdict;
                observed.box_tests += bench.statistics.box_tests;
                observed.refined += bench.statistics.refined;
                bench.statistics = {};
                const bool is_clear = bench.probe.is_clear(body, leg, bench.stock);
                asked.box_tests += bench.statistics.box_tests;
                asked.refined += bench.statistics.refined;
                if (body.kind != PartKind::flutes)
                    EXPECT_EQ(is_clear, verdict == Verdict::clear) << k << " " << z;
                else // an observation also knows where the flutes have been
                    EXPECT_LE(is_clear, verdict == Verdict::clear) << k << " " << z;
                clear += is_clear;
                ++questions;
            }
        }
    EXPECT_GE(clear, questions / 4);
    EXPECT_LE(clear, questions * 3 / 4);
    EXPECT_LT(2 * asked.box_tests, observed.box_tests);
    EXPECT_LE(asked.refined, observed.refined);
}

} // namespace
} // namespace core
