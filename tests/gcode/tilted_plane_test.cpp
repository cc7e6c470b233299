#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/motion/machine.h"
#include "gcode/lower/lowering.h"
#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;

struct Lowered {
    Position machine;
    bool moved_tilted;
};

Lowered lowered(std::string_view text) {
    const Environment environment = known_environment(DialectId::fanuc);
    const Ran ran = run_text(text, environment);
    EXPECT_FALSE(ran.run.error) << (ran.run.error ? ran.run.error->message : "");
    Lowering lowering = initial_lowering(environment);
    for (const BlockCommands& block : ran.run.blocks) lower(block, lowering);
    return {lowering.machine, lowering.moved_tilted};
}

void expect_machine_at(std::string_view text, double x, double y, double z, bool tilted) {
    SCOPED_TRACE(text);
    const Lowered found = lowered(text);
    EXPECT_NEAR(*found.machine[0], x, 1e-9);
    EXPECT_NEAR(*found.machine[1], y, 1e-9);
    EXPECT_NEAR(*found.machine[2], z, 1e-9);
    EXPECT_EQ(found.moved_tilted, tilted);
}

TEST(TiltedPlane, EulerAnglesTurnAboutZThenNewXThenNewZ) {
    // Tilted by 90 degrees about X: the plane's Y is the work's Z, its Z is the work's -Y.
    expect_machine_at("G68.2 X10 Y20 Z30 I0 J90 K0\nG0 X1 Y2 Z3", 11, 17, 32, true);
    // Rotated about Z first: the plane's X is the work's Y, its Z is the work's X.
    expect_machine_at("G68.2 X0 Y0 Z0 I90 J90 K0\nG0 X1 Y2 Z3", 3, 1, 2, true);
    // Then about its own Z: its X is the work's Z, its Y is the work's -Y.
    expect_machine_at("G68.2 X0 Y0 Z0 I90 J90 K90\nG0 X1 Y2 Z3", 3, -2, 1, true);
}

TEST(TiltedPlane, RollPitchYawTurnAboutTheWorkAxesInTheirOrder) {
    // X first: (1, 2, 3) to (1, -3, 2), then about Z: (3, 1, 2).
    expect_machine_at("G68.2 P1 Q123 X0 Y0 Z0 I90 J0 K90\nG0 X1 Y2 Z3", 3, 1, 2, true);
    // Z first: (1, 2, 3) to (-2, 1, 3), then about X: (-2, -3, 1).
    expect_machine_at("G68.2 P1 Q321 X0 Y0 Z0 I90 J0 K90\nG0 X1 Y2 Z3", -2, -3, 1, true);
    EXPECT_THAT(error_of("G68.2 P1 Q122 I1"), HasSubstr("once each"));
}

TEST(TiltedPlane, GoesThroughThreePoints) {
    // X along the work's Y, and +Y on the side of the work's Z: Z is the work's X.
    const std::string plane = "G68.2 P2 Q1 X10 Y20 Z30\nG68.2 P2 Q2 X10 Y25 Z30\n"
                              "G68.2 P2 Q3 X10 Y22 Z37\n";
    expect_machine_at(plane + "G0 X1 Y2 Z3", 13, 21, 32, true);
    expect_machine_at("G91\nG68.2 P2 Q0 X0 Y0 Z0 R0\n" + plane + "G90\nG0 X1 Y2 Z3", 13, 21, 32,
                      true);
    expect_machine_at("G20\nG68.2 P2 Q1 X1\nG68.2 P2 Q2 X2\nG68.2 P2 Q3 Z1\nG0 X1 Y1 Z1", 50.8,
                      -25.4, 25.4, true);
}

