#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/driven_machine.h"

namespace gcode {
namespace {

using core::Vec3;
using testing::HasSubstr;

struct Target {
    Vec3 tip;
    double first, second; // A and C, or B and C
};

std::vector<Target> random_targets() {
    std::mt19937 random(20261127);
    std::uniform_real_distribution<double> place(-120.0, 120.0), tilt(-80.0, 80.0), turn(-170, 170);
    std::vector<Target> targets(200);
    for (Target& target : targets)
        target = {{place(random), place(random), place(random)}, tilt(random), turn(random)};
    return targets;
}

/// The same moves under M128 and under Fanuc's G43.4, whose motions are tested against sampling.
void expect_as_g434(const core::Machine& machine, char first) {
    std::string klartext = "M128\n", fanuc = "G21 G90 G94\nT1 M6\nG43.4 H1\n";
    for (const Target& target : random_targets()) {
        const std::string places =
            fmt::format(" X{:+.4f} Y{:+.4f} Z{:+.4f} {}{:+.4f} C{:+.4f}", target.tip.x,
                        target.tip.y, target.tip.z, first, target.first, target.second);
        klartext += "L" + places + " R0 F900\n";
        fanuc += "G1" + places + " F900\n";
    }
    Environment of_fanuc = environment_of(machine, DialectId::fanuc);
    const Driven a = driven_klartext(klartext, machine), b = driven(fanuc, of_fanuc);
    ASSERT_EQ(a.motions.size(), 200u);
    ASSERT_EQ(b.motions.size(), 200u);
    for (size_t i = 0; i < a.motions.size(); ++i) {
        ASSERT_TRUE(a.motions[i].tip && b.motions[i].tip) << i;
        for (size_t axis = 0; axis < 6; ++axis)
            ASSERT_NEAR(a.motions[i].to[axis].value_or(-1e9), b.motions[i].to[axis].value_or(1e9),
                        1e-9)
                << i;
        EXPECT_LT(glm::distance(a.motions[i].tip->to, b.motions[i].tip->to), 1e-9);
    }
    for (const core::PathCertainty path : a.paths) EXPECT_EQ(path, core::PathCertainty{});
}

TEST(KlartextTip, IsDrivenAsFanucDrivesIt) {
    expect_as_g434(trunnion(), 'A');
    expect_as_g434(fork_head(), 'B');
}

/// With the work clamped at G54, the tip is at the programmed point of the work, which turns with
/// the table.
TEST(KlartextTip, IsWhereTheProgramSaysOnTheWork) {
    const core::Machine machine = trunnion();
    for (const Target& target : random_targets()) {
        const Driven found = driven_klartext(
            fmt::format("M128\nL X{:+.4f} Y{:+.4f} Z{:+.4f} A{:+.4f} C{:+.4f} R0 FMAX\n",
                        target.tip.x, target.tip.y, target.tip.z, target.first, target.second),
            machine);
        ASSERT_EQ(found.motions.size(), 1u);
        const Vec3 tip = core::tip_position(machine, values_of(found.motions[0].to), tool_length);
        EXPECT_LT(glm::distance(tip, target.tip + Vec3(-12.0, 31.0, -380.0)), 1e-4);
    }
}

TEST(KlartextTip, StaysWhenOnlyARotaryAxisTurns) {
    const core::Machine machine = trunnion();
    const Driven found =
        driven_klartext("L X+30 Y-20 Z+15 R0 FMAX\nM128\nL A+35 FMAX\nL C-70 FMAX M129\n"
                        "L A+0 FMAX\n",
                        machine);
    ASSERT_EQ(found.motions.size(), 4u);
    const auto tip = [&](size_t i) {
        return core::tip_position(machine, values_of(found.motions[i].to), tool_length);
    };
    EXPECT_LT(glm::distance(tip(0), tip(1)), 1e-9);
    EXPECT_LT(glm::distance(tip(0), tip(2)), 1e-9) << "M129 acts at the end of its block";
    EXPECT_EQ(found.motions[3].to[0], found.motions[2].to[0]) << "X stays on the machine";
    EXPECT_EQ(found.motions[3].to[2], found.motions[2].to[2]);
}

TEST(KlartextTip, FunctionTcpmIsFollowedIfItActsLikeM128) {
    const auto path = [](const std::string& words) {
        const Driven found =
            driven_klartext("FUNCTION TCPM " + words + "\nL X+1 Y+2 Z+3 A+30 FMAX\n", trunnion());
        return found.paths.empty() ? core::PathCertainty{} : found.paths.back();
    };
    EXPECT_EQ(path("F TCP AXIS POS PATHCTRL AXIS"), core::PathCertainty{});
    EXPECT_EQ(path("F CONT AXIS POS PATHCTRL AXIS"), core::PathCertainty{});
    EXPECT_EQ(path("F TCP AXIS SPAT PATHCTRL AXIS"), core::PathCertainty::unknown);
    EXPECT_EQ(path("F TCP AXIS POS PATHCTRL VECTOR"), core::PathCertainty::unknown);
    EXPECT_EQ(path("F TCP AXIS POS PATHCTRL AXIS REFPNT CENTER-CENTER"),
              core::PathCertainty::unknown);
}

TEST(KlartextTip, IsNotFollowedWhereNobodyKnowsWhatTheAxesDo) {
    const Driven found = driven_klartext("M128\nL A+30 FMAX\nL X+0 Y+0 Z+0 FMAX M91\n", trunnion());
    EXPECT_EQ(found.paths.front(), core::PathCertainty{});
    EXPECT_EQ(found.paths.back(), core::PathCertainty::unknown);
    EXPECT_THAT(found.warnings, HasSubstr("while M128 is on"));
    // Without the rotary axes of the machine.
    const Driven bare = driven(klartext_program("M128\nL X+1 Y+1 Z+1 A+30 FMAX\n"),
                               known_environment(DialectId::heidenhain));
    EXPECT_EQ(bare.paths.back(), core::PathCertainty::unknown);
}

} // namespace
} // namespace gcode
