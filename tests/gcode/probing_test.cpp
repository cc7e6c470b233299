#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gcode/lower/lowering.h"
#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;

constexpr core::AxisSet x = 1, y = 2, z = 4;

/// What a program knows about the axes X, Y, Z at the end of each of its motions.
struct KnownEnd {
    core::AxisSet settled; // positioned in spite of an uncertain start
    core::AxisSet unknown; // without a value

    bool operator==(const KnownEnd&) const = default;
};

std::vector<core::Motion> motions_of(std::string_view text, const Environment& environment) {
    const Ran ran = run_text(text, environment);
    EXPECT_FALSE(ran.run.error) << (ran.run.error ? ran.run.error->message : "");
    Lowering lowering = initial_lowering(environment);
    std::vector<core::Motion> motions;
    for (const BlockCommands& block : ran.run.blocks)
        for (const core::Event& event : lower(block, lowering))
            if (const auto* motion = std::get_if<core::Motion>(&event)) motions.push_back(*motion);
    return motions;
}

/// The ends of the motions after the first probing move.
std::vector<KnownEnd> ends_after_probing(std::string_view text, const Environment& environment) {
    std::vector<KnownEnd> ends;
    bool has_probed = false;
    for (const core::Motion& motion : motions_of(text, environment)) {
        KnownEnd end{static_cast<core::AxisSet>(motion.settles & (x | y | z)), 0};
        for (size_t axis = 0; axis < 3; ++axis)
            if (!motion.to[axis]) end.unknown |= static_cast<core::AxisSet>(1U << axis);
        if (has_probed) ends.push_back(end);
        has_probed = has_probed || motion.stops_at_contact;
    }
    return ends;
}

std::vector<KnownEnd> ends_after_probing(std::string_view text, DialectId dialect) {
    return ends_after_probing(text, known_environment(dialect));
}

TEST(Probing, MarksTheMove) {
    for (const char* code : {"G38.2", "G38.3", "G38.4", "G38.5"}) {
        const auto motions = motions_of(std::string("G21 G0 X1\n") + code + " Z-5 F100\nG0 Z5",
                                        known_environment(DialectId::linuxcnc));
        ASSERT_EQ(motions.size(), 3) << code;
        EXPECT_FALSE(motions[0].stops_at_contact);
        EXPECT_TRUE(motions[1].stops_at_contact);
        EXPECT_FALSE(motions[2].stops_at_contact);
    }
    for (const DialectId dialect : {DialectId::fanuc, DialectId::haas})
        EXPECT_TRUE(motions_of("G21 G90 G31 Z-5. F100.", known_environment(dialect))
                        .at(0)
                        .stops_at_contact);
}

TEST(Probing, AnAbsoluteWordPositionsItsAxis) {
    using Ends = std::vector<KnownEnd>;
    for (const DialectId dialect : {DialectId::linuxcnc, DialectId::grbl})
        EXPECT_EQ(ends_after_probing("G21 G90\nG38.2 Z-20 F100\nG0 X5\nG0 Z10\nG0 X9", dialect),
                  (Ends{{x | y, 0}, {x | y | z, 0}, {x | y | z, 0}}));
    for (const DialectId dialect : {DialectId::fanuc, DialectId::haas})
        EXPECT_EQ(ends_after_probing("G21 G90\nG31 Z-20. F100.\nG0 X5.\nG0 Z10.\nG0 X9.", dialect),
                  (Ends{{x | y, 0}, {x | y | z, 0}, {x | y | z, 0}}));
}

TEST(Probing, AnIncrementalWordKeepsTheUncertainty) {
    using Ends = std::vector<KnownEnd>;
    const std::string moves = "G0 Z2.\nG90 G0 X5.\nG91 G1 Z-1.\nG90 G0 Z50.\nG0 X0.";
    const Ends ends = {{x | y, 0}, {x | y, 0}, {x | y, 0}, {x | y | z, 0}, {x | y | z, 0}};
    EXPECT_EQ(ends_after_probing("G21 G91\nG38.2 Z-20 F100\n" + moves, DialectId::linuxcnc), ends);
    EXPECT_EQ(ends_after_probing("G21 G91\nG38.2 Z-20 F100\n" + moves, DialectId::grbl), ends);
    EXPECT_EQ(ends_after_probing("G21 G91\nG31 Z-20. F100.\n" + moves, DialectId::fanuc), ends);
    EXPECT_EQ(ends_after_probing("G21 G91\nG31 Z-20. F100.\n" + moves, DialectId::haas), ends);
}

TEST(Probing, MachineCoordinatesAndReferencePointsPositionTheirAxes) {
    using Ends = std::vector<KnownEnd>;
    EXPECT_EQ(
        ends_after_probing("G21 G90\nG38.2 Z-20 F100\nG53 G0 Z-1\nG0 X5", DialectId::linuxcnc),
        (Ends{{x | y | z, 0}, {x | y | z, 0}}));
    // The intermediate point of G28 is relative, the reference point is not.
    EXPECT_EQ(ends_after_probing("G21 G91\nG31 Z-20. F100.\nG28 Z0.\nG90 G0 X5.", DialectId::fanuc),
              (Ends{{x | y, 0}, {x | y | z, 0}, {x | y | z, 0}}));
}