TEST(TiltedPlane, HasTwoStatedDirections) {
    expect_machine_at("G68.2 P3 Q1 X10 Y20 Z30 I0 J4 K0\nG68.2 P3 Q2 I.5 J0 K0\nG0 X1 Y2 Z3", 13,
                      21, 32, true);
    // Rounded directions: the axis of the tool counts.
    expect_machine_at("G68.2 P3 Q1 I1 J0 K.001\nG68.2 P3 Q2 I0 J0 K1\nG0 X1 Y2 Z3", 1, 2, 3, false);
}

TEST(TiltedPlane, HasTwoProjectedAngles) {
    // One angle tilts about one axis; K turns about the new Z.
    expect_machine_at("G68.2 P4 X10 Y20 Z30 I90 J0 K0\nG0 X1 Y2 Z3", 13, 22, 29, true);
    expect_machine_at("G68.2 P4 X10 Y20 Z30 I0 J90 K0\nG0 X1 Y2 Z3", 11, 17, 32, true);
    expect_machine_at("G68.2 P4 I0 J90 K90\nG0 X1 Y2 Z3", -2, -3, 1, true);
    // Both: X of the plane is (cos 30, 0, -sin 30), and (0, cos 50, sin 50) lies in it.
    const double x = std::cos(M_PI / 6.0), z = -0.5, c = std::cos(M_PI / 3.6),
                 s = std::sin(M_PI / 3.6);
    const core::Vec3 along(x, 0.0, z), other(0.0, c, s);
    const core::Vec3 normal = glm::normalize(glm::cross(along, other));
    const core::Vec3 across = glm::cross(normal, along);
    const core::Vec3 there = along + 2.0 * across + 3.0 * normal;
    EXPECT_NEAR(glm::dot(other, normal), 0.0, 1e-12);
    expect_machine_at("G68.2 P4 I30 J50\nG0 X1 Y2 Z3", there.x, there.y, there.z, true);
}

TEST(TiltedPlane, ThroughRandomPointsIsTheSameAsByAngles) {
    std::mt19937 random(682);
    std::uniform_real_distribution<double> angle(-80.0, 80.0), place(-50.0, 50.0);
    for (int i = 0; i < 500; ++i) {
        const core::Vec3 angles(angle(random), angle(random), angle(random));
        const core::Vec3 origin(place(random), place(random), place(random));
        // About Z, about the new X, about the new Z.
        const core::Mat3 axes =
            turned_about(2, angles.x) * turned_about(0, angles.y) * turned_about(2, angles.z);
        const core::Vec3 second = origin + axes * core::Vec3(5.0 + std::abs(place(random)), 0, 0);
        const core::Vec3 third =
            origin + axes * core::Vec3(place(random), 5.0 + std::abs(place(random)), 0);
        const auto words = [](const char* letters, const core::Vec3& v) {
            return fmt::format("{}{:.10f} {}{:.10f} {}{:.10f}", letters[0], v.x, letters[1], v.y,
                               letters[2], v.z);
        };
        const std::string move = "G0 X7 Y-8 Z9";
        const Position by_angles =
            lowered("G68.2 " + words("XYZ", origin) + " " + words("IJK", angles) + "\n" + move)
                .machine;
        const Position by_points =
            lowered("G68.2 P2 Q1 " + words("XYZ", origin) + "\nG68.2 P2 Q2 " + words("XYZ", second)
                    + "\nG68.2 P2 Q3 " + words("XYZ", third) + "\n" + move)
                .machine;
        const Position by_directions =
            lowered("G68.2 P3 Q1 " + words("XYZ", origin) + " " + words("IJK", 3.0 * axes[0])
                    + "\nG68.2 P3 Q2 " + words("IJK", axes[2]) + "\n" + move)
                .machine;
        for (size_t axis = 0; axis < 3; ++axis) {
            ASSERT_NEAR(*by_points[axis], *by_angles[axis], 1e-7);
            ASSERT_NEAR(*by_directions[axis], *by_angles[axis], 1e-7);
        }
    }
}

