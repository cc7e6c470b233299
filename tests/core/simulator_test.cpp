#include <algorithm>

#include <gtest/gtest.h>

#include "core/sim/run/simulator.h"
#include "core/sim/setup.h"
#include "core/sim/tool_assembly.h"

namespace core {
namespace {

/// A block of 100 x 100 x 30 with its top at Z 0, in the machine frame, and a 10 mm end mill, 95 mm
/// long: flutes 0-20, shank 20-45, 40 mm holder 45-95 above the tip.
Setup plain_setup(double shank_diameter = 10.0) {
    Setup setup;
    setup.stock = {SolidBox{{{0, 0, -30}, {100, 100, 0}}}, 0.0};
    ToolDescription tool;
    tool.number = ToolNumber{1};
    tool.diameter = 10;
    tool.flute_length = 20;
    tool.shank = {{shank_diameter, shank_diameter, 25}};
    tool.holder = {{40, 40, 50}};
    setup.tools.emplace(tool.number, *assemble(tool));
    return setup;
}

/// A run of one tool; positions are those of the tip.
struct Shift {
    Setup setup;
    SimulatorState state;
    uint32_t block = 0;
    Vec3 tip = Vec3(0, 0, 100);

    explicit Shift(Setup with) : setup(std::move(with)), state(*start_of_run(setup, {})) {
        give({ToolChange{ToolNumber{1}}});
        turn(SpindleDirection::clockwise);
    }

    BlockResult give(const std::vector<Event>& events) {
        return run_block(setup, {BlockIndex{block++}, false, events}, state);
    }
    void turn(SpindleDirection direction) { give({SpindleChange{direction, 6000.0}}); }

