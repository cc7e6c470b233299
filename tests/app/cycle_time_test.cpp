#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/base/text.h"
#include "tests/app/checked.h"
#include "tests/support/program_writer.h"

namespace app_test {
namespace {

using test_support::first_line;
using test_support::program;
using test_support::SetupWriter;

/// 12 m/min and 1 m/s2 on every axis.
std::string quick_mill() {
    std::string axes;
    for (const char* name : {"X", "Y", "Z"})
        axes += SetupWriter::axis(name, "rapid = 12000\nacceleration = 1000\n");
    return axes;
}

SetupWriter quick_setup() { return SetupWriter().machine(quick_mill()); }

double duration_of(const Checked& checked, int line) { return checked.at_line(line).duration; }

/// Duration of a move from rest to rest, s.
double alone(double length, double speed) { return length / speed + speed / 1000.0; }

TEST(CycleTime, CountsAccelerations) {
    const Checked checked =
        check(quick_setup(),
              program({"G4 P1", "G1 X50. F3000.", "G4 P1500", "G0 Z160.", "G1 Y80. F6000."}));
    EXPECT_NEAR(duration_of(checked, first_line + 1), alone(50, 50), 1e-9);
    EXPECT_NEAR(duration_of(checked, first_line + 2), 1.5, 1e-9);
    EXPECT_NEAR(checked.at_line(first_line + 3).time - checked.at_line(first_line + 1).time,
                alone(50, 50) + 1.5, 1e-9);
}

TEST(CycleTime, ObeysThePathMode) {
    const auto both = [](const std::string& mode) {
        const Checked checked = check(
            quick_setup().program("dialect = \"linuxcnc\"\nstart = { X = -350, Y = -200, Z = 0 }"),
            program({mode, "G4 P1", "G1 X10. F6000.", "X20.", "G4 P1"}));
        return duration_of(checked, first_line + 2) + duration_of(checked, first_line + 3);
    };
    EXPECT_NEAR(both("G61.1"), 2.0 * alone(10, 100), 1e-9);
    EXPECT_NEAR(both("G61"), alone(20, 100), 1e-9);
    EXPECT_NEAR(both("G64 P0.02"), alone(20, 100), 1e-9);
}

TEST(CycleTime, TakesFeedsPerRevolutionAndInverseTime) {
    const SetupWriter setup =
        quick_setup().program("dialect = \"linuxcnc\"\nstart = { X = -350, Y = -200, Z = 0 }");
    const Checked checked = check(setup, program({"G61.1", "G95 G1 X30. F0.5", "G93 X0. F20"}));
    EXPECT_NEAR(duration_of(checked, first_line + 1), alone(30, 0.5 * 6000 / 60), 1e-9);
    EXPECT_NEAR(duration_of(checked, first_line + 2), alone(30, 30.0 * 20 / 60), 1e-9);
}

TEST(CycleTime, StopsForAProgramStop) {
    const Checked checked =
        check(quick_setup(), program({"G1 X10. F6000.", "M0", "X20.", "G4 P0"}));
    EXPECT_NEAR(duration_of(checked, first_line + 2), alone(10, 100), 1e-9);
}

TEST(CycleTime, IsTheEndOfTheLastBlock) {
    const test_support::ScopedFolder folder;
    const std::string part = program({"G1 X50. F3000.", "G3 X50. Y0. I-10. J0.", "G0 Z100."});
    for (const SetupWriter& setup : {SetupWriter(), quick_setup()}) {
        folder.write("part.nc", part);
        folder.write("setup.toml", setup.text());
        const auto ran = feeler(
            {"check", folder / "part.nc", "--setup", folder / "setup.toml", "--format", "json"});
        const auto json = nlohmann::json::parse(ran.out);
        const auto& last = json["blocks"].back();
        EXPECT_NEAR(json["cycle_time"].get<double>(),
                    last["time"].get<double>() + last["duration"].get<double>(), 1e-9);
        EXPECT_GT(json["cycle_time"].get<double>(), 1.0);
        const auto text = feeler({"check", folder / "part.nc", "--setup", folder / "setup.toml"});
        EXPECT_NE(
            text.out.find("cycle time " + app::duration_text(json["cycle_time"].get<double>())),
            std::string::npos)
            << text.out;
    }
}

TEST(CycleTime, NamesUnknownValues) {
    const auto says = [](const std::string& machine, const std::string& words) {
        const Checked checked = check(SetupWriter().machine(machine), program({"G0 Z100."}));
        for (const std::string& assumption : checked.assumptions)
            if (assumption.find(words) != std::string::npos) return true;
        return false;
    };
    EXPECT_TRUE(says(SetupWriter::mill(), "accelerations are ignored"));
    EXPECT_FALSE(says(quick_mill(), "accelerations are ignored"));
    EXPECT_TRUE(says(quick_mill(), "corners are rounded within 0.05 mm"));
    EXPECT_TRUE(says(SetupWriter::axis("X", "acceleration = 100\n"), "at once: Y, Z"));
}

TEST(CycleTime, RefusesAnInvalidAcceleration) {
    const test_support::ScopedFolder folder;
    const SetupWriter setup = SetupWriter().machine(SetupWriter::axis("X", "acceleration = 0\n"));
    const auto ran = feeler({"check", folder.write("part.nc", program({})), "--setup",
                             folder.write("setup.toml", setup.text())});
    EXPECT_EQ(ran.status, 2);
    EXPECT_NE(ran.err.find("acceleration must be above 0"), std::string::npos);
}

/// A post next to the path from X0 to X100, at X25. With acceleration the witness is passed later
/// than with constant speed.
TEST(CycleTime, SaysWhenTheWitnessIsPassed) {
    const auto at = [](const std::string& machine) {
        const Checked checked = check(SetupWriter()
                                          .machine(machine)
                                          .stock("box = [[200, 200, -30], [210, 210, 0]]")
                                          .fixture("post", "box = [[25, 7, 0], [25.1, 20, 80]]"),
                                      program({"G4 P1", "G1 X100. F12000.", "G4 P1"}));
        return checked.at_line(first_line + 1).pair("flutes post").at.value_or(-1.0);
    };
    // The flutes, radius 5 mm, pass the post when their centre is at X25 to X25.1.
    EXPECT_NEAR(at(quick_mill()), (0.2 + (25.0 - 20.0) / 200.0) / alone(100, 200), 1e-2);
    EXPECT_NEAR(at(SetupWriter::mill()), 0.25, 1e-2);
}

} // namespace
} // namespace app_test