TEST(TiltedPlane, CountsLeastIncrementsInLengthsAndAnglesOnly) {
    Environment environment = known_environment(DialectId::fanuc);
    environment.counts_smallest_steps = true;
    const auto end = [&](const std::string& text) {
        const Ran ran = run_text(text, environment);
        EXPECT_FALSE(ran.run.error) << ran.run.error->message;
        Lowering lowering = initial_lowering(environment);
        for (const BlockCommands& block : ran.run.blocks) lower(block, lowering);
        return lowering.machine;
    };
    const auto expect = [](const Position& at, double x, double y, double z) {
        EXPECT_NEAR(*at[0], x, 1e-9);
        EXPECT_NEAR(*at[1], y, 1e-9);
        EXPECT_NEAR(*at[2], z, 1e-9);
    };
    expect(
        end("G68.2 P2 Q1 X10000\nG68.2 P2 Q2 X10000 Y5.\nG68.2 P2 Q3 X10000 Z7000\nG0 X1. Y2. Z3."),
        13, 1, 2);
    expect(end("G68.2 P1 Q321 I90000 K90.\nG0 X1. Y2. Z3."), -2, -3, 1);
    // Angles have the same increment in inches.
    expect(end("G20 G68.2 I90000 J90000\nG0 X1. Y2. Z3."), 76.2, 25.4, 50.8);
}

TEST(TiltedPlane, RefusesAnIncompletePlane) {
    const std::string first = "G68.2 P2 Q1 X1\n", second = "G68.2 P2 Q2 X5\n";
    EXPECT_THAT(error_of("G68.2 P2 Q2 X1"), HasSubstr("begins with Q1"));
    EXPECT_THAT(error_of("G68.2 P2 X1"), HasSubstr("begins with Q1"));
    EXPECT_THAT(error_of("G68.2 P3 Q0 X1"), HasSubstr("begins with Q1"));
    EXPECT_THAT(error_of(first + "G68.2 P2 Q3 X1"), HasSubstr("Q2 must come next"));
    EXPECT_THAT(error_of(first + "G68.2 P3 Q2 K1"), HasSubstr("P2 Q2 must come next"));
    EXPECT_THAT(error_of(first + "G0 X1"), HasSubstr("Q2 must come before this block"));
    EXPECT_THAT(error_of(first + second + "M30"), HasSubstr("Q3 must come before this block"));
    EXPECT_THAT(error_of(first + "G69"), HasSubstr("must come before"));
    EXPECT_THAT(error_of(first + second + "G53.1"), HasSubstr("Q3 must come before this block"));
    EXPECT_EQ(error_of(first + "(A COMMENT)\nN10\n" + second + "\nG68.2 P2 Q3 Y5"), "");
    EXPECT_THAT(error_of(first + "G68.2 X1 I20"), HasSubstr("must come before"));
    EXPECT_THAT(error_of(first + second + "G68.2 P2 Q3 X9"), HasSubstr("on one line"));
    EXPECT_THAT(error_of(first + first), HasSubstr("Q2 must come next"));
    EXPECT_THAT(error_of("G68.2 P2 Q0 X2"), HasSubstr("not supported yet in this block"));
    EXPECT_THAT(error_of("G68.2 P2 Q1 X2 I5"), HasSubstr("not supported yet in this block"));
    EXPECT_THAT(error_of("G68.2 P3 Q1 I1\nG68.2 P3 Q2 I.1 K1"), HasSubstr("perpendicular"));
    EXPECT_THAT(error_of("G68.2 P3 Q1\nG68.2 P3 Q2 K1"), HasSubstr("no length"));
    EXPECT_THAT(error_of("G68.2 P4 I90 J90"), HasSubstr("define no plane"));
    EXPECT_THAT(error_of("G68.2 X0 Y0 Z0 I20 A5"), HasSubstr("in a block of its own"));
}

