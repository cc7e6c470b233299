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
    expect_same_tip_paths(driven_klartext(klartext, machine),
                          driven(fanuc, environment_of(machine, DialectId::fanuc)), 200);
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
    EXPECT_EQ(path("F TCP AXIS POS PATHCTRL AXIS REFPNT TIP-TIP"), core::PathCertainty::known);
    EXPECT_EQ(path("F TCP AXIS POS PATHCTRL AXIS REFPNT TIP-CENTER"), core::PathCertainty::unknown);
    EXPECT_EQ(path("F TCP AXIS POS PATHCTRL VECTOR"), core::PathCertainty{});
    EXPECT_EQ(path("F TCP AXIS POS PATHCTRL AXIS REFPNT CENTER-CENTER"),
              core::PathCertainty::unknown);
}

TEST(KlartextTip, PathctrlVectorTurnsTheToolInAPlane) {
    const auto driven_with = [](const std::string& words) {
        return driven_klartext("FUNCTION TCPM F TCP AXIS POS PATHCTRL " + words
                                   + "\nL X+1 Y+2 Z+3 A+40 FMAX\nL X+30 A+50 C+60 R0 F900\n",
                               trunnion());
    };
    EXPECT_EQ(driven_with("AXIS").motions.size(), 2u);
    const Driven found = driven_with("VECTOR");
    ASSERT_GT(found.motions.size(), 20u);
    const auto direction = [&](size_t i) {
        return core::tool_frame(trunnion(), values_of(found.motions[i].to))[2];
    };
    const Vec3 normal =
        glm::normalize(glm::cross(direction(0), direction(found.motions.size() - 1)));
    for (size_t i = 1; i < found.motions.size(); ++i)
        EXPECT_LT(std::abs(glm::dot(direction(i), normal)), 1e-9);
    // M129 and the next M128 turn the axes evenly again.
    EXPECT_EQ(driven_klartext("FUNCTION TCPM F TCP AXIS POS PATHCTRL VECTOR\nM129\nM128\n"
                              "L X+1 Y+2 Z+3 A+40 FMAX\nL X+30 A+50 C+60 R0 F900\n",
                              trunnion())
                  .motions.size(),
              2u);
}

TEST(KlartextTip, LnTurnsTheToolToItsVector) {
    const core::Machine machine = trunnion();
    std::string vectors = "M128\n";
    for (const Target& target : random_targets()) {
        core::AxisValues values{};
        values[3] = std::abs(target.first) + 1.0, values[5] = target.second;
        const Vec3 d = core::tool_frame(machine, values)[2];
        vectors += fmt::format("LN X{:+.4f} Y{:+.4f} Z{:+.4f} NX+0 NY+0 NZ+1 TX{:+.12f} TY{:+.12f} "
                               "TZ{:+.12f} R0 F900\n",
                               target.tip.x, target.tip.y, target.tip.z, d.x, d.y, d.z);
    }
    const Driven found = driven_klartext(vectors, machine);
    ASSERT_EQ(found.motions.size(), 200u);
    size_t i = 0;
    for (const Target& target : random_targets()) {
        core::AxisValues values{};
        values[3] = std::abs(target.first) + 1.0, values[5] = target.second;
        const core::AxisValues to = values_of(found.motions[i++].to);
        EXPECT_LT(
            glm::distance(core::tool_frame(machine, to)[2], core::tool_frame(machine, values)[2]),
            1e-9);
        EXPECT_LT(glm::distance(core::tip_position(machine, to, tool_length), target.tip + datum),
                  1e-4);
    }
}

/// The direction is Z turned about X by A, then about Y by B, then about Z by C.
TEST(KlartextTip, AxisSpatTurnsTheToolByAnglesInSpace) {
    std::mt19937 random(20261129);
    std::uniform_real_distribution<double> place(-60.0, 60.0), angle(-70.0, 70.0);
    for (const core::Machine& machine : {trunnion(), fork_head()})
        for (const std::string way : {"AXIS", "VECTOR"}) {
            const std::string mode = " PATHCTRL " + way + "\n";
            std::string angles = "FUNCTION TCPM F TCP AXIS SPAT" + mode;
            std::string vectors = "FUNCTION TCPM F TCP AXIS POS" + mode;
            for (int i = 0; i < 100; ++i) {
                const double a = angle(random), b = angle(random), c = angle(random);
                const Vec3 d = about_z(about_y(about_x({0, 0, 1}, a), b), c);
                const std::string at = fmt::format(" X{:+.4f} Y{:+.4f} Z{:+.4f}", place(random),
                                                   place(random), place(random));
                angles +=
                    "L" + at + fmt::format(" A{:+.12f} B{:+.12f} C{:+.12f} R0 F900\n", a, b, c);
                vectors +=
                    "LN" + at
                    + fmt::format(" NX+0 NY+0 NZ+1 TX{:+.15f} TY{:+.15f} TZ{:+.15f} R0 F900\n", d.x,
                                  d.y, d.z);
            }
            const Driven found = driven_klartext(angles, machine);
            EXPECT_GE(found.motions.size(), 100u);
            const Driven other = driven_klartext(vectors, machine);
            expect_same_ends(found, other);
        }
}

