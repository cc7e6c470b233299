#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gcode/lower/lowering.h"
#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using core::Motion;
using testing::HasSubstr;

std::vector<Motion> motions_of(std::string_view text, DialectId dialect = DialectId::fanuc) {
    Environment environment = known_environment(dialect);
    environment.work_offsets[0] = {100, 50, -30};
    environment.length_offsets[core::OffsetNumber(1)] = {.length = 80.0};
    const Ran ran = run_text(text, environment);
    EXPECT_FALSE(ran.run.error) << (ran.run.error ? ran.run.error->message : "");
    Lowering lowering = initial_lowering(environment);
    std::vector<Motion> motions;
    for (const BlockCommands& block : ran.run.blocks)
        for (const core::Event& event : lower(block, lowering))
            if (const auto* motion = std::get_if<Motion>(&event)) motions.push_back(*motion);
    return motions;
}

/// Expects that two programs move the machine along the same path.
void expect_same_path(std::string_view text, std::string_view written_out,
                      DialectId dialect = DialectId::fanuc) {
    SCOPED_TRACE(text);
    const auto found = motions_of(text, dialect), expected = motions_of(written_out, dialect);
    ASSERT_EQ(found.size(), expected.size());
    ASSERT_FALSE(found.empty());
    for (size_t i = 0; i < found.size(); ++i) {
        SCOPED_TRACE(i);
        EXPECT_EQ(found[i].kind, expected[i].kind);
        EXPECT_EQ(found[i].feed, expected[i].feed);
        for (size_t axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(*found[i].from[axis], *expected[i].from[axis], 1e-9) << axis;
            EXPECT_NEAR(*found[i].to[axis], *expected[i].to[axis], 1e-9) << axis;
        }
        ASSERT_EQ(found[i].arc.has_value(), expected[i].arc.has_value());
        if (!found[i].arc) continue;
        EXPECT_EQ(found[i].arc->normal, expected[i].arc->normal);
        EXPECT_NEAR(found[i].arc->angle, expected[i].arc->angle, 1e-9);
        const int normal = found[i].arc->normal;
        for (const int axis : {(normal + 1) % 3, (normal + 2) % 3})
            EXPECT_NEAR(found[i].arc->centre[axis], expected[i].arc->centre[axis], 1e-9) << axis;
    }
}

TEST(NamedFrames, G68TurnsLinesAndArcsAboutItsCentre) {
    // Calculated by hand: (x, y) becomes (10 - y, x - 10).
    expect_same_path("G54 G0 X0 Y0 Z5\nG68 X10 Y0 R90\nG1 X20 Y0 F100\nG2 X30 Y10 I0 J10\n"
                     "G3 X30 Y10 I5\nG69\nG1 X0 Y0",
                     "G54 G0 X0 Y0 Z5\nG1 X10 Y10 F100\nG2 X0 Y20 I-10 J0\nG3 X0 Y20 J5\n"
                     "G1 X0 Y0");
}

TEST(NamedFrames, G68TurnsInEveryPlane) {
    // Counterclockwise as seen from the normal: Z towards X, Y towards Z.
    expect_same_path("G18 G68 X0 Z0 R90\nG1 X0 Z10 F9\nG1 X-4 Z2", "G18 G1 X10 Z0 F9\nX2 Z4");
    expect_same_path("G19 G68 Y0 Z0 R90\nG1 Y10 Z0 F9\nG2 Y5 Z-5 K-5",
                     "G19 G1 Y0 Z10 F9\nG2 Y5 Z5 J5");
}

TEST(NamedFrames, G68WithoutACentreTurnsWhereTheToolIs) {
    for (const DialectId dialect : {DialectId::fanuc, DialectId::haas})
        expect_same_path("G0 X10 Y20\nG68 R90\nG1 X15 Y20 F9\nX15 Y23",
                         "G0 X10 Y20\nG1 X10 Y25 F9\nX7 Y25", dialect);
    Environment nowhere = known_environment(DialectId::fanuc);
    nowhere.start = {};
    const Ran ran = run_text("G68 R90", nowhere);
    ASSERT_TRUE(ran.run.error);
    EXPECT_THAT(ran.run.error->message, HasSubstr("add the word"));
}

TEST(NamedFrames, IncrementalMovesAfterG68StartWhereTheToolIs) {
    expect_same_path("G0 X10 Y20\nG68 X0 Y0 R90\nG91 G1 X5 F9\nY2",
                     "G0 X10 Y20\nG91 G1 Y5 F9\nX-2");
}

