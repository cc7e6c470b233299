#include <random>

#include <gtest/gtest.h>

#include "core/motion/path.h"
#include "core/sim/run/simulator.h"
#include "core/sim/setup.h"
#include "core/sim/tool_assembly.h"

namespace core {
namespace {

constexpr AxisSet every_axis = 0xffff;

ToolDescription end_mill() {
    ToolDescription tool;
    tool.number = ToolNumber{1};
    tool.diameter = 10;
    tool.flute_length = 20;
    tool.shank = {{10, 10, 25}};
    tool.holder = {{40, 40, 50}};
    return tool;
}

Fixture block_of(const Aabb& box) {
    Fixture fixture;
    fixture.name = "block";
    fixture.body = convex(box);
    return fixture;
}

/// A plate of 100 x 100 x 30 with its top at Z 0, in the machine frame.
Setup plate() {
    Setup setup;
    setup.stock = {SolidBox{{{0, 0, -30}, {100, 100, 0}}}, 0.0};
    const ToolDescription tool = end_mill();
    setup.tools.emplace(tool.number, *assemble(tool));
    return setup;
}

/// A move of the tip as programmed.
struct Move {
    MotionKind kind = MotionKind::rapid;
    Vec3 to = Vec3(0.0); // where it ends after a probing move to its end
    AxisSet settles = every_axis;
    bool probes = false;
    bool turns = false;  // half a turn in X and Y instead of a line
    bool leaves = false; // probes until the contact is lost
};

/// A run of the tool from a tip position. After a probing move that stopped early, moves are
/// displaced by as much along the axes that they do not position.
struct Shop {
    const Setup& setup;
    SimulatorState state;
    Vec3 tip;
    Vec3 off = Vec3(0.0); // of the machine from the programmed tip
    uint32_t block = 0;

    Shop(const Setup& with, const Vec3& at, SpindleDirection spindle = SpindleDirection::stopped)
        : setup(with), state(*start_of_run(with, {})), tip(at) {
        state.position = machine(at);
        give(ToolChange{ToolNumber{1}});
        give(SpindleChange{spindle, spindle == SpindleDirection::stopped ? 0.0 : 6000.0});
    }

    AxisPosition machine(const Vec3& at) const {
        AxisPosition position;
        position.fill(0.0);
        for (int i = 0; i < 3; ++i) position[static_cast<size_t>(i)] = at[i];
        *position[2] += setup.tools.at(ToolNumber{1}).length;
        return position;
    }

    BlockResult give(const Event& event) {
        return run_block(setup, {BlockIndex{block++}, false, {&event, 1}}, state);
    }

