#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

std::string traced(std::string_view text) {
    return trace("G21\n" + std::string(text), DialectId::linuxcnc);
}
std::string warned(std::string_view text) {
    return warnings_of("G21\n" + std::string(text), DialectId::linuxcnc);
}
std::string refused(std::string_view text) { return error_of(text, DialectId::linuxcnc); }

// Expected values were tested with LinuxCNC's interpreter.

TEST(SavedModes, BringBackSpindleCoolantAndWorkOffset) {
    EXPECT_THAT(traced("S300 M3 M8\nM70\nM5 M9 G55\nM72"),
                HasSubstr("spindle direction=clockwise speed=300\nset_offset"));
    EXPECT_THAT(traced("M8\nM70\nM9\nM72"), EndsWith("coolant mist=0 flood=1\n"));
}

TEST(SavedModes, DoNotSwitchOffOtherModes) {
    EXPECT_THAT(traced("M7\nM70\nM8\nM72"), EndsWith("coolant mist=1 flood=1\n"));
    EXPECT_THAT(traced("M7\nM9\nM70\nM8\nM72"), EndsWith("coolant mist=0 flood=0\n"));
    EXPECT_THAT(traced("M70\nM52 P1\nM72"), EndsWith("kind=adaptive_feed enabled=1\n"));
}

TEST(SavedModes, BringBackFeedAndSpeedWithFewDigits) {
    const char* program = "F100.377 S50.6 M3\nM70\nF3 S9\nM72\nG1 X1";
    EXPECT_THAT(traced(program), HasSubstr("speed=51\n"));
    EXPECT_THAT(traced(program), EndsWith("feed=100.4\n"));
    EXPECT_THAT(warned(program), HasSubstr("restored as F100.4, rounded from F100.377"));
    EXPECT_THAT(refused("G21 F100\nM70\nG93\nM72\nG1 X1"), HasSubstr("no feed rate"));
}

TEST(SavedModes, ReportLostModes) {
    EXPECT_THAT(warned("S100 G96 D2000\nM70\nG97 S5\nM72"), HasSubstr("without its limit D2000"));
    EXPECT_THAT(warned("G43.1 Z5\nM70\nG49\nM72"), HasSubstr("that of the tool in the spindle"));
    EXPECT_THAT(warned("o1 sub\nM73\nF3\no1 endsub\nF2.25\no1 call"), HasSubstr("M73: the feed"));
}

TEST(SavedModes, BringBackWhetherG92IsOn) {
    EXPECT_THAT(traced("G92 X3\nM70\nG92.2\nM72\nG0 X0\nG53 G0 X0"), EndsWith(" x=3 y=0 z=0\n"));
    EXPECT_THAT(traced("M70\nG92 X3\nM72\nG0 X1\nG53 G0 X0"), EndsWith(" x=0 y=0 z=0\n"));
}

TEST(LinuxcncState, RemembersThatG92IsOnThoughItIsZero) {
    EXPECT_THAT(traced("G92 X0\nG0 X#5210"), EndsWith(" x=1 y=0 z=0\n"));
    EXPECT_THAT(traced("G92 X0\nG92.2\nG0 X#5210 Y3"), EndsWith(" x=0 y=3 z=0\n"));
    EXPECT_THAT(traced("G92 X5\nG92.2\nG92.2\nG92.3\nG0 X0 Y#5211"), HasSubstr(" x=0 y=-5"));
}

TEST(LinuxcncState, TakesAMotionCodeAloneAsAMoveToTheCurrentPosition) {
    EXPECT_THAT(traced("G0 X1\nG43.1 Z2\nG0"), EndsWith("straight_traverse x=1 y=0 z=-2\n"));
    EXPECT_THAT(refused("G21 G1"), HasSubstr("no feed rate"));
    EXPECT_THAT(refused("G21 F1\nM9 G2"), HasSubstr("G2 has no centre"));
    EXPECT_THAT(refused("G0 G28"), HasSubstr("both use the axis words"));
    EXPECT_EQ(error_of("G0 G90", DialectId::fanuc), "");
}

TEST(LinuxcncState, ReadsWorkOffsetsSetAsParametersWhenTheyAreSelectedAnew) {
    EXPECT_THAT(traced("#5221=7\nG54\nG53 G0 X0"), EndsWith(" x=0 y=0 z=0\n"));
    EXPECT_THAT(traced("#5221=7\nG55\nG54\nG53 G0 X0"), EndsWith(" x=-7 y=0 z=0\n"));
}

TEST(LinuxcncState, MiscalculatesItsPositionWhenG10TurnsUnderG92) {
    const char* program = "G92 Y-21.159\nG10 L2 P1 X-7 R13\nG0 X4";
    EXPECT_THAT(traced(program), HasSubstr("x=4 y=-22.191354 z=0"));
    EXPECT_THAT(warned(program), HasSubstr("loses its position"));
}

TEST(LinuxcncState, RefusesWhatTheControlRefuses) {
    EXPECT_THAT(refused("G21 M19 R400"), HasSubstr("from 0 to 360"));
    EXPECT_THAT(refused("G21 S1\nG96"), HasSubstr("in the same block"));
    EXPECT_THAT(refused("G21\nG92"), HasSubstr("needs an axis word"));
    EXPECT_THAT(refused("G21\nG10 L20 P1 X1 R5"), HasSubstr("use L2"));
    EXPECT_THAT(refused("o1 repeat [2]\no1 break\no1 endrepeat"), HasSubstr("'break' in a"));
    EXPECT_THAT(refused("o1 if [1]\no1 elseif [1/0]\no1 endif"), HasSubstr("division by zero"));
    EXPECT_THAT(refused("o1 sub\no2 sub\no2 endsub\no1 endsub"),
                HasSubstr("a subprogram starts here inside 1, which starts in line 1"));
    EXPECT_THAT(refused("o1 sub\no1 endsub\no1 sub\no1 endsub"),
                HasSubstr("subprogram 1 is defined twice, first in line 1"));
    EXPECT_THAT(refused("o1.5 if [1]\no1.5 endif"), HasSubstr("whole"));
    EXPECT_THAT(refused("o1 if [0]\no2 foo\no1 endif"), HasSubstr("not a keyword"));
    EXPECT_THAT(refused("o1 endif"), HasSubstr("'if' of 1 is missing before this line"));
}

TEST(LinuxcncState, IgnoresTheRestOfALineAfterASkippedOWord) {
    EXPECT_THAT(traced("o1 if [0]\nG0 X1\no1 endif L0\nG0 X2"), EndsWith(" x=2 y=0 z=0\n"));
    EXPECT_THAT(refused("o1 if [1]\no1 endif L0"), HasSubstr("not a keyword"));
}

} // namespace
} // namespace gcode