TEST(NamedFrames, G68UnderG91AddsToTheAngleAndSaysSo) {
    expect_same_path("G68 X0 Y0 R30\nG91 G68 X0 Y0 R60\nG90 G1 X10 Y0 F9", "G1 X0 Y10 F9");
    expect_same_path("G68 X0 Y0 R30\nG68 X0 Y0 R90\nG90 G1 X10 Y0 F9", "G1 X0 Y10 F9");
    EXPECT_THAT(warnings_of("G21 G68 X0 Y0 R30\nG91 G68 X0 Y0 R60\nM30"),
                HasSubstr("R60: assumed to be relative to the previous angle"));
}

TEST(NamedFrames, TheFirstMoveAfterG68WithOneAxisKeepsTheOtherCoordinate) {
    // The example of parameter 11600#5 with its default value: X10 stays X10, then everything is
    // rotated.
    expect_same_path("G0 X10 Y0\nG68 X0 Y0 R90\nG1 Y4 F9\nX3", "G0 X10 Y0\nG1 X-4 Y10 F9\nX-4 Y3");
    EXPECT_THAT(warnings_of("G21 G0 X10 Y0\nG68 X0 Y0 R90\nX3\nM30"),
                HasSubstr("the first move after G68 has no Y word"));
    EXPECT_EQ(warnings_of("G21 G0 X10 Y0\nG68 X0 Y0 R90\nX3 Y1\nX7\nG69\nM30"), "");
}

TEST(NamedFrames, G51ScalesFromItsCentre) {
    // x becomes 2x - 10, y 2y - 20, z 2z; the length offset is not scaled.
    expect_same_path("G54 G43 H1 G0 X0 Y0 Z5\nG51 X10 Y20 Z0 P2000\nG0 X12 Y21 Z3\n"
                     "G3 X12 Y25 J2 F50\nG50\nG1 Z9",
                     "G54 G43 H1 G0 X0 Y0 Z5\nG0 X14 Y22 Z6\nG3 X14 Y30 J4 F50\nG1 Z9");
    expect_same_path("G51 X10. Y20. Z0 P2.\nG0 X12 Y21 Z3", "G0 X14 Y22 Z6", DialectId::haas);
    expect_same_path("G51 X0 Y0 Z0 P2\nG0 X12 Y21 Z0", "G0 X24 Y42 Z0", DialectId::haas);
}

TEST(NamedFrames, G51TakesAFactorForEachAxisAndReflects) {
    expect_same_path("G51 X0 Y0 Z0 I2000 J500 K-1000\nG1 X3 Y4 Z5 F9", "G1 X6 Y2 Z-5 F9");
    expect_same_path("G51 X0 Y0 Z0 I-2. J2. K1.\nG1 X3 Y4 Z5 F9\nG2 X3 Y6 J1",
                     "G1 X-6 Y8 Z5 F9\nG3 X-6 Y12 J2");
}

TEST(NamedFrames, AnArcScaledUnequallyIsRefused) {
    EXPECT_THAT(error_of("G51 X0 Y0 Z0 I2. J1. K2.\nG1 X1 F9\nG2 X3 I1"),
                HasSubstr("3:1: G2: G51 scales X by 2 and Y by 1"));
    EXPECT_EQ(error_of("G51 X0 Y0 Z0 I2. J1. K2.\nG18 G1 X1 F9\nG2 X3 I1"), "");
}

TEST(NamedFrames, AScaleWithoutPointIsDoubtedWhenTiny) {
    EXPECT_THAT(warnings_of("G21 G51 X0 Y0 Z0 P2\nM30"), HasSubstr("the scaling factor is 0.002"));
    EXPECT_THAT(error_of("G51 X0 Y0"), HasSubstr("add P, or I, J and K"));
    EXPECT_THAT(error_of("G51 P0"), HasSubstr("a scaling factor must not be 0"));
}

TEST(NamedFrames, G511ReflectsAndTurnsArcsTheOtherWay) {
    expect_same_path("G54 G51.1 X10\nG1 X0 Y5 F9\nG2 X4 Y5 I2\nG50.1 X0\nG1 X1 Y1",
                     "G54 G1 X20 Y5 F9\nG3 X16 Y5 I-2\nG1 X1 Y1");
    expect_same_path("G51.1 X0 Y0\nG1 X3 Y5 F9\nG2 X7 Y5 I2", "G1 X-3 Y-5 F9\nG2 X-7 Y-5 I-2");
    expect_same_path("G101 X0\nG1 X3 Y5 F9\nG100 X0\nX1 Y1", "G1 X-3 Y5 F9\nX1 Y1",
                     DialectId::haas);
}

