#include <numbers>

#include <gtest/gtest.h>

#include "gcode/lower/lowering.h"
#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using core::AxisPosition;
using core::Motion;
using core::MotionKind;

std::vector<core::Event> events_of(std::string_view text, const Environment& environment) {
    const Ran ran = run_text(text, environment);
    EXPECT_FALSE(ran.run.error) << (ran.run.error ? ran.run.error->message : "");
    Lowering lowering = initial_lowering(environment);
    std::vector<core::Event> events;
    for (const BlockCommands& block : ran.run.blocks)
        for (const core::Event& event : lower(block, lowering)) events.push_back(event);
    return events;
}

std::vector<Motion> motions_of(std::string_view text, const Environment& environment) {
    std::vector<Motion> motions;
    for (const core::Event& event : events_of(text, environment))
        if (const auto* motion = std::get_if<Motion>(&event)) motions.push_back(*motion);
    return motions;
}

/// The set-up of the worked example: G54 and a tool of 95 mm.
Environment example() {
    Environment environment;
    environment.dialect = DialectId::fanuc;
    environment.start = {-350.0, -200.0, 0.0};
    environment.work_offsets[0] = {-350, -200, -420};
    environment.length_offsets[core::OffsetNumber(1)] = {.length = 95.0};
    return environment;
}

using Linear = std::array<std::optional<double>, 3>;

/// X, Y and Z; all other axes must be 0.
Linear linear(const AxisPosition& position) {
    for (size_t axis = 3; axis < core::axis_count; ++axis) EXPECT_EQ(position[axis], 0.0);
    return {position[0], position[1], position[2]};
}

TEST(Lowering, AddsWorkOffsetAndToolLength) {
    const auto motions = motions_of("G54 G0 G43 H1 Z60.\nX-20. Y50.\nG1 Z-5. F100", example());
    ASSERT_EQ(motions.size(), 3u);
    EXPECT_EQ(linear(motions[0].from), (Linear{-350.0, -200.0, 0.0}));
    EXPECT_EQ(linear(motions[0].to), (Linear{-350.0, -200.0, -265.0}));
    EXPECT_EQ(linear(motions[1].to), (Linear{-370.0, -150.0, -265.0}));
    EXPECT_EQ(linear(motions[2].to), (Linear{-370.0, -150.0, -330.0}));
    EXPECT_EQ(motions[0].kind, MotionKind::rapid);
    EXPECT_EQ(motions[0].feed, 0.0);
    EXPECT_EQ(motions[2].kind, MotionKind::feed);
    EXPECT_EQ(motions[2].feed, 100.0);
}

TEST(Lowering, StartsEveryMotionWhereTheLastOneEnded) {
    const auto motions =
        motions_of("G54 G0 G43 H1 Z60.1\nX0.3 Y.7\nG55 Z7.\nG92 X1.1\nX.1\nG49 Z3\n"
                   "G53 Z0\nG91 G28 X0 Y0\nG90 G54 X.7",
                   example());
    for (size_t i = 1; i < motions.size(); ++i) EXPECT_EQ(motions[i].from, motions[i - 1].to) << i;
}

TEST(Lowering, AnAxisThatIsNotCommandedStaysToTheLastBit) {
    const auto motions = motions_of("G54 G0 X0.1 Y0.7 Z0.3\nG52 X0.1 Z.9\nX0.2\nX0.3", example());
    for (size_t i = 1; i < motions.size(); ++i) {
        EXPECT_EQ(motions[i].from[1], motions[i].to[1]) << i;
        EXPECT_EQ(motions[i].from[2], motions[i].to[2]) << i;
    }
}

TEST(Lowering, UsesTheOffsetsThatWereActiveAtEachCommand) {
    Environment environment = example();
    environment.work_offsets[1] = {10, 20, 30};
    const auto motions = motions_of("G54 G0 X1\nG55 X1\nG92 X0\nX1\nG52 X100\nX1", environment);
    ASSERT_EQ(motions.size(), 4u);
    EXPECT_EQ(*motions[0].to[0], -349.0);
    EXPECT_EQ(*motions[1].to[0], 11.0);
    EXPECT_EQ(*motions[2].to[0], 12.0);
    EXPECT_EQ(*motions[3].to[0], 112.0);
}