TEST(Probing, ASecondTouchKeepsBothUncertainties) {
    using Ends = std::vector<KnownEnd>;
    EXPECT_EQ(
        ends_after_probing(
            "G21 G91\nG38.2 Z-20 F100\nG0 Z2\nG38.2 Z-4 F20\nG0 Z3\nG38.2 X9 F20\nG0 X-2\n"
            "G90 G0 Z50\nG0 X0",
            DialectId::linuxcnc),
        (Ends{{x | y, 0}, {x | y, 0}, {x | y, 0}, {x | y, 0}, {y, 0}, {y | z, 0}, {x | y | z, 0}}));
}

TEST(Probing, AChangeOfOffsetsLeavesTheMachineWhereItIs) {
    using Ends = std::vector<KnownEnd>;
    EXPECT_EQ(
        ends_after_probing("G21 G90 G54\nG38.2 Z-20 F100\nG55\nG0 X5\nG43.1 Z30\nG0 Y5\nG0 Z50",
                           DialectId::linuxcnc),
        (Ends{{x | y, 0}, {x | y, 0}, {x | y | z, 0}}));
}

TEST(Probing, ADatumSetAtTheContactIsUnknown) {
    const auto ends =
        ends_after_probing("G21 G90\nG38.2 Z-20 F100\nG92 Z0\nG0 Z5\nG0 X5", DialectId::linuxcnc);
    ASSERT_EQ(ends.size(), 2);
    EXPECT_EQ(ends[0].unknown, z);
    EXPECT_EQ(ends[1].unknown, z);
}

TEST(Probing, WhatDependsOnThePositionInAnotherWayIsUnknown) {
    // The cycle returns to its initial level, which is the height of the contact.
    const auto cycle = ends_after_probing(
        "G21 G90\nG38.2 Z-20 F100\nG98 G81 X5 Z-40 R-30 F100\nG80\nG0 X1", DialectId::linuxcnc);
    ASSERT_FALSE(cycle.empty());
    EXPECT_EQ(cycle.back().unknown, z);
    // The centre of an arc depends on where it starts.
    const Ran arc = run_text("G21 G17 G90\nG38.2 X-20 F100\nG91 G2 X5 Y5 R5 F100\nG1 Y1",
                             known_environment(DialectId::linuxcnc));
    ASSERT_TRUE(arc.run.error);
    EXPECT_THAT(arc.run.error->message, HasSubstr("start position of the arc is unknown in X"));
}

TEST(Probing, AnArcKeepsTheUncertaintyAcrossItsPlane) {
    using Ends = std::vector<KnownEnd>;
    EXPECT_EQ(ends_after_probing("G21 G17 G90\nG38.2 Z-20 F100\nG2 X5 Y5 R5 F100\nG3 X0 Y0 Z9 R5",
                                 DialectId::linuxcnc),
              (Ends{{x | y, 0}, {x | y | z, 0}}));
}

TEST(Probing, CutterCompensationWaitsForAKnownPosition) {
    const Ran ran = run_text(
        "G21 G17 G90 F100\nG38.2 Z-20\nG41.1 D4\nG1 X20\nG1 Y20\nG40 G1 X40\nG0 Z50\nG0 X0\n",
        known_environment(DialectId::linuxcnc));
    ASSERT_FALSE(ran.run.error);
    bool is_doubtful = false;
    for (const BlockCommands& block : ran.run.blocks)
        if (block.line >= 4 && block.line <= 6 && !block.commands.empty())
            is_doubtful = is_doubtful || block.path == core::PathCertainty::unknown;
    EXPECT_TRUE(is_doubtful);
    EXPECT_EQ(ran.run.blocks.back().path, core::PathCertainty::known);
}

TEST(Probing, RotaryAxesAreUnknownAfterwards) {
    const auto motions = motions_of("G21 G90\nG38.2 A20 F100\nG0 X5\nG0 A0\nG0 X0",
                                    known_environment(DialectId::linuxcnc));
    ASSERT_EQ(motions.size(), 4);
    EXPECT_TRUE(motions[0].to[3]);
    EXPECT_FALSE(motions[1].from[3]);
    EXPECT_FALSE(motions[1].to[3]);
    EXPECT_TRUE(motions[3].from[3]);
}

TEST(Probing, DoesNotChangeTheTrace) {
    const std::string tail = "G91 G0 Z2\nG0 X3\nG90 G1 X5 Z1\n";
    const auto after_first_line = [](const std::string& text) {
        return text.substr(text.find('\n') + 1);
    };
    EXPECT_EQ(after_first_line(trace("G21 G90 F100 G38.2 Z-20\n" + tail, DialectId::linuxcnc)),
              after_first_line(trace("G21 G90 F100 G1 Z-20\n" + tail, DialectId::linuxcnc)));
}

TEST(Probing, StatesWithAnUncertainPositionDiffer) {
    InterpreterState state = initial_state(known_environment(DialectId::linuxcnc));
    const uint64_t known = digest_of(state);
    state.modal.spread[2] = 5.0;
    EXPECT_NE(digest_of(state), known);
}

} // namespace
} // namespace gcode
