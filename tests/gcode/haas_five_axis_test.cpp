#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/driven_machine.h"

namespace gcode {
namespace {

using core::PathCertainty;
using core::Vec3;
using testing::HasSubstr;

const std::string begin = "G21 G90 G94 G17 G54\nT1 M6\n";

Driven driven_haas(const std::string& lines, const core::Machine& machine = trunnion()) {
    return driven(begin + lines, environment_of(machine, DialectId::haas));
}

std::string refused(const std::string& lines, const Environment& environment) {
    const Ran ran = run_text(begin + lines, environment);
    return ran.run.error ? ran.run.error->message : std::string();
}

TEST(HaasFiveAxis, G234FollowsTheTipAsG434Does) {
    const std::string moves = "G0 X1. Y2. Z60. A10. C5.\nG1 X-20. Y3. Z5. A-35. C80. F500.\nC-20.\n"
                              "G49\nG0 A0. C0.\n";
    expect_same_motions(
        driven_haas("G234 H1\n" + moves),
        driven(begin + "G43.4 H1\n" + moves, environment_of(trunnion(), DialectId::fanuc)));
}

TEST(HaasFiveAxis, G268AndG253AreATiltedPlane) {
    const std::string moves = "G0 X5. Y-3. Z40.\nG1 Z-2. F100.\nX9.\nG0 Z40.\n";
    expect_same_motions(
        driven_haas("G43 H1 Z100.\nG268 X3. Y4. Z-5. I25. J10. K30. Q123\nG253\n" + moves
                    + "G269\nG0 X0 Y0\n"),
        driven(begin + "G43 H1 Z100.\nG68.2 P1 X3. Y4. Z-5. I25. J10. K30. Q123\nG53.1\n" + moves
                   + "G69\nG0 X0 Y0\n",
               environment_of(trunnion(), DialectId::fanuc)));
    const Environment haas = environment_of(trunnion(), DialectId::haas);
    EXPECT_THAT(refused("G268 X0 Y0 Z0 I10. J0 K0\n", haas), HasSubstr("Q123"));
    EXPECT_THAT(refused("G253\n", haas), HasSubstr("G268"));
}

/// With the rotary axes anywhere, a point of the program is where the work offset has turned to,
/// plus the coordinates along the axes of the machine.
TEST(HaasFiveAxis, G254ShiftsTheWorkOffsetToWhereTheTableHasTurnedIt) {
    const core::Machine machine = trunnion();
    std::mt19937 random(9);
    std::uniform_real_distribution<double> degrees(-90.0, 90.0), mm(-50.0, 50.0);
    for (int i = 0; i < 100; ++i) {
        const double a = degrees(random), c = degrees(random);
        const Vec3 at(mm(random), mm(random), mm(random));
        const Driven found =
            driven_haas(fmt::format("G43 H1\nG0 X0. Y0. Z90.\nG53 G0 Z0\nG0 A{:.4f} C{:.4f}\nG254\n"
                                    "G0 X{:.4f} Y{:.4f}\nZ{:.4f}\nG255\n",
                                    a, c, at.x, at.y, at.z),
                        machine);
        core::AxisValues values{};
        values[3] = std::round(a * 1e4) / 1e4, values[5] = std::round(c * 1e4) / 1e4;
        const Vec3 origin =
            core::machine_from_link(machine, machine.table, values) * Vec3(-12.0, 31.0, -380.0);
        const core::AxisPosition& to = found.motions.back().to;
        EXPECT_NEAR(*to[0], origin.x + at.x, 1e-3);
        EXPECT_NEAR(*to[1], origin.y + at.y, 1e-3);
        EXPECT_NEAR(*to[2], origin.z + at.z + tool_length, 1e-3);
        for (const PathCertainty path : found.paths) EXPECT_EQ(path, PathCertainty::known);
    }
}

TEST(HaasFiveAxis, G254EndsBeforeATurnOrAnotherOffset) {
    const Environment haas = environment_of(trunnion(), DialectId::haas);
    const std::string on = "G43 H1\nG0 X0. Y0. Z90.\nG53 G0 Z0\nA30. C40.\nG254\nX1. Y1.\nZ50.\n";
    EXPECT_EQ(refused(on + "G255\nG53 G0 Z0\nA0. C0.\n", haas), "");
    EXPECT_EQ(refused(on + "M30\n", haas), "");
    for (const std::string line : {"G0 A10.", "G91 C5.", "G28 A0"})
        EXPECT_THAT(refused(on + line + "\n", haas), HasSubstr("program G255 before")) << line;
    for (const std::string line : {"G55", "G52 X1."})
        EXPECT_THAT(refused(on + line + "\n", haas), HasSubstr("offset changes while G254"))
            << line;
    for (const std::string line : {"G234 H1", "G43.4 H1", "G268 X0 Y0 Z0 I10. J0 K0 Q123"})
        EXPECT_THAT(refused(on + line + "\n", haas), HasSubstr("with G255")) << line;
    EXPECT_THAT(refused("G234 H1\nG254\n", haas), HasSubstr("with G49"));
}

TEST(HaasFiveAxis, G69AndG269LeaveG254On) {
    const auto end = [](const std::string& lines) {
        return *driven_haas("G43 H1\nG0 X0. Y0. Z90.\nG53 G0 Z0\nA30. C40.\nG254\n" + lines
                            + "G0 X1. Y2. Z50.\n")
                    .motions.back()
                    .to[1];
    };
    EXPECT_EQ(end("G69\n"), end(""));
    EXPECT_EQ(end("G269\n"), end(""));
    EXPECT_NE(end("G255\n"), end(""));
}

TEST(FanucFiveAxis, G536TurnsAboutTheTip) {
    const core::Machine machine = trunnion();
    const Environment fanuc = environment_of(machine, DialectId::fanuc);
    const std::string plane = "G43 H1\nG0 X5. Y6. Z40.\nG68.2 X0 Y0 Z0 I20. J30. K0\n";
    const Driven found = driven(begin + plane + "G53.6\n", fanuc);
    const core::Motion& turn = found.motions.back();
    EXPECT_LT(glm::distance(core::tip_position(machine, values_of(turn.from), tool_length),
                            core::tip_position(machine, values_of(turn.to), tool_length)),
              1e-9);
    ASSERT_TRUE(turn.tip);
    EXPECT_LT(glm::distance(turn.tip->from, turn.tip->to), 1e-9);
    const Driven other = driven(begin + plane + "G53.1\n", fanuc);
    for (size_t axis = 3; axis < 6; ++axis) EXPECT_EQ(turn.to[axis], other.motions.back().to[axis]);
    for (const std::string word : {"H2", "R10."})
        EXPECT_THAT(refused(plane + "G53.6 " + word + "\n", fanuc),
                    HasSubstr("program G53.6 without"));
}

TEST(HaasFiveAxis, G254NeedsOffsetsOfRotaryAxesOf0) {
    Environment environment = environment_of(trunnion(), DialectId::haas);
    environment.work_offsets[0][5] = 10.0;
    EXPECT_THAT(refused("G254\n", environment), HasSubstr("must be 0"));
}

TEST(HaasFiveAxis, G254WithoutTheMachineIsUndecidedOnceTheWorkIsTurned) {
    const Driven found = driven(begin + "G254\nG0 X1. Y1. Z50.\nA30.\nX5.\nA0.\nX0 Y0 Z50.\nG255\n",
                                known_environment(DialectId::haas));
    EXPECT_EQ(found.paths[0], PathCertainty::known);
    EXPECT_EQ(found.paths[1], PathCertainty::unknown);
    EXPECT_EQ(found.paths[2], PathCertainty::unknown);
    EXPECT_EQ(found.paths.back(), PathCertainty::known);
}

} // namespace
} // namespace gcode