TEST(Lowering, MachineMovesAreExact) {
    const auto motions = motions_of("G43 H1 G0 Z33.3\nG53 G0 Z-10 X-5\nG91 G28 Z0", example());
    EXPECT_EQ(*motions[1].to[0], -5.0);
    EXPECT_EQ(*motions[1].to[2], -10.0);
    EXPECT_EQ(*motions[3].to[2], 0.0);
}

TEST(Lowering, KeepsTheShapeOfArcs) {
    const auto motions =
        motions_of("G54 G43 H1 G0 X0 Y0 Z0\nG3 X10 Y10 I0 J10 Z-1 F100", example());
    const Motion& arc = motions[1];
    ASSERT_EQ(arc.kind, MotionKind::arc);
    ASSERT_TRUE(arc.arc);
    EXPECT_EQ(arc.arc->normal, 2);
    EXPECT_EQ(arc.arc->centre[0], -350.0);
    EXPECT_EQ(arc.arc->centre[1], -190.0);
    EXPECT_NEAR(arc.arc->angle, std::numbers::pi / 2, 1e-12);
    EXPECT_EQ(*arc.to[2], -326.0);
    EXPECT_EQ(arc.feed, 100.0);
}

TEST(Lowering, TurnsTheRightWayInEveryPlane) {
    constexpr double pi = std::numbers::pi;
    const struct {
        std::string_view text;
        int normal;
        double angle;
    } cases[] = {{"G17 G2 X10 I5 F1", 2, -pi},          {"G17 G3 X10 I5 F1", 2, pi},
                 {"G18 G2 X10 I5 F1", 1, -pi},          {"G18 G3 X10 I5 F1", 1, pi},
                 {"G19 G2 Y10 J5 F1", 0, -pi},          {"G19 G3 Z10 K5 F1", 0, pi},
                 {"G17 G2 I5 F1", 2, -2 * pi},          {"G17 G3 I5 Z1 F1", 2, 2 * pi},
                 {"G17 G2 I5 P3 F1", 2, -6 * pi},       {"G17 G3 X10 I5 P2 F1", 2, 3 * pi},
                 {"G17 G3 X5 Y5 I5 F1", 2, 1.5 * pi},   {"G17 G2 X5 Y5 I5 F1", 2, -0.5 * pi},
                 {"G18 G3 X5 Z5 I5 F1", 1, 0.5 * pi},   {"G17 G3 Y0.0001 I-200 F1", 2, 5e-7},
                 {"G17 G2 Y-0.0001 I-200 F1", 2, -5e-7}};
    for (const auto& expected : cases) {
        Environment environment = known_environment(DialectId::linuxcnc);
        const auto motions = motions_of(expected.text, environment);
        ASSERT_EQ(motions.size(), 1u) << expected.text;
        ASSERT_TRUE(motions[0].arc) << expected.text;
        EXPECT_EQ(motions[0].arc->normal, expected.normal) << expected.text;
        EXPECT_NEAR(motions[0].arc->angle, expected.angle, 1e-9) << expected.text;
    }
}

/// The end of an arc, calculated by rotating its start about the centre.
core::Vec3 turned_start(const Motion& motion) {
    const core::ArcPath& arc = *motion.arc;
    const int first = (arc.normal + 1) % 3;
    const int second = (arc.normal + 2) % 3;
    core::Vec3 end(*motion.from[0], *motion.from[1], *motion.from[2]);
    const double u = end[first] - arc.centre[first];
    const double v = end[second] - arc.centre[second];
    end[first] = arc.centre[first] + u * std::cos(arc.angle) - v * std::sin(arc.angle);
    end[second] = arc.centre[second] + u * std::sin(arc.angle) + v * std::cos(arc.angle);
    return end;
}

TEST(Lowering, AnArcTurnedByItsAngleReachesItsEnd) {
    const auto motions =
        motions_of("G0 X1 Y2 Z3\nG17 G2 X5 Y4 R9 F1\nG3 X1 Y1 R-9\nG18 G2 X3 Z8 R7\n"
                   "G3 X1 Z1 R-7\nG19 G2 Y3 Z3 R-4\nG3 Y1 Z5 R4",
                   example());
    ASSERT_EQ(motions.size(), 7u);
    for (const Motion& motion : motions) {
        if (!motion.arc) continue;
        const core::Vec3 end = turned_start(motion);
        for (const int axis : {(motion.arc->normal + 1) % 3, (motion.arc->normal + 2) % 3})
            EXPECT_NEAR(end[axis], *motion.to[static_cast<size_t>(axis)], 1e-9);
    }
}

