#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;

/// With G54 at 100, 0, rotated by 30 degrees, G55 at 10, 20, -3, and other stored values.
std::string traced_with(std::map<int, double> kept, std::string_view text,
                        DialectId dialect = DialectId::linuxcnc) {
    Environment environment = known_environment(dialect);
    environment.work_offsets[0] = {100.0};
    environment.work_offsets[1] = {10.0, 20.0, -3.0};
    kept[5230] = 30.0;
    environment.parameters = kept;
    const Ran ran = run_text("G21\n" + std::string(text), environment);
    return ran.run.error ? ran.run.error->message : commands_of(ran.run);
}

std::string traced(std::string_view text) {
    return trace("G21\n" + std::string(text), DialectId::linuxcnc);
}
std::string refused(std::string_view text) {
    return error_of("G21\n" + std::string(text), DialectId::linuxcnc);
}

// Expected values were tested with LinuxCNC's interpreter.

TEST(StoredOffsets, AreInEffectAtTheStart) {
    EXPECT_EQ(traced_with({{5220, 2.0}}, "G53 G0 X0 Y0 Z0"), "straight_traverse x=-10 y=-20 z=3\n");
    EXPECT_EQ(traced_with({{5220, 2.0}, {5210, 1.0}, {5211, 0.5}, {5212, 0.25}},
                          "G53 G0 X0 Y0 Z0\n(print,%d#5220 #5210)"),
              "straight_traverse x=-10.5 y=-20.25 z=3\nmessage text=2 1\n");
}

TEST(StoredOffsets, LeaveG92OutThatIsSuspended) {
    EXPECT_EQ(traced_with({{5220, 2.0}, {5210, 0.0}, {5211, 0.5}}, "G53 G0 X0 Y0 Z0"),
              "straight_traverse x=-10 y=-20 z=3\n");
    EXPECT_THAT(traced_with({{5220, 2.0}, {5211, 0.5}}, "G92.3\nG53 G0 X0 Y0 Z0"),
                HasSubstr("straight_traverse x=-10.5 y=-20 z=3\n"));
}

TEST(StoredOffsets, AreG54WhereTheNumberIsNone) {
    for (const double number : {0.0, 1.0, 10.0, -3.0, 1e300})
        EXPECT_EQ(traced_with({{5220, number}, {5230, 0.0}}, "(print,%d#5220)"),
                  "message text=1\n");
}

TEST(MachineCoordinates, NeedAMove) {
    EXPECT_THAT(refused("G53"), HasSubstr("2:1: G53 applies to its own block only"));
    EXPECT_THAT(refused("G0 X1\nG53 M3 S100"), HasSubstr("3:1: G53 applies to its own block only"));
    EXPECT_EQ(refused("G53 G0"), "");
}

TEST(MachineCoordinates, AreRefusedUnderG91AndInPolarWords) {
    EXPECT_THAT(refused("G91 G53 G0 X5"),
                HasSubstr("2:5: G53 with G91 stops some controls and is ignored by others"));
    EXPECT_EQ(refused("G91\nG53 G90 G0 X5"), "");
    EXPECT_THAT(refused("G53 G0 @5 ^3"),
                HasSubstr("2:8: @5: @ and ^ are relative to the program origin"));
}

TEST(MachineCoordinates, OfRotaryAxesIgnoreTheTool) {
    EXPECT_THAT(traced("G43.1 A3 Z2\nG53 G0 A10 Z0"), HasSubstr("z=-2 a=10\n"));
}

TEST(Home, IsReachedAlongTheProgramsAxesWhereTheWorkIsTurned) {
    EXPECT_THAT(traced("G10 L2 P1 X10 Y20 R30\nG0 X1 Y2\nG28.1\nG0 X10 Y10\nG28 X5"),
                HasSubstr("straight_traverse x=5 y=10 z=0\nstraight_traverse x=1 y=10 z=0\n"));
}

TEST(Arcs, AreRefusedInThePlanesOfSecondaryAxes) {
    EXPECT_THAT(refused("G17.1 F100\nG2 U10 V0 I5 J0"),
                HasSubstr("3:1: G2: arcs are not possible in the G17.1"));
}

TEST(ToolEntries, NeedAValue) {
    for (const char* code : {"G10 L1 P5", "G10 L10 P5", "G10 L11 P5"})
        EXPECT_THAT(refused(code), HasSubstr("2:1: G10 has no value for the tool table"));
    EXPECT_EQ(refused("G10 L1 P5 R2"), "");
}

TEST(Tapping, TakesTheOverridesAwayThatATurnedThreadLeftOn) {
    const std::string text = traced("S100 M3 F100 G0 Z10 X20\nM49\nG76 P1 Z-5 I-1 J0.3 K1 R1\n"
                                    "G84 X5 Z-2 R2");
    const size_t thread = text.rfind("thread_feed"), tap = text.find("z=-2 ", thread);
    ASSERT_NE(tap, std::string::npos) << text;
    EXPECT_THAT(text.substr(thread, tap - thread),
                HasSubstr("enable_override kind=feed enabled=0\n"));
    EXPECT_THAT(text.substr(tap), testing::Not(HasSubstr("enabled=1")));
}

TEST(Units, AreNotMissedByWordsThatAreNoLengths) {
    for (const char* text : {"M61 Q2", "M3 S100\nM19 R90", "M66 P1 L3 Q2"})
        EXPECT_THAT(warnings_of(text, DialectId::linuxcnc), testing::Not(HasSubstr("no units")))
            << text;
    EXPECT_THAT(warnings_of("G0 X1", DialectId::linuxcnc), HasSubstr("no units (G"));
}

TEST(IniValues, AreReadByNameAndMissingIfTheFileHasNone) {
    Environment environment = known_environment(DialectId::linuxcnc);
    environment.ini_values["_ini[setup]xpos"] = 3.5;
    const Ran ran = run_text("G21\nG0 X#<_ini[setup]xpos> Y[EXISTS[#<_INI[Setup]XPos>]]\n"
                             "Z[EXISTS[#<_ini[setup]y>]]\nX#<_ini[setup]y>",
                             environment);
    EXPECT_EQ(commands_of(ran.run), "straight_traverse x=3.5 y=1 z=0\n"
                                    "straight_traverse x=3.5 y=1 z=0\n");
    ASSERT_TRUE(ran.run.error);
    EXPECT_EQ(ran.run.error->message, "#<_ini[setup]y> is used before it is set");
}

TEST(Messages, WriteFourDigitsFromPercentFOn) {
    EXPECT_EQ(traced("#5=3.14159265\n(print,#5 %f#5 %.2f#5 %d#5)"),
              "message text=3.141593 3.1416 3.14 3\n");
}

} // namespace
} // namespace gcode
