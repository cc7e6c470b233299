#include <gtest/gtest.h>

#include "core/motion/path.h"
#include "core/sim/run/simulator.h"
#include "core/sim/setup.h"

namespace core {
namespace {

/// A clamp inside the corner of an L-shaped path, or one outside; the tool is a plain cylinder of
/// 10 mm. The path turns at the origin, from along X to along Y.
core::Setup around_a_corner(double gap, bool inside) {
    core::Setup setup;
    setup.stock = {SolidBox{{{900, 900, -10}, {910, 910, 0}}}, 0.0};
    ToolDescription tool;
    tool.number = ToolNumber{1};
    tool.diameter = 10.0;
    tool.flute_length = 60.0;
    setup.tools.emplace(tool.number, *assemble(tool));
    Fixture pin;
    pin.name = "pin";
    pin.body = convex(ProfileElement{-100.0, 3.0, 100.0, 3.0, 0.0});
    const double away = (3.0 + 5.0 + gap) / std::sqrt(2.0);
    pin.mount.link_from_body =
        translation(inside ? Vec3(-3.0 - 5.0 - gap, 3.0 + 5.0 + gap, 0.0) : Vec3(away, -away, 0.0));
    setup.fixtures.push_back(std::move(pin));
    return setup;
}

/// The clearance to the clamp before and after the corner.
struct Corner {
    core::Setup setup;
    SimulatorState state;
    uint32_t block = 0;
    Vec3 at = Vec3(20, 20, 10);
    PairClearance seen = {};
    std::vector<Verdict> verdicts = {};

