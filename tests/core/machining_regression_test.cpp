#include <numbers>

#include <gtest/gtest.h>

#include "core/distance/stock_distance.h"
#include "core/sim/run/simulator.h"
#include "core/sim/setup.h"
#include "tests/support/machines.h"

namespace core {
namespace {

/// A run of a single tool: a 10 mm end mill with 5 mm of flutes and a shank of the same diameter.
struct Nibbler {
    Setup setup;
    AxisValues at{};
    SimulatorState state;
    uint32_t block = 0;

    explicit Nibbler(Setup with, const Vec3& tip) : setup(std::move(with)), state(begin(tip)) {
        give({ToolChange{ToolNumber{1}}});
        give({SpindleChange{SpindleDirection::clockwise, 6000.0}});
    }

    SimulatorState begin(const Vec3& tip) {
        ToolDescription tool;
        tool.number = ToolNumber{1};
        tool.diameter = 10.0;
        tool.flute_length = 5.0;
        tool.shank = {{10.0, 10.0, 30.0}};
        setup.tools.emplace(tool.number, *assemble(tool));
        for (size_t i = 0; i < 3; ++i) at[i] = tip[static_cast<int>(i)];
        at[2] += setup.tools.at(ToolNumber{1}).length;
        return *start_of_run(setup, position());
    }
    AxisPosition position() const {
        AxisPosition there;
        for (size_t i = 0; i < axis_count; ++i)
            if (setup.machine.axes[i].present) there[i] = at[i];
        return there;
    }
    BlockResult give(const std::vector<Event>& events) {
        return run_block(setup, {BlockIndex{block++}, false, events}, state);
    }
    BlockResult go(MotionKind kind, const std::vector<std::pair<size_t, double>>& by) {
        Motion motion{.kind = kind, .from = position()};
        for (const auto& [axis, way] : by) at[axis] += way;
        motion.to = position();
        motion.feed = kind == MotionKind::feed ? 500.0 : 0.0;
        return give({motion});
    }
};

Setup beside_a_fin() {
    Setup setup;
    setup.mesh_size = 0.1;
    setup.detail = Detail::deciding_pair;
    setup.stock = {SolidBox{{{0.0, -0.5, 0.0}, {0.2, 0.5, 2.0}}}, 0.0};
    return setup;
}

Setup on_a_trunnion() {
    Setup setup;
    setup.machine = test_support::trunnion(Vec3(0.0), Vec3(0.0));
    setup.mesh_size = 1.0;
    setup.stock = {SolidCylinder{{0, 0, -10}, 30.0, 10.0, 2}, 0.0};
    setup.stock_mount = {setup.machine.table, {}};
    return setup;
}

TEST(LateLook, KnowsWhatTheFlutesTookOnTheirWay) {
    // The fin is 2.9 mm below the shank until the flutes remove it completely.
    Nibbler run(beside_a_fin(), {-5.5, 0.0, -0.1});
    const BlockResult near = run.go(MotionKind::rapid, {{0, 0.2}});
    ASSERT_TRUE(near.deciding);
    ASSERT_EQ(near.pairs[*near.deciding].pair, Pair{PartKind::flutes});
    const BlockResult nibble = run.go(MotionKind::feed, {{0, 0.6}});
    ASSERT_GT(nibble.removed, 0.3);
    bool shown_assumptions = false;
    for (const PairClearance& pair : nibble.pairs) {
        if (pair.pair != Pair{PartKind::shank}) continue;
        shown_assumptions = true;
        EXPECT_LE(pair.lower, 3.0) << "the side of the shank passes over the fin";
    }
    EXPECT_TRUE(shown_assumptions);
}

TEST(TurningCut, KeepsAllRemainingMaterialInTheColumns) {
    const double round = 20.0, depth = 3.0;
    Nibbler run(on_a_trunnion(), {round, 0.0, -depth});
    const BlockResult turned = run.go(MotionKind::feed, {{5, 60.0}});
    ASSERT_GT(turned.removed, 100.0);
    const StockGoal goal{
        .limit = 1.0, .bound = StockBound::lower, .threshold = 1e-4, .finest = 1e-4};
    const auto lower_at = [&](double radius, double angle, double z) {
        const Vec3 p(radius * std::cos(angle), radius * std::sin(angle), z), half(1e-9);
        const ConvexShape point[] = {convex(Aabb{p - half, p + half})};
        return separation(point, run.state.stock, goal).separation.lower;
    };
    size_t gone = 0;
    for (int i = 0; i < 400; ++i) {
        const double angle = (i / 400.0 - 0.5) * 2.0 * std::numbers::pi / 2.5;
        for (const double z : {-0.5, -2.5}) {
            EXPECT_EQ(lower_at(round - 5.0 - 1e-6, angle, z), 0.0) << angle;
            EXPECT_EQ(lower_at(round + 5.0 + 1e-6, angle, z), 0.0) << angle;
        }
        EXPECT_EQ(lower_at(round, angle, -depth - 1e-6), 0.0) << angle;
        gone += lower_at(round, angle, -0.5) > 0.1;
    }
    EXPECT_GT(gone, 100U) << "the flutes passed there";
}

} // namespace
} // namespace core