    /// Runs a move; a probing move stops at this fraction of its way, as a plain feed.
    BlockResult move(const Move& what, std::optional<double> stop = {}) {
        Motion motion{.kind = what.kind, .from = machine(tip + off)};
        motion.feed = what.kind == MotionKind::rapid ? 0.0 : 600.0;
        motion.settles = what.settles;
        motion.stops_at_contact = what.probes && !stop;
        motion.leaves_contact = what.leaves && !stop;
        const Vec3 from = tip + off;
        for (int i = 0; i < 3; ++i)
            if (what.settles >> i & 1U) off[i] = 0.0;
        if (what.probes && stop) off = from + *stop * (what.to + off - from) - what.to;
        motion.to = machine(what.to + off);
        if (what.turns) {
            motion.kind = MotionKind::arc;
            motion.arc = ArcPath{.centre = 0.5 * (tip + what.to), .angle = 3.141592653589793};
        }
        tip = what.to;
        return give(motion);
    }
};

Move probe(const Vec3& to, AxisSet settles = every_axis) {
    return {MotionKind::feed, to, settles, true};
}

TEST(Probing, ContactOfTheTipIsIntended) {
    const core::Setup setup = plate();
    Shop shop(setup, {50, 50, 20});
    const BlockResult down = shop.move(probe({50, 50, -10}));
    EXPECT_EQ(down.verdict, Verdict::clear);
    EXPECT_TRUE(down.findings.empty());
    EXPECT_EQ(down.removed, 0.0);
    // From the start down to the contact, 10 mm above the end.
    EXPECT_NEAR(shop.state.spread.above[2], 30.0, 1e-9);
    EXPECT_NEAR(shop.state.spread.below[2], -10.0, 0.1);
}

/// Deeper in the stock, the contact is never lost.
TEST(Probing, LeavesAContactOnlyOutOfTheStock) {
    const core::Setup setup = plate();
    const auto verdict_of = [&](const Vec3& start, const Vec3& to) {
        Shop shop(setup, start);
        Move away = probe(to);
        away.leaves = true;
        return shop.move(away).verdict;
    };
    EXPECT_EQ(verdict_of({50, 50, 0}, {50, 50, 3}), Verdict::clear);
    EXPECT_EQ(verdict_of({50, 50, -0.5}, {50, 50, 3}), Verdict::clear); // it is bent
    EXPECT_EQ(verdict_of({50, 50, 0}, {50, 50, -15}), Verdict::collision);
    EXPECT_EQ(verdict_of({50, 50, 5}, {50, 50, -15}), Verdict::collision);
    EXPECT_EQ(verdict_of({-5, 50, -10}, {-9, 50, -10}), Verdict::clear);
    EXPECT_EQ(verdict_of({-5, 50, -10}, {9, 50, -10}), Verdict::collision);
    // After probing down, from the whole range in which that has ended.
    Shop shop(setup, {50, 50, 2});
    shop.move(probe({50, 50, -3}));
    Move up = probe({50, 50, 6});
    up.leaves = true;
    EXPECT_EQ(shop.move(up).verdict, Verdict::clear);
    shop.move({MotionKind::rapid, {50, 50, 2}});
    shop.move(probe({50, 50, -3}));
    Move down = probe({50, 50, -20});
    down.leaves = true;
    EXPECT_EQ(shop.move(down).verdict, Verdict::collision);
}

/// The way to its end counts, also from a range along another axis.
TEST(Probing, LeavesAContactWithoutRunningIntoAFixture) {
    core::Setup setup = plate();
    setup.fixtures.push_back(block_of({{160, 40, -30}, {180, 60, 60}}));
    for (const bool has_probed : {false, true}) {
        Shop shop(setup, {130, 50, 20});
        if (has_probed) shop.move(probe({130, 50, 10}));
        Move away = probe({200, 50, has_probed ? 10.0 : 20.0}, 0);
        away.leaves = true;
        EXPECT_NE(shop.move(away).verdict, Verdict::clear) << has_probed;
    }
}

TEST(Probing, KeepsTheErrorOfAPath) {
    Motion motion{.kind = MotionKind::feed, .path_error = 0.25, .turn_error = 0.01, .feed = 100.0};
    motion.from.fill(0.0);
    motion.to.fill(0.0);
    motion.to[0] = 10.0;
    AxisSpread spread;
    spread.above[2] = 3.0;
    const Path path = path_of(motion, spread, spread, Machine(), 0.01);
    ASSERT_EQ(path.legs.size(), 1U);
    EXPECT_EQ(path.legs[0].path_error, 0.25);
    EXPECT_EQ(path.legs[0].turn_error, 0.01);
}

/// At a corner, both motions are one hull.
TEST(Probing, RoundsCornersBetweenRanges) {
    const core::Setup setup = plate();
    for (const MotionKind kind : {MotionKind::rapid, MotionKind::feed}) {
        Shop shop(setup, {110, 50, 50});
        PathModeChange mode;
        mode.blending = Blending::continuous;
        mode.tolerance = 0.5;
        mode.rapids_keep_speed = true;
        shop.give(mode);
        shop.move(probe({120, 60, 20}));
        EXPECT_EQ(shop.move({kind, {120, 60, 30}, 0}).verdict, Verdict::clear);
        EXPECT_EQ(shop.move({kind, {140, 60, 31}, 0}).verdict, Verdict::clear);
        EXPECT_NE(shop.move({kind, {50, 60, -2}, 0}).verdict, Verdict::clear);
    }
}

/// The positions along three axes are the corners of a box, twice.
TEST(Probing, FollowsARangeAlongThreeAxes) {
    for (const double x : {150.0, 200.0}) {
        core::Setup setup = plate();
        setup.fixtures.push_back(block_of({{170, 40, -30}, {180, 60, 60}}));
        Shop shop(setup, {110, 50, 50});
        EXPECT_EQ(shop.move(probe({120, 60, 20})).verdict, Verdict::clear);
        const BlockResult incremental = shop.move({MotionKind::feed, {x, 70, 30}, 0});
        EXPECT_EQ(incremental.verdict == Verdict::clear, x == 150.0);
    }
}

TEST(Probing, GoesToItsEndWithoutContact) {
    const core::Setup setup = plate();
    Shop shop(setup, {50, 50, 20});
    EXPECT_EQ(shop.move(probe({50, 50, 5})).verdict, Verdict::clear);
    EXPECT_EQ(shop.state.spread.below[2], 0.0);
    EXPECT_EQ(shop.state.spread.above[2], 15.0);
}

TEST(Probing, AHolderThatCollidesBeforeTheContactIsACollision) {
    core::Setup setup = plate();
    // The holder is 20 wide on either side, 45 above the tip.
    setup.fixtures.push_back(block_of({{60, 40, 0}, {90, 60, 60}}));
    Shop shop(setup, {50, 50, 20});
    const BlockResult down = shop.move(probe({50, 50, -10}));
    EXPECT_EQ(down.verdict, Verdict::collision);
    ASSERT_FALSE(down.findings.empty());
    EXPECT_EQ(down.findings[0].rule, "holder-into-wall");
}

TEST(Probing, WhatCouldOnlyHappenBehindTheContactDoesNotHappen) {
    core::Setup setup = plate();
    // The holder would reach it 3 mm below the contact.
    setup.fixtures.push_back(block_of({{60, 40, 0}, {90, 60, 42}}));
    setup.allowance = 0.5;
    Shop shop(setup, {50, 50, 20});
    EXPECT_EQ(shop.move(probe({50, 50, -10})).verdict, Verdict::clear);
}

TEST(Probing, HarmlessRetractsAreClear) {
    const core::Setup setup = plate();
    { // to a stated height
        Shop shop(setup, {50, 50, 20});
        shop.move(probe({50, 50, -10}));
        EXPECT_EQ(shop.move({MotionKind::rapid, {50, 50, 60}}).verdict, Verdict::clear);
        EXPECT_TRUE(shop.state.spread.none());
        EXPECT_EQ(shop.move({MotionKind::rapid, {-50, 50, 60}}).verdict, Verdict::clear);
    }
    { // first by 5, then across, then to a stated height
        Shop shop(setup, {50, 50, 20});
        shop.move(probe({50, 50, -10}));
        EXPECT_EQ(shop.move({MotionKind::rapid, {50, 50, -5}, 3}).verdict, Verdict::clear);
        EXPECT_EQ(shop.move({MotionKind::rapid, {80, 50, -5}, 3}).verdict, Verdict::clear);
        EXPECT_EQ(shop.move({MotionKind::rapid, {80, 50, 60}}).verdict, Verdict::clear);
    }
    { // two touches
        Shop shop(setup, {50, 50, 20});
        shop.move(probe({50, 50, -10}));
        EXPECT_EQ(shop.move({MotionKind::rapid, {50, 50, -8}, 3}).verdict, Verdict::clear);
        EXPECT_EQ(shop.move(probe({50, 50, -12}, 3)).verdict, Verdict::clear);
        EXPECT_EQ(shop.move({MotionKind::rapid, {50, 50, -7}, 3}).verdict, Verdict::clear);
        EXPECT_EQ(shop.move({MotionKind::rapid, {50, 50, 60}}).verdict, Verdict::clear);
    }
    { // against a side
        Shop shop(setup, {-30, 50, -10});
        shop.move(probe({20, 50, -10}));
        EXPECT_EQ(shop.move({MotionKind::rapid, {17, 50, -10}, 6}).verdict, Verdict::clear);
        EXPECT_EQ(shop.move({MotionKind::rapid, {17, 50, 60}, 6}).verdict, Verdict::clear);
        EXPECT_EQ(shop.move({MotionKind::rapid, {50, 50, 60}}).verdict, Verdict::clear);
    }
}

TEST(Probing, ALowPassAfterAnIncrementalRetractIsUndecided) {
    core::Setup setup = plate();
    setup.fixtures.push_back(block_of({{70, 40, 0}, {90, 60, 12}}));
    Shop shop(setup, {50, 50, 20});
    shop.move(probe({50, 50, -10}));
    EXPECT_EQ(shop.move({MotionKind::rapid, {50, 50, -5}, 3}).verdict, Verdict::clear);
    const BlockResult across = shop.move({MotionKind::rapid, {95, 50, -5}, 3});
    EXPECT_EQ(across.verdict, Verdict::undecided);
    ASSERT_FALSE(across.findings.empty());
    EXPECT_NE(across.findings[0].message.find("probing move"), std::string::npos);
}

TEST(Probing, LimitsHoldForTheWholeRange) {
    core::Setup setup = plate();
    setup.machine.axes[2].max = 20.0 + setup.tools.at(ToolNumber{1}).length;
    const auto findings_of = [&](const Move& retract) {
        Shop shop(setup, {50, 50, 15});
        EXPECT_TRUE(shop.move(probe({50, 50, -10})).findings.empty());
        return shop.move(retract).findings;
    };
    // If the probe triggers at once, Z ends at 19, or at 25.
    EXPECT_TRUE(findings_of({MotionKind::rapid, {50, 50, -6}, 3}).empty());
    const std::vector<Finding> beyond = findings_of({MotionKind::rapid, {50, 50, 0}, 3});
    ASSERT_EQ(beyond.size(), 1);
    EXPECT_EQ(beyond[0].rule, "over-travel");
    EXPECT_TRUE(findings_of({MotionKind::rapid, {50, 50, 20}}).empty());
}

TEST(Probing, WhatAFeedMayHaveCutIsNoLongerCertain) {
    const core::Setup setup = plate();
    Shop shop(setup, {50, 50, 20}, SpindleDirection::clockwise);
    shop.move(probe({50, 50, 5}));
    EXPECT_EQ(shop.move({MotionKind::feed, {50, 50, -5}, 3}).verdict, Verdict::undecided);
    EXPECT_TRUE(shop.state.certain_stock);
    EXPECT_EQ(shop.state.stock.log.size(), 0);
}

TEST(Probing, AProgramWithoutProbingIsUnchanged) {
    const core::Setup setup = plate();
    Shop plain(setup, {50, 50, 20}), marked(setup, {50, 50, 20});
    for (const Vec3& to : {Vec3(50, 50, 3), Vec3(120, 50, 3), Vec3(120, 50, -5)}) {
        const BlockResult a = plain.move({MotionKind::rapid, to, 0});
        const BlockResult b = marked.move({MotionKind::rapid, to, every_axis});
        ASSERT_EQ(a.pairs.size(), b.pairs.size());
        for (size_t i = 0; i < a.pairs.size(); ++i) {
            EXPECT_EQ(a.pairs[i].lower, b.pairs[i].lower);
            EXPECT_EQ(a.pairs[i].upper, b.pairs[i].upper);
        }
    }
}

/// A program with probing moves, in a random shop.
struct Scene {
    Setup setup = plate();
    Vec3 start;
    std::vector<Move> moves;
    SpindleDirection spindle = SpindleDirection::stopped;
};

Scene random_scene(std::mt19937& random) {
    const auto from = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    const auto happens = [&](double chance) { return from(0.0, 1.0) < chance; };
    Scene scene;
    scene.setup.mesh_size = 1.0;
    if (happens(0.3)) scene.setup.machine.rapid = RapidStyle::dogleg;
    if (happens(0.3)) scene.spindle = SpindleDirection::clockwise;
    for (int i = 0; i < 3; ++i) {
        const Vec3 low(from(-40, 110), from(-40, 110), 0.0);
        scene.setup.fixtures.push_back(
            block_of({low, low + Vec3(from(5, 30), from(5, 30), from(5, 60))}));
    }
    Vec3 at(from(10, 90), from(10, 90), from(3, 25));
    scene.start = at;
    const auto step = [&](Vec3 by, Move move) {
        at += by;
        move.to = at;
        scene.moves.push_back(move);
    };
    if (happens(0.7))
        step({0, 0, -from(10, 40)}, probe({}));
    else
        step({from(-60, 60), happens(0.3) ? from(-40, 40) : 0.0, 0}, probe({}));
    step({0, 0, from(2, 8)}, {MotionKind::rapid, {}, 3});
    if (happens(0.4)) {
        step({0, 0, -from(4, 12)}, probe({}, happens(0.5) ? 3 : 7));
        step({0, 0, from(2, 8)}, {MotionKind::rapid, {}, 3});
    }
    if (happens(0.2)) step({from(-30, 30), 0, 0}, probe({}, 6));
    for (int i = 0; i < 4; ++i) {
        AxisSet settles = 0;
        for (unsigned axis = 0; axis < 3; ++axis)
            if (happens(0.4)) settles |= static_cast<AxisSet>(1U << axis);
        Move move{happens(0.7) ? MotionKind::rapid : MotionKind::feed, {}, settles};
        if (happens(0.4))
            step({0, 0, from(-20, 50)}, move);
        else
            step({from(-70, 70), from(-70, 70), 0}, move);
    }
    return scene;
}

/// The oracle: probing moves are plain feeds that stop at random fractions of their way. Whatever
/// crashes there must not be clear.
TEST(Probing, IsNeverClearIfAnyStopCrashes) {
    std::mt19937 random(20'31);
    std::uniform_real_distribution<double> fraction(0.0, 1.0);
    size_t crashes = 0, clear = 0;
    for (int round = 0; round < 30; ++round) {
        const Scene scene = random_scene(random);
        Shop range(scene.setup, scene.start, scene.spindle);
        std::vector<Verdict> verdicts;
        for (const Move& move : scene.moves) verdicts.push_back(range.move(move).verdict);
        for (const Verdict verdict : verdicts) clear += verdict == Verdict::clear;
        for (int trial = 0; trial < 6; ++trial) {
            Shop shop(scene.setup, scene.start, scene.spindle);
            for (size_t i = 0; i < scene.moves.size(); ++i) {
                const Move& move = scene.moves[i];
                const BlockResult result =
                    shop.move(move, move.probes ? std::optional(fraction(random)) : std::nullopt);
                if (result.verdict < Verdict::violation) continue;
                const bool at_tip = std::any_of(result.pairs.begin(), result.pairs.end(),
                                                [](const PairClearance& pair) {
                                                    return pair.pair.part == PartKind::flutes
                                                           && pair.verdict >= Verdict::violation;
                                                });
                if (move.probes && at_tip) break; // the probe would have stopped before
                ++crashes;
                EXPECT_NE(verdicts[i], Verdict::clear) << "round " << round << ", move " << i;
                break; // the stock may be damaged from here on
            }
        }
    }
    EXPECT_GT(crashes, 30);
    EXPECT_GT(clear, 60);
}

} // namespace
} // namespace core