    Motion motion(MotionKind kind, const Vec3& to) {
        const double length = setup.tools.at(ToolNumber{1}).length;
        Motion m{.kind = kind,
                 .from = {tip.x, tip.y, tip.z + length},
                 .to = {to.x, to.y, to.z + length},
                 .feed = kind == MotionKind::rapid ? 0.0 : 600.0};
        tip = to;
        return m;
    }
    BlockResult rapid(const Vec3& to) { return give({motion(MotionKind::rapid, to)}); }
    BlockResult feed(const Vec3& to) { return give({motion(MotionKind::feed, to)}); }
    BlockResult circle(const Vec3& centre, const Vec3& to) {
        Motion m = motion(MotionKind::arc, to);
        m.arc = ArcPath{2, centre, 6.283185307179586};
        return give({m});
    }
};

const PairClearance* pair_of(const BlockResult& result, PartKind part,
                             std::optional<size_t> fixture = {}) {
    for (const PairClearance& pair : result.pairs)
        if (pair.pair == Pair{part, fixture}) return &pair;
    return nullptr;
}

std::vector<std::string> rules(const BlockResult& result) {
    std::vector<std::string> names;
    for (const Finding& finding : result.findings) names.push_back(finding.rule);
    return names;
}

AxisPosition z_only(double z) { return {std::nullopt, std::nullopt, z}; }

using Rules = std::vector<std::string>;

TEST(Simulator, MeasuresTheShankOverItsOwnSlot) {
    Shift run(plain_setup());
    run.rapid({-20, 50, 60});
    run.rapid({-20, 50, -5});
    const BlockResult slot = run.feed({120, 50, -5});
    EXPECT_EQ(slot.verdict, Verdict::clear);
    EXPECT_NEAR(slot.removed, 5000.0, 1e-6);
    const PairClearance* shank = pair_of(slot, PartKind::shank);
    ASSERT_TRUE(shank);
    EXPECT_LE(shank->lower, 15.0);
    EXPECT_GE(shank->upper, 15.0 - 1e-9);
    EXPECT_NEAR(shank->upper, 15.0, 0.5);
}

TEST(Simulator, IsSilentWhenItRetractsAlongTheWallItCut) {
    Shift run(plain_setup());
    run.rapid({-20, 50.1, -5});
    run.feed({47.3, 50.1, -5});
    const BlockResult up = run.rapid({47.3, 50.1, 30});
    EXPECT_EQ(up.verdict, Verdict::clear) << (up.findings.empty() ? "" : up.findings[0].message);
    EXPECT_EQ(up.removed, 0.0);
}

TEST(Simulator, IsSilentForAShankOfTheFlutesDiameterInItsOwnHole) {
    Shift run(plain_setup());
    run.rapid({50.1, 50.2, 5});
    BlockResult down = run.feed({50.1, 50.2, -28});
    EXPECT_EQ(down.verdict, Verdict::clear)
        << (down.findings.empty() ? "" : down.findings[0].message);
    const BlockResult up = run.rapid({50.1, 50.2, 5});
    EXPECT_EQ(up.verdict, Verdict::clear) << (up.findings.empty() ? "" : up.findings[0].message);
}

TEST(Simulator, FindsAShankThatIsWiderThanTheFlutesInTheirHole) {
    Shift run(plain_setup(12.0));
    run.rapid({50.1, 50.2, 5});
    const BlockResult down = run.feed({50.1, 50.2, -25});
    EXPECT_EQ(down.verdict, Verdict::collision);
    EXPECT_EQ(rules(down), Rules({"collision"}));
}

TEST(Simulator, FindsARapidThroughTheStockAndCutsItSoThatItIsFoundOnce) {
    Shift run(plain_setup());
    run.rapid({-20, 50, -3});
    const BlockResult through = run.rapid({120, 50, -3});
    EXPECT_EQ(through.verdict, Verdict::collision);
    EXPECT_EQ(rules(through), Rules({"rapid-in-stock"}));
    EXPECT_NEAR(through.removed, 3000.0, 1e-6);
    EXPECT_EQ(run.rapid({-20, 50, -3}).verdict, Verdict::clear);
}

TEST(Simulator, FindsAFeedWithTheSpindleStopped) {
    Shift run(plain_setup());
    run.rapid({-20, 50, -3});
    run.turn(SpindleDirection::stopped);
    EXPECT_EQ(rules(run.feed({20, 50, -3})), Rules({"spindle-off"}));
    run.turn(SpindleDirection::counterclockwise);
    EXPECT_EQ(rules(run.feed({40, 50, -3})), Rules({"spindle-off"}));
    run.turn(SpindleDirection::clockwise);
    EXPECT_EQ(rules(run.feed({60, 50, -3})), Rules());
}

TEST(Simulator, KeepsTheHolderAwayFromTheStock) {
    Shift run(plain_setup());
    run.rapid({-40, 50, 60});
    // The lower face of the holder is 45 above the tip: at Z-44.5 it is 0.5 above the top of the
    // stock.
    run.rapid({-6, 50, -44.5});
    const BlockResult beside = run.feed({-5.5, 50, -44.5});
    EXPECT_EQ(beside.verdict, Verdict::violation);
    const PairClearance* holder = pair_of(beside, PartKind::holder);
    ASSERT_TRUE(holder);
    EXPECT_NEAR(holder->upper, 0.5, 0.01);
    EXPECT_LE(holder->lower, 0.5);
    EXPECT_EQ(rules(beside), Rules({"near-miss"}));
}

TEST(Simulator, MeasuresAFixtureToRounding) {
    core::Setup setup = plain_setup();
    setup.fixtures.push_back({"post", convex(ProfileElement{-30, 5, 12, 5, 0}), false});
    for (const auto& [tip, expected] :
         {std::pair{Vec3(40, 30, 2.5), 50.0 - 10.0}, std::pair{Vec3(9, 12, 2.5), 15.0 - 10.0}}) {
        Shift run(setup);
        run.rapid(tip + Vec3(0, 0, 60));
        const BlockResult down = run.rapid(tip);
        const PairClearance* flutes = pair_of(down, PartKind::flutes, 0);
        ASSERT_TRUE(flutes);
        EXPECT_NEAR(flutes->lower, expected, 1e-6);
        EXPECT_NEAR(flutes->upper, expected, 1e-6);
    }
}

TEST(Simulator, WidensBoundsByTheDeviationOfAFixture) {
    for (const bool on_arc : {false, true}) {
        core::Setup setup = plain_setup();
        setup.fixtures.push_back({"stud", convex(Aabb{{120, 40, -30}, {130, 60, 40}})});
        const auto clearance = [&](double deviation) {
            setup.fixtures[0].deviation = deviation;
            Shift run(setup);
            run.rapid({110, 50, 50});
            run.rapid({110, 50, 20});
            const BlockResult result =
                on_arc ? run.circle({100, 50, 0}, {110, 50, 20}) : run.rapid({110, 50, 15});
            return *pair_of(result, PartKind::flutes, 0);
        };
        const PairClearance exact = clearance(0.0), wide = clearance(0.25);
        EXPECT_NEAR(exact.upper, 5.0, 2e-3);
        EXPECT_LE(wide.lower, exact.lower - 0.25 + 1e-9);
        EXPECT_GE(wide.lower, exact.lower - 0.25 - 0.01);
        EXPECT_GE(wide.upper, exact.upper + 0.25 - 2e-3);
        EXPECT_EQ(wide.verdict, Verdict::clear);
        EXPECT_EQ(clearance(3.5).verdict, Verdict::undecided); // the minimum clearance is 2
    }
}

TEST(Simulator, FindsThatAMachineBodyCollidesInSpiteOfDeviations) {
    for (const double of_body : {0.0, 0.1})
        for (const double of_fixture : {0.0, 0.1}) {
            core::Setup setup = plain_setup();
            const double gauge = setup.tools.at(ToolNumber{1}).length;
            MachineBody head{.name = "head",
                             .body = convex(Aabb{{-40, -40, 0}, {40, 40, 60}}),
                             .deviation = of_body};
            head.link = setup.machine.spindle;
            setup.machine.bodies.push_back(head);
            setup.fixtures.push_back({"post", convex(Aabb{{120, 40, -30}, {130, 60, gauge + 3}})});
            setup.fixtures[0].deviation = of_fixture;
            const auto verdict_at = [&](const Vec3& tip, std::optional<size_t> fixture) {
                Shift run(setup);
                run.rapid({110, 50, 50});
                return pair_of(run.rapid(tip), PartKind::machine, fixture)->verdict;
            };
            EXPECT_EQ(verdict_at({110, 50, 1}, 0), Verdict::collision) << of_body << of_fixture;
            EXPECT_EQ(verdict_at({110, 50, 2.95}, 0), Verdict::collision);
            EXPECT_NE(verdict_at({110, 50, 3.05}, 0), Verdict::collision);
            EXPECT_EQ(verdict_at({50, 50, -gauge - 2}, {}), Verdict::collision) << of_body;
            Shift round(setup); // the head meets the post at the far side of the circle
            round.rapid({240, 50, 50});
            round.rapid({240, 50, 1});
            const BlockResult circle = round.circle({190, 50, 0}, {240, 50, 1});
            EXPECT_EQ(pair_of(circle, PartKind::machine, 0)->verdict, Verdict::collision)
                << of_body << of_fixture;
            Shift into_stock(setup);
            into_stock.rapid({250, 50, 50});
            into_stock.rapid({250, 50, -gauge - 2});
            const BlockResult deep = into_stock.circle({170, 50, 0}, {250, 50, -gauge - 2});
            EXPECT_EQ(pair_of(deep, PartKind::machine)->verdict, Verdict::collision) << of_body;
        }
}

TEST(Simulator, WidensBoundsByTheDeviationOfTheStock) {
    core::Setup setup = plain_setup();
    const auto clearance = [&](double deviation) {
        setup.stock.tolerance = setup.stock.deviation = deviation;
        Shift run(setup);
        run.rapid({50, 50, 30});
        return *pair_of(run.rapid({50, 50, 5}), PartKind::flutes);
    };
    const PairClearance exact = clearance(0.0), wide = clearance(0.25);
    EXPECT_LE(wide.lower, exact.upper - 0.25);
    EXPECT_NEAR(wide.upper, exact.upper + 0.25, 1e-6);
}

TEST(Simulator, CoversAWholeCircle) {
    // The post is outside the circle; the closest approach is at neither end of the block.
    core::Setup setup = plain_setup();
    ConvexShape post = convex(ProfileElement{-30, 5, 60, 5, 0});
    setup.fixtures.push_back({"post", posed(post, translation({150.0, 50.0, 0.0})), false});
    Shift run(setup);
    run.rapid({100, 30, 20});
    const BlockResult round = run.circle({100, 50, 0}, {100, 30, 20});
    const PairClearance* flutes = pair_of(round, PartKind::flutes, 0);
    ASSERT_TRUE(flutes);
    const double expected = 50.0 - 20.0 - 5.0 - 5.0; // centres, radius of the path, both radii
    EXPECT_LE(flutes->lower, expected);
    EXPECT_GE(flutes->upper, expected - 1e-9);
    EXPECT_NEAR(flutes->upper, expected, 0.01);
    EXPECT_NEAR(flutes->time / round.duration, 0.25, 0.02);
}

TEST(Simulator, LetsFeedingFlutesCutAnExpendableFixture) {
    core::Setup setup = plain_setup();
    setup.fixtures.push_back(
        {"tab", posed(convex(ProfileElement{-30, 5, 12, 5, 0}), translation({150, 50, 0})), true});
    Shift run(setup);
    run.rapid({130, 50, 2.5});
    EXPECT_EQ(run.feed({146, 50, 2.5}).verdict, Verdict::clear);
    EXPECT_EQ(run.rapid({130, 50, 2.5}).verdict, Verdict::clear); // back along the same path
    EXPECT_EQ(run.rapid({150, 57, 2.5}).verdict, Verdict::collision);
}

TEST(Simulator, LooksAtANewToolWhereItIsChangedIn) {
    core::Setup setup = plain_setup();
    ToolDescription longer = setup.tools.at(ToolNumber{1}).description;
    longer.number = ToolNumber{2};
    longer.shank = {{10, 10, 60}};
    setup.tools.emplace(longer.number, *assemble(longer));
    Shift run(setup);
    run.rapid({50, 50, 30});
    EXPECT_EQ(rules(run.give({ToolChange{ToolNumber{2}}})), Rules({"tool-change-unsafe"}));
}

TEST(Simulator, KeepsTheTimeOfAToolThatIsChangedLaterInTheBlock) {
    core::Setup setup = plain_setup();
    ToolDescription bare = setup.tools.at(ToolNumber{1}).description;
    bare.number = ToolNumber{2};
    bare.holder = {};
    setup.tools.emplace(bare.number, *assemble(bare));
    Shift run(setup);
    run.rapid({200, 50, -30});
    const Motion nearer = run.motion(MotionKind::feed, {130, 50, -30}); // 70 mm at 10 mm/s
    const Motion away = run.motion(MotionKind::feed, {200, 50, -30});
    const BlockResult result = run.give({nearer, ToolChange{ToolNumber{2}}, away});
    ASSERT_TRUE(result.deciding);
    const PairClearance& holder = result.pairs[*result.deciding];
    EXPECT_EQ(holder.pair, Pair{PartKind::holder});
    EXPECT_NEAR(holder.upper, std::hypot(10, 15), 0.2);
    EXPECT_NEAR(holder.time, 7.0, 1e-6);
}

TEST(Simulator, KeepsABallOfConesBelowTheTruth) {
    // Flutes that end on the upper half of the ball divide it, so that it is approximated by cones.
    core::Setup setup = plain_setup();
    ToolDescription ball;
    ball.number = ToolNumber{1};
    ball.shape = ToolShape::ball;
    ball.diameter = 10;
    ball.flute_length = 8;
    setup.tools[ToolNumber{1}] = *assemble(ball);
    Fixture edge;
    edge.body = convex(Aabb{{200, -50, -100}, {300, 50, 0}});
    setup.fixtures.push_back(edge);
    for (double away = 0.05; away < 9.0; away += 0.37) {
        Shift run(setup);
        run.rapid({200 - away, 0, 1.0});
        const BlockResult result = run.rapid({200 - away, 0, 1.0 + 1e-9});
        const PairClearance* pair = pair_of(result, PartKind::flutes, 0);
        ASSERT_TRUE(pair);
        const double truth = std::hypot(away, 6.0) - 5.0;
        EXPECT_LE(pair->lower, truth + 1e-9) << away;
        EXPECT_GE(pair->upper, truth - 1e-9) << away;
        EXPECT_LE(pair->upper - pair->lower, 2.0 * rounding_sag + 1e-6) << away;
    }
}

TEST(Simulator, LeavesNoSkinWhereItCutsAsDeepAsItsFlutesAreLong) {
    core::Setup setup = plain_setup();
    setup.tools.at(ToolNumber{1}) = [] {
        ToolDescription tool;
        tool.number = ToolNumber{1};
        tool.diameter = 10;
        tool.flute_length = 20;
        tool.neck_diameter = 9;
        tool.neck_length = 40;
        return *assemble(tool);
    }();
    Shift run(setup);
    run.rapid({-20, 50, -20});
    EXPECT_EQ(run.feed({50, 50, -20}).verdict, Verdict::clear);
    EXPECT_EQ(run.circle({50, 45, -20}, {50, 50, -20}).verdict, Verdict::clear);
    EXPECT_EQ(run.rapid({50, 50, 10}).verdict, Verdict::clear);
    EXPECT_EQ(run.rapid({50, 48, 10}).verdict, Verdict::clear);
}

TEST(Simulator, CannotJudgeAnUndescribedTool) {
    Shift run(plain_setup());
    EXPECT_EQ(rules(run.give({ToolChange{ToolNumber{9}}})), Rules({"tool-not-in-table"}));
    const BlockResult moved = run.rapid({0, 0, 50});
    EXPECT_EQ(moved.verdict, Verdict::undecided);
    EXPECT_FALSE(moved.checked);
    EXPECT_EQ(rules(moved), Rules({"undecided"}));
    EXPECT_EQ(rules(run.rapid({0, 0, 60})), Rules());
}

TEST(Simulator, ReportsAnUnknownStartPositionOnce) {
    Shift run(plain_setup());
    Motion first{.kind = MotionKind::rapid, .from = {}, .to = z_only(105.0)};
    const BlockResult unknown = run.give({first});
    EXPECT_EQ(rules(unknown), Rules({"first-move"}));
    EXPECT_EQ(unknown.findings[0].severity, Severity::warning);
    EXPECT_EQ(rules(run.give({first})), Rules());
}

TEST(Simulator, ReportsAPairOnceForABlockOfSeveralMotionsFromAnUnknownPosition) {
    core::Setup setup = plain_setup();
    for (MachineAxis& axis : setup.machine.axes) {
        axis.min = -200.0;
        axis.max = 300.0;
    }
    Shift high(setup);
    // As in G28 Z0 with X and Y unknown: first up, then to the reference point.
    const Motion up{.kind = MotionKind::rapid, .from = z_only(110.0), .to = z_only(120.0)};
    const Motion home{.kind = MotionKind::rapid, .from = z_only(120.0), .to = z_only(150.0)};
    const BlockResult both = high.give({up, home});
    EXPECT_TRUE(both.checked);
    EXPECT_EQ(both.verdict, Verdict::clear);
    ASSERT_FALSE(both.pairs.empty());
    for (const PairClearance& pair : both.pairs)
        EXPECT_EQ(
            std::count_if(both.pairs.begin(), both.pairs.end(),
                          [&](const PairClearance& other) { return other.pair == pair.pair; }),
            1);
    const PairClearance* flutes = pair_of(both, PartKind::flutes);
    ASSERT_TRUE(flutes);
    EXPECT_NEAR(flutes->lower, 110.0 - 95.0, 1e-3); // at the first motion
}

TEST(Simulator, ChecksEveryPathFromAnUnknownPositionWithinTheLimits) {
    core::Setup setup = plain_setup();
    for (MachineAxis& axis : setup.machine.axes) {
        axis.min = -200.0;
        axis.max = 300.0;
    }
    Shift high(setup);
    // The tip stays at least 5 above the stock whatever X and Y are.
    const Motion sideways{
        .kind = MotionKind::rapid, .from = z_only(100.0), .to = {50.0, 50.0, 100.0}};
    const BlockResult over = high.give({sideways});
    EXPECT_EQ(over.verdict, Verdict::clear);
    EXPECT_TRUE(over.checked);
    Shift low(setup);
    const Motion through{
        .kind = MotionKind::rapid, .from = z_only(90.0), .to = {-50.0, 50.0, 90.0}};
    EXPECT_EQ(rules(low.give({through})), Rules({"first-move"}));
}

TEST(Simulator, FindsOverTravelInsideAnArc) {
    core::Setup setup = plain_setup();
    setup.machine.axes[0].max = 115.0;
    Shift run(setup);
    run.rapid({100, 30, 20});
    EXPECT_EQ(rules(run.circle({100, 50, 0}, {100, 30, 20})), Rules({"over-travel"}));
}

TEST(Simulator, FindsTheDogLegThatTheStraightRapidHides) {
    core::Setup setup = plain_setup();
    setup.fixtures.push_back(
        {"post", posed(convex(ProfileElement{-30, 4, 60, 4, 0}), translation({120, 200, 0})),
         false});
    for (MachineAxis& axis : setup.machine.axes) axis.rapid = 10000.0;
    const auto rapid_past = [](const core::Setup& with) {
        Shift run(with);
        run.rapid({60, 140, 20});
        // On a straight path the tip passes (120, 155); as a dog-leg it first goes at 45 degrees up
        // to (110, 190).
        return run.rapid({260, 190, 20});
    };
    EXPECT_EQ(rapid_past(setup).verdict, Verdict::clear);
    setup.machine.rapid = RapidStyle::dogleg;
    EXPECT_NE(rapid_past(setup).verdict, Verdict::clear);
}

TEST(Simulator, FindsADrillThatIsFedSidewaysIntoTheStock) {
    auto drilling = plain_setup();
    ToolDescription drill = drilling.tools.at(ToolNumber{1}).description;
    drill.shape = ToolShape::drill;
    drilling.tools.at(ToolNumber{1}) = *assemble(drill);
    Shift run(drilling);
    run.rapid({50.1, 50.2, 5});
    EXPECT_EQ(run.feed({50.1, 50.2, -10}).verdict, Verdict::clear);
    EXPECT_EQ(run.feed({50.15, 50.2, -12}).verdict, Verdict::clear);
    const BlockResult sideways = run.feed({60, 50.2, -12});
    EXPECT_EQ(sideways.verdict, Verdict::collision);
    ASSERT_EQ(rules(sideways), Rules{"collision"});
    EXPECT_NE(sideways.findings[0].message.find("drill"), std::string::npos);
    EXPECT_EQ(run.rapid({60, 50.2, 5}).verdict, Verdict::clear);
    EXPECT_EQ(run.feed({20, 50.2, 5}).verdict, Verdict::clear);
}

TEST(Simulator, RunsARapidOfOneAxisStraightAtAnySpeeds) {
    auto dog_leg = plain_setup();
    dog_leg.machine.rapid = RapidStyle::dogleg;
    Shift run(dog_leg);
    run.rapid({-20, 50, 60});
    const BlockResult down = run.rapid({-20, 50, 20});
    EXPECT_EQ(down.verdict, Verdict::clear);
    const BlockResult into = run.rapid({50, 50, 20});
    EXPECT_EQ(into.verdict, Verdict::clear);
    EXPECT_EQ(run.rapid({50, 50, -3}).verdict, Verdict::collision);
}

} // namespace
} // namespace core