TEST(TiltedPlane, AShiftOrARotationAboutZLeavesTheToolUpright) {
    expect_machine_at("G68.2 X10 Y20 Z30 I0 J0 K0\nG53.1\nG0 X1 Y2 Z3", 11, 22, 33, false);
    expect_machine_at("G68.2 X0 Y0 Z0 I90 J0 K0\nG0 X1 Y2 Z3", -2, 1, 3, false);
}

TEST(TiltedPlane, G684AddsToThePlaneThatIsOn) {
    // The plane's Y is the work's Z, its Z is the work's -Y; then X of the new one is Y of the old.
    expect_machine_at("G68.2 X10 Y20 Z30 J90\nG68.4 X1 Y2 Z3 I90\nG0 X4 Y5 Z6", 6, 11, 36, true);
    expect_machine_at("G68.2 J90\nG68.4 J-90\nG0 X1 Y2 Z3", 1, 2, 3, false);
    expect_machine_at("G68.2 X10 Y20 Z30 J90\nG68.4 P2 Q1 X1 Y2 Z3\nG68.4 P2 Q2 X1 Y3 Z3\n"
                      "G68.4 P2 Q3 X0 Y2 Z3\nG0 X4 Y5 Z6",
                      6, 11, 36, true);
    expect_machine_at("G68.2 J90\nG68.4 J90\nG69\nG0 X1 Y2 Z3", 1, 2, 3, false);
    EXPECT_THAT(error_of("G68.4 I90"), HasSubstr("program G68.2 first"));
    EXPECT_THAT(error_of("G68.2 J90\nG68.4 P2 Q1 X1\nG68.2 P2 Q2 X2"),
                HasSubstr("G68.4 P2 Q2 must come next"));
}

TEST(TiltedPlane, G544IsOnlyCancelled) {
    EXPECT_EQ(error_of("G54.4 P0\nG0 X1"), "");
    EXPECT_THAT(error_of("G54.4 P1"), HasSubstr("G54.4 P0"));
    EXPECT_THAT(error_of("G54.4"), HasSubstr("G54.4 P0"));
}

TEST(TiltedPlane, IsLeftWithG69) {
    expect_machine_at("G68.2 X10 Y20 Z30 I0 J90 K0\nG69\nG0 X1 Y2 Z3", 1, 2, 3, false);
    EXPECT_THAT(error_of("G53.1"), HasSubstr("program G68.2 first"));
}

TEST(ToolCentre, G434IsG43WithANote) {
    EXPECT_EQ(trace("G43.4 H3"), "use_tool_length_offset number=3 length=0 follows_tip\n");
    EXPECT_EQ(trace("G43 H3"), "use_tool_length_offset number=3 length=0\n");
    EXPECT_THAT(warnings_of("G43.4 H3"), HasSubstr("treated as G43"));
}

TEST(ToolCentre, G435PointsTheToolByVectorsUntilAnotherLengthCode) {
    EXPECT_TRUE(lowered("G43.5 H3\nG1 X1 I0 J0.6 K0.8 F9").moved_tilted);
    EXPECT_FALSE(lowered("G43.5 H3\nG49\nG1 X1 F9").moved_tilted);
    EXPECT_THAT(warnings_of("G21 G43.5 H3\nG1 X1 I0 J0.6 K0.8 F9"), Not(HasSubstr("no code in")));
}

TEST(LookAhead, ItsCodesChangeNoMotion) {
    EXPECT_EQ(trace("G5.1 Q1\nG1 X1 F9\nG5.1 Q0"), "straight_feed x=1 y=0 z=0 feed=9\n");
    EXPECT_EQ(trace("G05 P10000\nG08 P1\nG1 X1 F9\nG08 P0\nG05 P0"),
              "straight_feed x=1 y=0 z=0 feed=9\n");
    for (const std::string_view text : {"G61", "G61.1", "G62", "G63", "G64", "G9 G1 X1 F1"})
        EXPECT_EQ(error_of(text), "") << text;
    EXPECT_EQ(error_of("G187 P1 E0.01\nG61", DialectId::haas), "");
}

} // namespace
} // namespace gcode
