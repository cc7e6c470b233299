#include <gtest/gtest.h>

#include "core/sim/run/simulator.h"
#include "core/sim/setup.h"
#include "core/sim/tool_assembly.h"

namespace core {
namespace {

/// A block of 100 x 100 x 30 with its top at Z 0, in the machine frame, and a 10 mm end mill, 95 mm
/// long. Rapids go anywhere between the corners of their box: no speeds are stated.
Setup dogleg_setup(RapidStyle style = RapidStyle::dogleg) {
    Setup setup;
    setup.stock = {SolidBox{{{0, 0, -30}, {100, 100, 0}}}, 0.0};
    setup.machine.rapid = style;
    ToolDescription tool;
    tool.number = ToolNumber{1};
    tool.diameter = 10;
    tool.flute_length = 20;
    tool.shank = {{10, 10, 25}};
    tool.holder = {{40, 40, 50}};
    setup.tools.emplace(tool.number, *assemble(tool));
    return setup;
}

/// A run of one tool that begins beside the stock; positions are those of the tip.
struct Shift {
    Setup setup;
    SimulatorState state;
    uint32_t block = 0;
    Vec3 tip = Vec3(-20, 50, -5);

    explicit Shift(Setup with) : setup(std::move(with)), state(*start_of_run(setup, {})) {
        give({ToolChange{ToolNumber{1}}});
        give({SpindleChange{SpindleDirection::clockwise, 6000.0}});
    }

    BlockResult give(const std::vector<Event>& events) {
        return run_block(setup, {BlockIndex{block++}, false, events}, state);
    }
    BlockResult move(MotionKind kind, const Vec3& to) {
        const double length = setup.tools.at(ToolNumber{1}).length;
        const Motion motion{.kind = kind,
                            .from = {tip.x, tip.y, tip.z + length},
                            .to = {to.x, to.y, to.z + length},
                            .feed = kind == MotionKind::rapid ? 0.0 : 600.0};
        tip = to;
        return give({motion});
    }
    BlockResult rapid(const Vec3& to) { return move(MotionKind::rapid, to); }
    BlockResult feed(const Vec3& to) { return move(MotionKind::feed, to); }

    /// A rapid that passes over the stock or through its side, down to 5 mm deep, as far as X 55.
    BlockResult perhaps_through_the_side() { return rapid({50, 50, 5}); }
};

bool blames_an_earlier_motion(const BlockResult& result) {
    return result.findings.size() == 1 && result.findings[0].rule == "undecided"
           && result.findings[0].message.find("unless an earlier motion") != std::string::npos;
}

TEST(DoubtfulStock, IsNoCertainCrashLaterOn) {
    Shift run(dogleg_setup());
    EXPECT_EQ(run.perhaps_through_the_side().verdict, Verdict::undecided);
    const BlockResult down = run.rapid({50, 50, -3});
    EXPECT_EQ(down.verdict, Verdict::undecided);
    EXPECT_TRUE(blames_an_earlier_motion(down));
}

TEST(DoubtfulStock, IsCertainWithoutTheDoubt) {
    Shift run(dogleg_setup(RapidStyle::straight));
    run.rapid({-20, 50, 5});
    EXPECT_EQ(run.perhaps_through_the_side().verdict, Verdict::clear);
    EXPECT_EQ(run.rapid({50, 50, -3}).verdict, Verdict::collision);
}

TEST(DoubtfulStock, EndsWhereTheDoubtfulMotionCannotHaveBeen) {
    for (const Vec3& place : {Vec3(50, 50, -8), Vec3(90, 50, -3), Vec3(50, 90, -3)}) {
        Shift run(dogleg_setup());
        run.perhaps_through_the_side();
        run.rapid({place.x, place.y, 5});
        EXPECT_EQ(run.rapid(place).verdict, Verdict::collision) << place.x << ' ' << place.z;
    }
}

TEST(DoubtfulStock, IsReportedOnceByEachPairThatMeetsIt) {
    Shift run(dogleg_setup());
    run.perhaps_through_the_side();
    run.rapid({50, 50, -3});
    EXPECT_EQ(run.rapid({50, 50, 5}).verdict, Verdict::clear) << "that stock is gone in any case";
    EXPECT_EQ(run.rapid({50, 50, -3}).verdict, Verdict::clear);
}

TEST(DoubtfulStock, IsCutByLaterFeeds) {
    Shift run(dogleg_setup());
    run.perhaps_through_the_side();
    run.feed({50, 50, -10});
    EXPECT_GT(run.feed({90, 50, -10}).removed, 0.0);
    EXPECT_EQ(run.rapid({90, 50, 5}).verdict, Verdict::clear);
    EXPECT_EQ(run.rapid({70, 90, 5}).verdict, Verdict::clear);
    EXPECT_EQ(run.rapid({70, 90, -3}).verdict, Verdict::collision);
}

TEST(DoubtfulStock, IsAllOfItAfterAFeedOnAnUnknownPath) {
    Shift run(dogleg_setup(RapidStyle::straight));
    run.rapid({-20, 50, 5});
    const double length = run.setup.tools.at(ToolNumber{1}).length;
    const Motion feed{.kind = MotionKind::feed,
                      .from = {-20, 50, 5 + length},
                      .to = {-20, 50, 5 + length},
                      .feed = 600.0};
    const std::vector<Event> events{feed};
    const BlockEvents turned{
        .block = BlockIndex{run.block++}, .events = events, .path = PathCertainty::pose_unknown};
    EXPECT_EQ(run_block(run.setup, turned, run.state).verdict, Verdict::undecided);
    run.rapid({50, 50, 5});
    const BlockResult down = run.rapid({50, 50, -3});
    EXPECT_EQ(down.verdict, Verdict::undecided);
    EXPECT_TRUE(blames_an_earlier_motion(down));
}

TEST(DoubtfulStock, IsNotReportedAgainOnTheSameWayBack) {
    // 0.052 mm deep in the side, between two scan lines: 0.002 mm more than counts as contact.
    for (const double depth : {0.052, 1.0}) {
        Shift run(dogleg_setup(RapidStyle::straight));
        const double x = -5.0 + depth;
        run.rapid({-20, 50, 5});
        run.rapid({x, 50, 5});
        const Verdict down = run.rapid({x, 50, -10}).verdict;
        EXPECT_EQ(down, depth < 0.1 ? Verdict::undecided : Verdict::collision);
        EXPECT_EQ(run.rapid({x, 50, 5}).verdict, Verdict::clear);
        EXPECT_EQ(run.rapid({x, 50, -12}).verdict, down) << "deeper than before";
    }
}

} // namespace
} // namespace core