TEST(Lowering, UnknownAxesStayEmpty) {
    const auto motions =
        motions_of("G0 Z5\nX1\nG1 Y2 F10", Environment{.dialect = DialectId::fanuc});
    EXPECT_EQ(linear(motions[0].from), (Linear{}));
    EXPECT_EQ(linear(motions[0].to), (Linear{std::nullopt, std::nullopt, 5.0}));
    EXPECT_EQ(linear(motions[1].to), (Linear{1.0, std::nullopt, 5.0}));
    EXPECT_EQ(motions[2].from, motions[1].to);
    EXPECT_EQ(linear(motions[2].to), (Linear{1.0, 2.0, 5.0}));
}

TEST(Lowering, RestsWhereLinuxcncWaitsForTheEndOfAMotion) {
    const auto rests = [](const std::string& mode, DialectId id = DialectId::linuxcnc) {
        Environment environment = example();
        environment.dialect = id;
        environment.control.follows_start = true;
        size_t count = 0;
        for (const core::Event& event :
             events_of(mode + "\nG1 F500 X10\nM8\nX20\nS500 M3\nX30\nG43 H1\nX40\nG55\nX50\nM1\n",
                       environment))
            count += std::holds_alternative<core::Dwell>(event);
        return count;
    };
    EXPECT_EQ(rests("G64 P0.1"), 5U);
    EXPECT_EQ(rests("G90"), 5U) << "as it starts";
    EXPECT_EQ(rests("G61"), 0U) << "it rests anyway";
    EXPECT_EQ(rests("G64", DialectId::fanuc), 0U);
    // What only the interpreter notes is no rest: an offset that is in use, and another one's data.
    const auto rests_at = [&](const std::string& line) {
        Environment environment = example();
        environment.dialect = DialectId::linuxcnc;
        environment.control.follows_start = true;
        size_t count = 0;
        for (const core::Event& event :
             events_of("G54 G64\nG1 F500 X10\n" + line + "\nX20\n", environment))
            count += std::holds_alternative<core::Dwell>(event);
        return count;
    };
    for (const char* line : {"G54", "G10 L2 P3 X0", "G10 L20 P3 X0", "#5241=1", "#5221=1"})
        EXPECT_EQ(rests_at(line), 0U) << line;
    for (const char* line : {"G55", "G10 L2 P1 X0", "G10 L2 P0 X0", "G92 X5", "G92.1", "G52 X0"})
        EXPECT_EQ(rests_at(line), 1U) << line;
}

TEST(Lowering, PassesOnToolsSpindleLengthsAndDwells) {
    const auto events = events_of("T1 M6\nS500 M4\nG43 H1\nG4 P1.\nT0 M6\nG49", example());
    ASSERT_EQ(events.size(), 7u);
    EXPECT_EQ(std::get<core::ToolChange>(events[0]).tool, core::ToolNumber(1));
    EXPECT_EQ(std::get<core::SpindleChange>(events[1]).direction,
              core::SpindleDirection::counterclockwise);
    EXPECT_EQ(std::get<core::SpindleChange>(events[1]).speed, 500.0);
    EXPECT_EQ(std::get<core::LengthOffsetChange>(events[2]).number, core::OffsetNumber(1));
    EXPECT_EQ(std::get<core::LengthOffsetChange>(events[2]).length, 95.0);
    EXPECT_EQ(std::get<core::Dwell>(events[3]).seconds, 1.0);
    EXPECT_EQ(std::get<core::SpindleChange>(events[4]).direction, core::SpindleDirection::stopped);
    EXPECT_EQ(std::get<core::ToolChange>(events[5]).tool, std::nullopt);
    EXPECT_EQ(std::get<core::LengthOffsetChange>(events[6]).number, std::nullopt);
}

} // namespace
} // namespace gcode