    explicit Corner(core::Setup with) : setup(std::move(with)), state(*start_of_run(setup, {})) {
        give({ToolChange{ToolNumber{1}}});
        give({SpindleChange{SpindleDirection::clockwise, 5000.0}});
    }
    void give(const std::vector<Event>& events) {
        const BlockResult result = run_block(setup, {BlockIndex{block++}, false, events}, state);
        for (const PairClearance& pair : result.pairs) {
            if (pair.pair != Pair{PartKind::flutes, 0}) continue;
            merge(seen, pair);
            verdicts.push_back(pair.verdict);
        }
    }
    void start_at(const AxisPosition& position) {
        give({Motion{.kind = MotionKind::rapid, .from = position, .to = position}});
    }
    void feed(const AxisPosition& from, const AxisPosition& to, double rate = 6000.0) {
        give({Motion{.kind = MotionKind::feed, .from = from, .to = to, .feed = rate}});
    }
    Verdict go(MotionKind kind, const Vec3& to) {
        const double z = setup.tools.at(ToolNumber{1}).length;
        const Motion motion{.kind = kind,
                            .from = {at.x, at.y, at.z + z},
                            .to = {to.x, to.y, to.z + z},
                            .feed = kind == MotionKind::feed ? 600.0 : 0.0};
        at = to;
        const std::vector<Event> events{motion};
        return run_block(setup, {BlockIndex{block++}, false, events}, state).verdict;
    }
    void pass(MotionKind kind = MotionKind::feed) {
        const double z = setup.tools.at(ToolNumber{1}).length;
        const double feed = kind == MotionKind::feed ? 600.0 : 0.0;
        give({Motion{.kind = kind, .from = {-50, 0, z}, .to = {0, 0, z}, .feed = feed}});
        give({Motion{.kind = kind, .from = {0, 0, z}, .to = {0, 50, z}, .feed = feed}});
    }
};

constexpr PathModeChange within(double tolerance) { return {Blending::continuous, tolerance}; }

TEST(RoundedCorners, ComeNearerToAClampInsideByTheTolerance) {
    const double gap = 2.1, tolerance = 0.3;
    Corner corner(around_a_corner(gap, true));
    corner.give({within(tolerance)});
    corner.pass();
    // The control may take a path that deviates by the tolerance towards the clamp.
    EXPECT_LE(corner.seen.lower, gap - tolerance + 1e-9);
    EXPECT_GE(corner.seen.lower, gap - tolerance - 1e-3);
    EXPECT_EQ(corner.seen.verdict, Verdict::undecided) << "the minimum clearance is 2 mm";
}

TEST(RoundedCorners, StayFartherFromAClampOutside) {
    const double gap = 1.9, tolerance = 0.3;
    Corner corner(around_a_corner(gap, false));
    corner.give({within(tolerance)});
    corner.pass();
    EXPECT_GE(corner.seen.upper, gap + tolerance - 1e-9);
    EXPECT_EQ(corner.seen.verdict, Verdict::undecided) << "the minimum clearance is 2 mm";
}

TEST(RoundedCorners, LeaveNoDoubtWhereTheClearanceSufficesAnyway) {
    for (const Detail detail : {Detail::every_pair, Detail::deciding_pair, Detail::verdict}) {
        core::Setup setup = around_a_corner(2.31, true);
        setup.detail = detail;
        Corner corner(std::move(setup));
        corner.give({within(0.3)});
        corner.pass();
        for (const Verdict verdict : corner.verdicts) EXPECT_EQ(verdict, Verdict::clear);
    }
}

TEST(RoundedCorners, AreAbsentAtExactStops) {
    for (const Blending blending : {Blending::exact_stop, Blending::exact_path}) {
        Corner corner(around_a_corner(2.1, true));
        corner.give({within(0.3)});
        corner.give({PathModeChange{blending, {}}});
        corner.pass();
        EXPECT_NEAR(corner.seen.lower, 2.1, 1e-6);
        EXPECT_NEAR(corner.seen.upper, 2.1, 1e-6);
    }
}

/// LinuxCNC's G64 P.
constexpr PathModeChange blends_all_within(double tolerance) {
    PathModeChange change = within(tolerance);
    change.rapid_tolerance = tolerance;
    return change;
}

TEST(RoundedCorners, OfRapidsAreNearTheCorner) {
    // The clamp is 10 mm from the corner along either move.
    Corner corner(around_a_corner(2.1, true));
    corner.give({blends_all_within(0.3)});
    corner.pass(MotionKind::rapid);
    EXPECT_EQ(corner.seen.verdict, Verdict::clear);
    EXPECT_NEAR(corner.seen.lower, 2.1, 1e-6);
    EXPECT_NEAR(corner.seen.upper, 2.4, 1e-6) << "the nearest point may be missed";
}

TEST(RoundedCorners, OfRapidsReachAsFarAsTheToleranceAllows) {
    // Half way of a parabola, the tool is 5 mm from the corner, towards the clamp.
    const double gap = 2.1, to_centre = std::sqrt(2.0) * (8.0 + gap) - 5.0;
    Corner corner(around_a_corner(gap, true));
    corner.give({blends_all_within(5.0)});
    corner.pass(MotionKind::rapid);
    EXPECT_LE(corner.seen.lower, to_centre - 8.0);
    EXPECT_EQ(corner.seen.verdict, Verdict::undecided);
    EXPECT_EQ(corner.verdicts.front(), Verdict::clear) << "the corner belongs to the second move";
}

TEST(RoundedCorners, AreAbsentBetweenRapidsThatStopOrAreFollowedByFeeds) {
    const double z = 40.0;
    const Motion first{.kind = MotionKind::rapid, .from = {-50, 0, z}, .to = {0, 0, z}};
    Motion second{.kind = MotionKind::rapid, .from = {0, 0, z}, .to = {0, 50, z}};
    const auto verdict = [&](const PathModeChange& mode, const std::vector<Event>& between) {
        Corner corner(around_a_corner(2.1, true));
        corner.give({mode});
        corner.give({first});
        corner.give(between);
        corner.give({second});
        return corner.seen.verdict;
    };
    const PathModeChange exact{Blending::exact_path, {}};
    EXPECT_EQ(verdict(blends_all_within(5.0), {}), Verdict::undecided);
    EXPECT_EQ(verdict(blends_all_within(5.0), {Dwell{}}), Verdict::clear);
    EXPECT_EQ(verdict(blends_all_within(5.0), {exact}), Verdict::undecided)
        << "the mode of the first move counts";
    EXPECT_EQ(verdict(exact, {blends_all_within(5.0)}), Verdict::clear);
    EXPECT_EQ(verdict(within(5.0), {}), Verdict::clear) << "only feeds are rounded";
    PathModeChange mixed = blends_all_within(5.0);
    mixed.tolerance.reset();
    second.kind = MotionKind::feed;
    second.feed = 500.0;
    EXPECT_EQ(verdict(mixed, {}), Verdict::clear) << "LinuxCNC stops between a rapid and a feed";
    mixed.tolerance = 0.1;
    mixed.between_kinds = true;
    EXPECT_EQ(verdict(mixed, {}), Verdict::clear) << "the smaller tolerance applies";
    mixed.tolerance = 5.0;
    EXPECT_EQ(verdict(mixed, {}), Verdict::undecided);
}

/// As above, with a tool that tilts about the gauge line, towards the clamp.
core::Setup with_tilting_head(double gap, double acceleration) {
    core::Setup setup = around_a_corner(gap, true);
    MachineAxis& axis = setup.machine.axes[3];
    axis.present = true;
    axis.direction = Vec3(1, 0, 0);
    axis.side = Side::tool;
    axis.carrier = setup.machine.spindle;
    setup.machine.spindle = link_of(3);
    for (size_t i = 0; i < 4; ++i) {
        setup.machine.axes[i].rapid = 10'000.0;
        setup.machine.axes[i].acceleration = acceleration;
    }
    return setup;
}

TEST(RoundedCorners, AreOffOnlyAlongTheMotionThatMayNotHaveEnded) {
    // The head may tilt when the tool is still half of 200 mm short of its place along X, where the
    // clamp is beside it: the tip then gets 20.5 mm nearer, and nothing more.
    const auto verdict = [](double gap, double angle) {
        core::Setup setup = with_tilting_head(gap, 5.0);
        const double z = setup.tools.at(ToolNumber{1}).length;
        Corner corner(std::move(setup));
        PathModeChange mode = within(0.02);
        mode.blends = mode.blends_at_arcs = true;
        corner.give({mode});
        const AxisPosition start = {-150, 0, z, 0}, upright = {50, 0, z, 0},
                           tilted = {50, 0, z, angle};
        corner.start_at(start);
        corner.feed(start, upright);
        corner.feed(upright, tilted);
        return corner.verdicts.back();
    };
    EXPECT_EQ(verdict(30.0, 20.0), Verdict::clear);
    EXPECT_EQ(verdict(10.0, 20.0), Verdict::undecided);
    EXPECT_EQ(verdict(10.0, -20.0), Verdict::clear) << "the other way round";
}

TEST(RoundedCorners, LeaveDoubtWhereAnAxisOfRotationMayStillTurn) {
    // It is upright before it goes past.
    for (const bool blends : {false, true}) {
        core::Setup setup = with_tilting_head(10.0, 500.0);
        setup.machine.axes[3].acceleration = 5.0;
        const double z = setup.tools.at(ToolNumber{1}).length;
        Corner corner(std::move(setup));
        PathModeChange mode = within(0.02);
        mode.blends = mode.blends_at_arcs = true;
        if (blends)
            corner.give({mode});
        else
            corner.give({PathModeChange{Blending::exact_stop, {}}});
        const AxisPosition upright = {-60, 0, z, 0}, tilted = {-60, 0, z, 40}, past = {20, 0, z, 0};
        corner.give({Motion{.kind = MotionKind::rapid, .from = tilted, .to = tilted}});
        corner.give(
            {Motion{.kind = MotionKind::feed, .from = tilted, .to = upright, .feed = 600.0}});
        corner.give({Motion{.kind = MotionKind::feed, .from = upright, .to = past, .feed = 600.0}});
        EXPECT_EQ(corner.verdicts.back(), blends ? Verdict::undecided : Verdict::clear);
        // LinuxCNC joins a short line with the next one, which begins while the axis still turns.
        mode.joining = 0.02;
        if (blends) corner.give({mode});
        const AxisPosition near = {-59.95, 0, z, 0};
        const auto feed = [&](const AxisPosition& from, const AxisPosition& to) {
            corner.give({Motion{.kind = MotionKind::feed, .from = from, .to = to, .feed = 600.0}});
        };
        corner.give({Motion{.kind = MotionKind::rapid, .from = tilted, .to = tilted}});
        feed(tilted, upright);
        feed(upright, near);
        feed(near, past);
        EXPECT_EQ(corner.verdicts.back(), blends ? Verdict::undecided : Verdict::clear);
    }
}

TEST(RoundedCorners, OfRapidsBeginWhileAnAxisOfRotationStillTurns) {
    enum { exact, at_speed, unknown, fast };
    const auto verdict = [](int mode) {
        core::Setup setup = with_tilting_head(10.0, 500.0);
        setup.machine.axes[3].acceleration = mode == fast ? 1e5 : 5.0;
        if (mode == unknown) setup.machine.axes[3].rapid.reset();
        const double z = setup.tools.at(ToolNumber{1}).length;
        Corner corner(std::move(setup));
        PathModeChange blends{Blending::continuous, {}};
        blends.rapids_keep_speed = true;
        corner.give({mode == exact ? PathModeChange{Blending::exact_stop, {}} : blends});
        const AxisPosition tilted = {-60, 0, z, 40}, upright = {-60, 0, z, 0}, past = {20, 0, z, 0};
        corner.give({Motion{.kind = MotionKind::rapid, .from = tilted, .to = tilted}});
        corner.give({Motion{.kind = MotionKind::rapid, .from = tilted, .to = upright}});
        corner.give({Motion{.kind = MotionKind::rapid, .from = upright, .to = past}});
        return corner.verdicts.back();
    };
    EXPECT_EQ(verdict(exact), Verdict::clear);
    EXPECT_EQ(verdict(at_speed), Verdict::undecided);
    EXPECT_EQ(verdict(unknown), Verdict::undecided);
    EXPECT_EQ(verdict(fast), Verdict::clear);
}

TEST(RoundedCorners, AreThereAlsoWithAMotionOfRoundingErrorsBetween) {
    // LinuxCNC leaves it out, so the motions beside it meet.
    core::Setup setup = with_tilting_head(10.0, 5.0);
    const double z = setup.tools.at(ToolNumber{1}).length;
    Corner corner(std::move(setup));
    PathModeChange mode = within(0.02);
    mode.blends = mode.blends_at_arcs = true;
    corner.give({mode});
    const double error = 0.1 + 0.2 - 0.3;
    const AxisPosition start = {-150, 0, z, 0}, there = {50, 0, z, 0}, again = {50, error, z, 0},
                       tilted = {50, 0, z, 20};
    corner.start_at(start);
    corner.feed(start, there);
    corner.feed(there, again);
    EXPECT_EQ(corner.verdicts.back(), Verdict::clear);
    corner.feed(again, tilted);
    EXPECT_EQ(corner.verdicts.back(), Verdict::undecided);
}

TEST(RoundedCorners, OfTurningFeedsNeedNoTolerance) {
    const auto verdict = [](bool at_speed) {
        core::Setup setup = with_tilting_head(10.0, 5.0);
        const double z = setup.tools.at(ToolNumber{1}).length;
        Corner corner(std::move(setup));
        PathModeChange mode{Blending::continuous, {}};
        mode.rapids_keep_speed = at_speed; // LinuxCNC's G64 without P
        corner.give({mode});
        const AxisPosition start = {-150, 0, z, 0}, there = {50, 0, z, 0}, tilted = {50, 0, z, 20};
        corner.start_at(start);
        corner.feed(start, there);
        corner.feed(there, tilted);
        return corner.verdicts.back();
    };
    EXPECT_EQ(verdict(true), Verdict::undecided);
    EXPECT_EQ(verdict(false), Verdict::clear) << "other controls";
}

TEST(RoundedCorners, CutOnlyWhereTheSpindleTurns) {
    // A tilts the tool back to upright before it comes over the stock, with 0.02 mm to spare. At 5
    // degrees the edge of its end is 0.2 mm lower.
    const auto verdict = [](SpindleDirection spindle) {
        core::Setup setup = with_tilting_head(100.0, 5.0);
        setup.stock = {SolidBox{{{-140, -50, -10}, {300, 50, 0}}}, 0.0};
        const double z = setup.tools.at(ToolNumber{1}).length;
        Corner corner(std::move(setup));
        corner.give({SpindleChange{spindle, 5000.0}});
        PathModeChange mode = within(0.02);
        mode.blends = mode.blends_at_arcs = true;
        corner.give({mode});
        const AxisPosition tilted = {-150, 0, z + 0.02, 15}, upright = {-150, 0, z + 0.02, 0},
                           past = {0, 0, z + 0.02, 0};
        const auto go = [&](MotionKind kind, const AxisPosition& from, const AxisPosition& to) {
            const std::vector<Event> events{Motion{.kind = kind,
                                                   .from = from,
                                                   .to = to,
                                                   .feed = kind == MotionKind::feed ? 600.0 : 0.0}};
            return run_block(corner.setup, {BlockIndex{corner.block++}, false, events},
                             corner.state)
                .verdict;
        };
        go(MotionKind::rapid, tilted, tilted);
        go(MotionKind::feed, tilted, upright);
        return go(MotionKind::feed, upright, past);
    };
    EXPECT_EQ(verdict(SpindleDirection::clockwise), Verdict::clear);
    EXPECT_EQ(verdict(SpindleDirection::stopped), Verdict::undecided);
}

TEST(RoundedCorners, ReachBackThroughSmallArcsThatAreTakenForLines) {
    Machine machine;
    for (size_t i = 0; i < 3; ++i) {
        machine.axes[i].present = true;
        machine.axes[i].acceleration = 100.0;
    }
    const auto lines_before_corner = [&](double joining) {
        RoundedCorners corners = corners_at_start(machine);
        PathModeChange mode = within(0.05);
        mode.joining = joining;
        mode.blends = mode.blends_at_arcs = true;
        change_mode(corners, mode, machine);
        const auto note = [&](const Motion& motion) {
            note_corner(corners, motion, path_of(motion, machine, 1e-3));
        };
        const auto feed = [](const AxisPosition& from, const AxisPosition& to) {
            return Motion{.kind = MotionKind::feed, .from = from, .to = to, .feed = 6000.0};
        };
        note(feed({-5, 0, 0}, {-0.1, 0, 0}));
        Motion arc = feed({-0.1, 0, 0}, {0.1, 0, 0});
        arc.kind = MotionKind::arc;
        arc.arc = ArcPath{.centre = Vec3(0, -1, 0), .angle = -0.2};
        note(arc);
        note(feed({0.1, 0, 0}, {0.4, 0, 0}));
        return corners.last.legs_with_joined();
    };
    const std::vector<Leg> joined = lines_before_corner(0.02);
    ASSERT_EQ(joined.size(), 4U);
    for (size_t i = 1; i < 4; ++i)
        EXPECT_EQ(joined[i].positions.front(), joined[i - 1].positions.back());
    EXPECT_EQ(joined[0].positions.front()[0], -5.0);
    EXPECT_EQ(lines_before_corner(0.001).size(), 1U);
}

TEST(RoundedCorners, OfOneToolDoNotPutTheHolesOfAnotherInDoubt) {
    core::Setup setup = around_a_corner(20.0, true);
    setup.stock = {SolidBox{{{0, 0, -30}, {100, 100, 0}}}, 0.0};
    ToolDescription other = setup.tools.at(ToolNumber{1}).description;
    other.number = ToolNumber{2};
    setup.tools.emplace(other.number, *assemble(other));
    Corner corner(std::move(setup));
    corner.give({SpindleChange{SpindleDirection::clockwise, 6000.0}, within(0.2)});
    corner.go(MotionKind::feed, {20, 20, -5});
    corner.go(MotionKind::feed, {60, 20, -5});
    corner.go(MotionKind::rapid, {60, 20, 10});
    corner.give({ToolChange{ToolNumber{2}}});
    corner.give({SpindleChange{SpindleDirection::clockwise, 6000.0}});
    corner.go(MotionKind::rapid, {40, 70, 10});
    EXPECT_EQ(corner.go(MotionKind::feed, {40, 70, -8}), Verdict::clear);
    EXPECT_EQ(corner.go(MotionKind::rapid, {40, 70, 10}), Verdict::clear);
    corner.go(MotionKind::rapid, {60, 20, 10});
    EXPECT_EQ(corner.go(MotionKind::rapid, {60, 20, -4.9}), Verdict::undecided)
        << "what the other tool has left there is not known";
}

TEST(RoundedCorners, BeginAtADistanceAtTheEarliest) {
    for (const double distance : {2.0, 40.0}) {
        Corner corner(around_a_corner(2.1, true));
        PathModeChange change = within(0.0);
        change.tolerance.reset();
        change.rapid_distance = distance;
        corner.give({change});
        corner.pass(MotionKind::rapid);
        EXPECT_EQ(corner.seen.verdict, distance > 20.0 ? Verdict::undecided : Verdict::clear);
    }
}

TEST(RoundedCorners, AddTheToleranceOfJoiningToThatOfCorners) {
    Corner corner(around_a_corner(2.3, true));
    PathModeChange change = within(0.2);
    change.joining = 0.15;
    corner.give({change});
    corner.pass();
    EXPECT_NEAR(corner.seen.lower, 2.3 - 0.35, 1e-6);
    EXPECT_EQ(corner.seen.verdict, Verdict::undecided);
}

TEST(RoundedCorners, TakeTheMachinesToleranceWhereTheProgramStatesNone) {
    core::Setup setup = around_a_corner(2.1, true);
    setup.machine.corner_tolerance = 0.2;
    Corner corner(std::move(setup));
    corner.pass();
    EXPECT_NEAR(corner.seen.lower, 1.9, 1e-6);
    EXPECT_EQ(corner.state.assumptions.size(), 1U) << "the term of the bound is listed";
    Corner unstated(around_a_corner(2.1, true));
    unstated.give({PathModeChange{Blending::continuous, {}}});
    unstated.pass();
    EXPECT_NEAR(unstated.seen.lower, 2.1, 1e-6);
    EXPECT_EQ(unstated.state.assumptions.size(), 1U) << "the assumption is listed";
}

TEST(RoundedCorners, LeaveDoubtWhereACornerMayBeLeftUncut) {
    // A square corner in a slot, rounded by 2 mm at most, and a rapid down into it afterwards.
    for (const double tolerance : {0.02, 2.0}) {
        core::Setup setup = around_a_corner(20.0, true);
        setup.stock = {SolidBox{{{0, 0, -30}, {100, 100, 0}}}, 0.0};
        Corner corner(std::move(setup));
        corner.give({SpindleChange{SpindleDirection::clockwise, 6000.0}, within(tolerance)});
        corner.go(MotionKind::feed, {20, 20, -5});
        corner.go(MotionKind::feed, {60, 20, -5});
        corner.go(MotionKind::feed, {60, 60, -5});
        EXPECT_EQ(corner.go(MotionKind::rapid, {60, 60, 10}), Verdict::clear) << "as it came";
        corner.go(MotionKind::rapid, {60, 20, 10});
        EXPECT_EQ(corner.go(MotionKind::rapid, {60, 20, -4.9}),
                  tolerance > 1.0 ? Verdict::undecided : Verdict::clear);
    }
}

TEST(RoundedCorners, LeaveNoDoubtAtTheFaceOfTheRawStock) {
    core::Setup setup = around_a_corner(20.0, true);
    setup.stock = {SolidBox{{{0, 0, -30}, {100, 100, 0}}}, 0.0};
    Corner corner(std::move(setup));
    corner.give({SpindleChange{SpindleDirection::clockwise, 6000.0}, within(2.0)});
    corner.go(MotionKind::feed, {20, 20, -5});
    corner.go(MotionKind::feed, {60, 20, -5});
    corner.give({PathModeChange{Blending::exact_stop, {}}});
    corner.go(MotionKind::rapid, {60, 20, 10});
    corner.go(MotionKind::rapid, {60, 28, 10});
    EXPECT_EQ(corner.go(MotionKind::rapid, {60, 28, 0}), Verdict::clear) << "beside the slot";
    EXPECT_EQ(corner.go(MotionKind::rapid, {60, 28, -1}), Verdict::collision);
}

/// A block of 100 x 100 x 60 with its top at Z 0, and two tools of 10 mm with flutes of 20 mm and
/// shanks of this diameter.
Corner with_deep_stock(double shank, double tolerance) {
    core::Setup setup;
    setup.stock = {SolidBox{{{0, 0, -60}, {100, 100, 0}}}, 0.0};
    for (const int number : {1, 2}) {
        ToolDescription tool;
        tool.number = ToolNumber{number};
        tool.diameter = 10.0;
        tool.flute_length = 20.0;
        tool.shank_diameter = shank;
        tool.stick_out = 80.0;
        setup.tools.emplace(tool.number, *assemble(tool));
    }
    Corner corner(std::move(setup));
    corner.give({SpindleChange{SpindleDirection::clockwise, 6000.0}, within(tolerance)});
    return corner;
}

/// The worst verdict of feeds at each height along X through the whole block.
Verdict mill_slot(Corner& corner, const std::vector<double>& heights, double y = 50.0) {
    Verdict worst = Verdict::clear;
    for (const double z : heights) {
        corner.go(MotionKind::rapid, {-20, y, 10});
        corner.go(MotionKind::rapid, {-20, y, z});
        worst = std::max(worst, corner.go(MotionKind::feed, {60, y, z}));
        worst = std::max(worst, corner.go(MotionKind::feed, {110, y, z}));
        worst = std::max(worst, corner.go(MotionKind::rapid, {110, y, 10}));
    }
    return worst;
}

TEST(RoundedCorners, LeaveNoDoubtWhereTheShankFollowsItsFlutes) {
    for (const double shank : {10.0, 9.8}) {
        Corner corner = with_deep_stock(shank, 0.3);
        EXPECT_EQ(mill_slot(corner, {-15, -30, -45}), Verdict::clear);
        // Out of it in the middle, and at another place straight down and up.
        corner.go(MotionKind::rapid, {-20, 50, -45});
        corner.go(MotionKind::feed, {50, 50, -45});
        EXPECT_EQ(corner.go(MotionKind::rapid, {50, 50, 10}), Verdict::clear);
        corner.go(MotionKind::rapid, {50, 20, 10});
        EXPECT_EQ(corner.go(MotionKind::feed, {50, 20, -50}), Verdict::clear);
        EXPECT_EQ(corner.go(MotionKind::rapid, {50, 20, 10}), Verdict::clear);
        // Another tool makes room for its own shank only.
        corner.give({ToolChange{ToolNumber{2}}});
        corner.give({SpindleChange{SpindleDirection::clockwise, 6000.0}});
        corner.go(MotionKind::rapid, {50, 80, 10});
        EXPECT_EQ(corner.go(MotionKind::feed, {50, 80, -50}), Verdict::clear);
        EXPECT_EQ(corner.go(MotionKind::rapid, {50, 80, 10}), Verdict::clear);
        EXPECT_EQ(mill_slot(corner, {-45}), Verdict::undecided);
    }
}

TEST(RoundedCorners, LeaveDoubtWhereTheShankPassesStockThatItsFlutesHaveNotTouched) {
    for (const double shank : {10.0, 8.0})
        for (const double tolerance : {0.05, 0.3}) {
            Corner corner = with_deep_stock(shank, tolerance);
            EXPECT_EQ(mill_slot(corner, {-15}), Verdict::clear);
            const double y = -0.5 * shank - 0.1; // 0.1 mm from the side of the block
            corner.go(MotionKind::rapid, {20, -20, 10});
            corner.go(MotionKind::rapid, {20, -20, -50});
            corner.go(MotionKind::feed, {20, y, -50});
            EXPECT_EQ(corner.go(MotionKind::feed, {80, y, -50}),
                      tolerance > 0.1 ? Verdict::undecided : Verdict::clear);
        }
}

TEST(RoundedCorners, LeaveDoubtWhereTheFlutesDeviatedLessThanTheShankDoes) {
    Corner corner = with_deep_stock(10.0, 0.3);
    corner.give({PathModeChange{Blending::exact_stop, {}}});
    EXPECT_EQ(mill_slot(corner, {-15}), Verdict::clear);
    corner.give({within(0.3)});
    EXPECT_EQ(mill_slot(corner, {-30}), Verdict::undecided);
    // The upper level once more: now both deviate alike.
    mill_slot(corner, {-15});
    EXPECT_EQ(mill_slot(corner, {-30}), Verdict::clear);
    EXPECT_EQ(
        corner.state.assumptions.count("the control rounds the same corner alike each time: a "
                                       "tool that moves where it has cut deviates as it did "
                                       "then"),
        1U);
}

TEST(RoundedCorners, LeaveDoubtWhereTheShankIsNearTheWallOfAnotherTool) {
    for (const double gap : {0.5, 1.5}) {
        Corner corner = with_deep_stock(10.0, 0.3);
        for (const double y : {40.0, 48.0}) mill_slot(corner, {-15, -30, -45}, y);
        corner.give({ToolChange{ToolNumber{2}}});
        corner.give({SpindleChange{SpindleDirection::clockwise, 6000.0}});
        corner.go(MotionKind::rapid, {50, 10, 10});
        corner.go(MotionKind::feed, {50, 10, -15});
        corner.go(MotionKind::rapid, {50, 10, 10});
        // Both may be off by 0.3 mm.
        EXPECT_EQ(mill_slot(corner, {-45}, 40 + gap),
                  gap < 0.6 ? Verdict::undecided : Verdict::clear);
    }
}

TEST(RoundedCorners, LeaveDoubtWhereTheFlutesComeAfterTheShank) {
    Corner corner = with_deep_stock(9.8, 0.3);
    corner.give({PathModeChange{Blending::exact_stop, {}}});
    corner.go(MotionKind::rapid, {50, 50, 10});
    corner.go(MotionKind::feed, {50, 50, -15});
    corner.go(MotionKind::feed, {50, 50, -50});
    corner.give({within(0.3)});
    EXPECT_EQ(corner.go(MotionKind::feed, {50.15, 50, -2}), Verdict::undecided);
}

TEST(RoundedCorners, LeaveDoubtWhereFlutesThatDoNotTurnPassTheStock) {
    Corner corner = with_deep_stock(10.0, 0.3);
    EXPECT_EQ(mill_slot(corner, {-15}), Verdict::clear);
    corner.give({SpindleChange{SpindleDirection::stopped, 0.0}});
    corner.go(MotionKind::rapid, {20, -20, 10});
    corner.go(MotionKind::rapid, {20, -5.1, 10});
    corner.go(MotionKind::rapid, {20, -5.1, -15});
    EXPECT_EQ(corner.go(MotionKind::feed, {80, -5.1, -15}), Verdict::undecided);
}

TEST(RoundedCorners, LeaveACrashACrash) {
    Corner corner(around_a_corner(-2.0, true));
    corner.give({within(0.05)});
    corner.pass();
    EXPECT_EQ(corner.seen.verdict, Verdict::collision);
}

} // namespace
} // namespace core
