#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/driven_machine.h"

// G68.3: the plane at right angles to the tool. Expected values are computed from the rotations in
// the manual, not with the kinematics of the project.

namespace gcode {
namespace {

using core::Mat3;
using core::Vec3;
using testing::HasSubstr;

const std::string length_on = "G21 G90 G94 G17 G54\nT1 M6\nG43 H1\n";

Environment fanuc_with(const core::Machine& machine, double axis,
                       std::optional<double> limit = {}) {
    Environment environment = environment_of(machine, DialectId::fanuc);
    environment.control.answers[ControlQuestion::vertical_axis] = axis;
    if (limit) environment.control.answers[ControlQuestion::vertical_limit] = *limit;
    return environment;
}

std::string refusal_of(const std::string& lines, const Environment& environment) {
    const Ran ran = run_text(length_on + lines, environment);
    return ran.run.error ? ran.run.error->message : std::string();
}

/// Where the tip is on the work in the frame of the table, for the last motion of a program.
Vec3 tip_of(const std::string& lines, const Environment& environment) {
    const Driven found = driven(length_on + lines, environment);
    const core::Motion& last = found.motions.back();
    core::AxisValues at{};
    for (size_t i = 0; i < at.size(); ++i) at[i] = last.to[i].value_or(0.0);
    return core::tip_position(*environment.machine, at, tool_length);
}

/// The direction of the tool in work coordinates, by hand: A and C as in driven_machine.h.
Vec3 tool_of(bool is_table, double first_deg, double c_deg) {
    const auto radians = [](double degrees) { return degrees * std::acos(-1.0) / 180.0; };
    const double t = radians(first_deg), c = radians(c_deg);
    // The table: `direction` is that of the tool about the work, C before A as seen from the work.
    // The head: the tool swivels about Y, then the fork turns about Z.
    return is_table ? Vec3(std::sin(c) * std::sin(t), -std::cos(c) * std::sin(t), std::cos(t))
                    : Vec3(std::cos(c) * std::sin(t), std::sin(c) * std::sin(t), std::cos(t));
}

TEST(ToolPlane, HasItsZAlongTheToolAndItsXAtRightAnglesToTheVerticalAxis) {
    std::mt19937 random(683);
    std::uniform_real_distribution<double> tilt(12.0, 78.0), turn(-170.0, 170.0), mm(-20.0, 20.0);
    for (int i = 0; i < 200; ++i) {
        const bool is_table = i % 2 == 0;
        const int vertical = i % 3;
        const double first = tilt(random), c = turn(random), spin = i % 4 ? 0.0 : turn(random);
        const Vec3 origin(mm(random), mm(random), mm(random)), at(mm(random), mm(random), 5.0);
        const Environment environment =
            fanuc_with(is_table ? trunnion() : fork_head(), vertical + 1, 1.0);
        const std::string words = fmt::format("G68.3 X{:.4f} Y{:.4f} Z{:.4f} R{:.4f}\n", origin.x,
                                              origin.y, origin.z, spin);
        const std::string rotary =
            fmt::format("G0 {}{:.4f} C{:.4f}\n", is_table ? 'A' : 'B', first, c);
        const auto go = [&](const Vec3& to) {
            return tip_of(rotary + words
                              + fmt::format("G0 X{:.4f} Y{:.4f} Z{:.4f}\n", to.x, to.y, to.z),
                          environment);
        };
        Vec3 along_p(0.0);
        along_p[vertical] = 1.0;
        const Vec3 z = tool_of(is_table, first, c);
        const Vec3 x0 = glm::normalize(glm::cross(along_p, z)), y0 = glm::cross(z, x0);
        const double s = spin * std::acos(-1.0) / 180.0;
        const Vec3 x = std::cos(s) * x0 + std::sin(s) * y0, y = glm::cross(z, x);
        SCOPED_TRACE(rotary + words);
        const Vec3 zero = go({0.0, 0.0, 0.0});
        const Vec3 moved = go(at) - zero;
        const Vec3 expected = at.x * x + at.y * y + at.z * z;
        for (int axis = 0; axis < 3; ++axis) ASSERT_NEAR(moved[axis], expected[axis], 1e-3);
        // The origin is a point of the work, wherever the table has turned.
        const Vec3 there = tip_of(
            fmt::format("G0 X{:.4f} Y{:.4f} Z{:.4f}\n", origin.x, origin.y, origin.z), environment);
        for (int axis = 0; axis < 3; ++axis) ASSERT_NEAR(zero[axis], there[axis], 1e-3);
    }
}

TEST(ToolPlane, BeginsWhereTheTipIsUnlessItsOriginIsStated) {
    for (const core::Machine& machine : {trunnion(), fork_head()}) {
        const Environment environment = fanuc_with(machine, 3, 1.0);
        const std::string turn = machine.axes[3].present ? "G0 A30. C40.\n" : "G0 B30. C40.\n";
        const std::string there = "G0 X20. Y-10. Z40.\n" + turn;
        const Vec3 before = tip_of(there, environment);
        const Vec3 after = tip_of(there + "G68.3\nG0 X1.\nX0. Y0. Z0.\n", environment);
        EXPECT_LT(glm::distance(before, after), 1e-9);
    }
}

TEST(ToolPlane, OfAToolAlongTheVerticalAxisHasTheAxesOfTheWork) {
    const auto moved = [](double axis, std::optional<double> limit, const std::string& turn,
                          const std::string& to) {
        const Environment environment = fanuc_with(fork_head(), axis, limit);
        const std::string plane = "G0 " + turn + "\nG68.3 X0. Y0. Z0.\nG0 X0. Y0. Z1.\n";
        return tip_of(plane + "G0 " + to + "\n", environment)
               - tip_of(plane + "G0 X0. Y0. Z0.\n", environment);
    };
    const auto expect = [](const Vec3& found, const Vec3& wanted) {
        EXPECT_LT(glm::distance(found, wanted), 1e-9)
            << found.x << " " << found.y << " " << found.z;
    };
    expect(moved(3, {}, "B0 C0", "X1. Y2. Z3."), {1, 2, 3});
    // X along Y of the work, and Y along its Z, with the tool along X.
    expect(moved(1, {}, "B90. C0", "X1. Y2. Z3."), {3, 1, 2});
    expect(moved(2, {}, "B90. C90.", "X1. Y2. Z3."), {2, 3, 1});
    // Within the limit, the tool counts as parallel.
    expect(moved(3, 1.0, "B.5 C0", "X1. Y2. Z3."), {1, 2, 3});
    expect(moved(3, 0.0, "B.9 C0", "X1. Y2. Z3."), {1, 2, 3}); // 0 means 1 degree
    // Against the axis, X has no direction.
    EXPECT_THAT(refusal_of("G0 B-90. C0\nG68.3 X0 Y0 Z0\n", fanuc_with(fork_head(), 1, 1.0)),
                HasSubstr("against X"));
    const Environment open = fanuc_with(fork_head(), 3);
    EXPECT_THAT(refusal_of("G0 B.5\nG68.3 X0 Y0 Z0\n", open), HasSubstr("12322"));
}

TEST(TurnToPlane, ChoosesTheDirectionOfP) {
    const auto tilt = [](const std::string& words, std::optional<double> p1_is_positive) {
        Environment environment = environment_of(trunnion(), DialectId::fanuc);
        if (p1_is_positive)
            environment.control.answers[ControlQuestion::p1_is_positive] = *p1_is_positive;
        const Driven found =
            driven(length_on + "G68.2 X0 Y0 Z0 I20 J30 K10\n" + words + "\n", environment);
        return values_of(found.motions.back().to)[3];
    };
    for (const std::string code : {"G53.1", "G53.6"}) {
        EXPECT_NEAR(tilt(code + " P1", 1), 30.0, 1e-9);
        EXPECT_NEAR(tilt(code + " P2", 1), -30.0, 1e-9);
        EXPECT_NEAR(tilt(code + " P1", 0), -30.0, 1e-9);
        EXPECT_NEAR(tilt(code + " P2", 0), 30.0, 1e-9);
        EXPECT_NEAR(tilt(code + " P1", {}), 30.0, 1e-9) << "the first value is assumed";
        EXPECT_NEAR(std::abs(tilt(code + " P0", {})), 30.0, 1e-9);
    }
    EXPECT_THAT(refusal_of("G68.2 X0 Y0 Z0 I20 J30 K10\nG53.1 P3\n",
                           environment_of(trunnion(), DialectId::fanuc)),
                HasSubstr("from 0 to 2"));
}

TEST(ToolPlane, ToldWhatIsMissing) {
    const Environment known = fanuc_with(fork_head(), 3);
    EXPECT_THAT(refusal_of("G0 B30.\nG68.3 X1.\n", known), HasSubstr("all of X, Y and Z"));
    EXPECT_THAT(refusal_of("G68.2 J30.\nG68.3\n", known), HasSubstr("program G69"));
    const Ran ran = run_text(length_on + "G68.3 X0 Y0 Z0\n", known_environment(DialectId::fanuc));
    ASSERT_TRUE(ran.run.error);
    EXPECT_THAT(ran.run.error->message, HasSubstr("[[machine.axis]]"));
}

} // namespace
} // namespace gcode