TEST(NamedFrames, AMirrorImageOfOneAxisReversesG68) {
    // The rotated shape is mirrored as a whole: (10, 0) rotated by 30 degrees, then x negated.
    const double x = 10 * std::cos(std::acos(-1.0) / 6);
    expect_same_path("G51.1 X0\nG68 X0 Y0 R30\nG1 X10 Y0 F9", fmt::format("G1 X{:.12f} Y5 F9", -x));
}

TEST(NamedFrames, RotationFollowsScalingAndItsCentreIsScaled) {
    // (5, 0) scaled by 2 about the origin is (10, 0); the centre (3, 0) becomes (6, 0).
    expect_same_path("G51 X0 Y0 Z0 P2000\nG68 X3 Y0 R90\nG1 X5 Y0 F9\nG69 G50\nX1 Y1",
                     "G1 X6 Y4 F9\nX1 Y1");
}

TEST(NamedFrames, G53AndG28GoToMachinePositions) {
    expect_same_path("G54 G0 X1 Y2\nG68 X0 Y0 R30\nG53 G0 X-5 Y-6\nG91 G28 Y0",
                     "G54 G0 X1 Y2\nG53 G0 X-5 Y-6\nG91 G28 Y0");
}

TEST(NamedFrames, G92IsRefusedWhereCoordinatesAreTurned) {
    EXPECT_THAT(error_of("G68 X0 Y0 R30\nG92 X5"), HasSubstr("is on: cancel it"));
    EXPECT_EQ(error_of("G68 X0 Y0 R30\nG69\nG92 X5"), "");
}

TEST(NamedFrames, ScalingLeavesTheRadiusOfTheCutter) {
    // The tool stays 3 mm away from a line that is scaled by 2.
    const std::string entry = "G10 L12 P5 R3\nG0 X0 Y0\n";
    expect_same_path(entry + "G51 X0 Y0 Z0 P2.\nG41 D5 G1 X5 Y5 F9\nX10 Y5\nG40 X20 Y20\nG50",
                     entry + "G41 D5 G1 X10 Y10 F9\nX20 Y10\nG40 X40 Y40", DialectId::haas);
    EXPECT_THAT(error_of(entry + "G41 D5 G1 X5 Y5 F9\nG68 X0 Y0 R9"),
                HasSubstr("cancel cutter radius compensation first"));
}

TEST(NamedFrames, CyclesDrillTurnedHoles) {
    expect_same_path("G0 X0 Y0 Z20\nG68 X0 Y0 R90\nG99 G81 X10 Y1 Z-2 R3 F100\nX20\nG80 G69",
                     "G0 X0 Y0 Z20\nG99 G81 X-1 Y10 Z-2 R3 F100\nY20\nG80");
}

TEST(NamedFrames, G16ReadsRadiusAndAngle) {
    // The example of the manual: holes on a circle, with absolute and incremental angles.
    const std::string holes = "G1 X0 Y100 F9\nX-100 Y0\nX0 Y-100";
    expect_same_path("G17 G90 G16\nG1 X100 Y90 F9\nY180\nY270\nG15", holes);
    expect_same_path("G17 G90 G16\nG1 X100 Y90 F9\nG91 Y90\nY90\nG15", holes);
    expect_same_path("G0 X5 Y5\nG91 G16\nG1 X10 Y90 F9\nX10 Y90\nG15\nG90 X1 Y2",
                     "G0 X5 Y5\nG1 Y15 F9\nX-5\nX1 Y2");
    expect_same_path("G18 G16 G1 Z10 X90 Y3 F9\nY4", "G18 G1 X10 Z0 Y3 F9\nY4");
    expect_same_path("G16\nG99 G81 X10 Y180 Z-2 R3 F100\nY90\nG15 G80",
                     "G99 G81 X-10 Y0 Z-2 R3 F100\nX0 Y10\nG80");
}

TEST(NamedFrames, CancellingWhatIsNotOnSaysNothing) {
    EXPECT_EQ(trace("G17 G15 G40 G49 G50 G50.1 G69 G80"),
              "select_plane plane=XY\nuse_tool_length_offset length=0\n");
}

} // namespace
} // namespace gcode