TEST(KlartextTip, AxisSpatEndsWithTcpm) {
    // Also if the last FUNCTION TCPM was not followed: A and C are positions again.
    const Driven found =
        driven_klartext("FUNCTION TCPM F TCP AXIS SPAT PATHCTRL AXIS\nL X+1 A+10 B+0 C+20 R0 FMAX\n"
                        "FUNCTION TCPM F TCP AXIS SPAT PATHCTRL AXIS REFPNT CENTER-CENTER\n"
                        "FUNCTION RESET TCPM\nL A+30 FMAX\nL C+50 FMAX\n",
                        trunnion());
    EXPECT_NEAR(*found.motions.back().to[3], 30.0, 1e-9);
    EXPECT_NEAR(*found.motions.back().to[5], 50.0, 1e-9);
    // While it is on and not followed, they are angles.
    const Driven other = driven_klartext(
        "FUNCTION TCPM F TCP AXIS SPAT PATHCTRL AXIS REFPNT CENTER-CENTER\n"
        "L X+1 A+0 B+0 C+0 R0 FMAX\nFUNCTION RESET TCPM\nL X+5 Y+5 Z+50 FMAX\nL Z+40 FMAX\n",
        trunnion());
    EXPECT_EQ(other.paths.back(), core::PathCertainty::unknown)
        << "where the axes stand is unknown";
}

TEST(KlartextTip, AxisSpatNeedsAllAngles) {
    const auto refusal = [](const std::string& lines) {
        const Ran ran = run_text(
            klartext_program("TOOL CALL 1 Z S5000\nFUNCTION TCPM F TCP AXIS SPAT PATHCTRL AXIS\n"
                             + lines),
            environment_of(trunnion(), DialectId::heidenhain));
        return ran.run.error ? ran.run.error->message : std::string();
    };
    EXPECT_EQ(refusal("L X+1 A+10 B+0 C+20 R0 FMAX\nL X+2 FMAX\n"), "");
    EXPECT_THAT(refusal("L X+1 A+10 C+20 R0 FMAX\n"), HasSubstr("all three"));
    EXPECT_THAT(refusal("L IA+10 B+0 C+0 R0 FMAX\n"), HasSubstr("incremental"));
    EXPECT_THAT(refusal("L Z+0 A+10 B+0 C+0 R0 FMAX M91\n"), HasSubstr("M129"));
    EXPECT_EQ(refusal("M128\nL A+10 R0 FMAX\n"), "") << "M128 is with AXIS POS";
    EXPECT_THAT(refusal("CYCL DEF 8.0 MIRROR IMAGE\nCYCL DEF 8.1 X\nL A+10 B+0 C+20 R0 FMAX\n"),
                HasSubstr("mirror image"));
    const Driven bare =
        driven(klartext_program("TOOL CALL 1 Z S5000\nFUNCTION TCPM F TCP AXIS SPAT PATHCTRL AXIS\n"
                                "L X+1 A+10 B+0 C+0 R0 FMAX\n"),
               known_environment(DialectId::heidenhain));
    EXPECT_EQ(bare.paths.back(), core::PathCertainty::unknown);
}

TEST(KlartextTip, LnTurnsTheToolToItsNormalUnderM128) {
    const auto end = [](const std::string& lines) {
        return driven_klartext(lines, trunnion()).motions.back().to;
    };
    const std::string place = "LN X+1 Y+2 Z+30 ", normal = "NX+0.6 NY+0 NZ+0.8 ";
    EXPECT_EQ(end("M128\n" + place + normal + "FMAX\n"),
              end("M128\n" + place + "TX+0.6 TY+0 TZ+0.8 FMAX\n"));
    EXPECT_EQ(end("M128\n" + place + normal + "TX+0 TY+0 TZ+1 FMAX\n"),
              end("M128\n" + place + "TX+0 TY+0 TZ+1 FMAX\n"));
    // Without M128 neither turns it.
    EXPECT_EQ(end(place + normal + "TX+0.6 TY+0 TZ+0.8 FMAX\n"), end(place + "FMAX\n"));
}

TEST(KlartextTip, LnIsRefusedWhereItCompensates) {
    const auto refused = [](const std::string& lines,
                            const std::string& call = "TOOL CALL 1 Z S5000\n") {
        const Ran ran = run_text(klartext_program(call + lines),
                                 environment_of(trunnion(), DialectId::heidenhain));
        return ran.run.error ? ran.run.error->message : std::string();
    };
    EXPECT_EQ(refused("LN X+1 Y+2 Z+3 NX+0 NY+0 NZ+1 R0 FMAX\n"), "");
    EXPECT_THAT(refused("LN X+1 Y+2 Z+3 NX+0 NY+0 NZ+1 FMAX\n", "TOOL CALL 1 Z S5000 DR2-0.1\n"),
                HasSubstr("DR2"));
    EXPECT_EQ(refused("LN X+1 Y+2 Z+3 NX+0 NY+0 NZ+1 FMAX\n", "TOOL CALL 1 Z S5000 DR2+0.00\n"),
              "");
    EXPECT_THAT(refused("LN X+1 Y+2 Z+3 NX+0 NY+0 NZ+1 RL FMAX\n"), HasSubstr("RL"));
    EXPECT_THAT(refused("LN X+1 Y+2 Z+3 NX+0 NY+0 NZ+1 FMAX\n", "TOOL CALL 1 Z S5000 DR+0.1\n"),
                HasSubstr("DL, DR and DR2"));
    EXPECT_THAT(refused("M128\nLN X+1 Y+2 Z+3 TX+0 TY+0 TZ+0 FMAX\n"),
                HasSubstr("no tool direction"));
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
