#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;

TEST(Arc, TakesItsCentreFromOffsetsInEveryPlane) {
    EXPECT_EQ(trace("G17 G2 X10 Y0 I5 J0 F100"),
              "select_plane plane=XY\n"
              "arc_feed x=10 y=0 z=0 plane=XY centre=5,0 turns=-1 feed=100\n");
    EXPECT_EQ(trace("G18 G3 X10 Z0 I5 K0 F100"),
              "select_plane plane=ZX\n"
              "arc_feed x=10 y=0 z=0 plane=ZX centre=0,5 turns=1 feed=100\n");
    EXPECT_EQ(trace("G19 G2 Y10 Z0 J5 K0 F100"),
              "select_plane plane=YZ\n"
              "arc_feed x=0 y=10 z=0 plane=YZ centre=5,0 turns=-1 feed=100\n");
}

TEST(Arc, MissingPlaneWordsStayWhereTheyAre) {
    // From a real program: G3X7.5I3.75J0F800 and then a full turn down.
    EXPECT_EQ(trace("G3X7.5I3.75J0F800\nX7.5Y0Z2.I-7.5J0\nI-7.5"),
              "arc_feed x=7.5 y=0 z=0 plane=XY centre=3.75,0 turns=1 feed=800\n"
              "arc_feed x=7.5 y=0 z=2 plane=XY centre=0,0 turns=1 feed=800\n"
              "arc_feed x=7.5 y=0 z=2 plane=XY centre=0,0 turns=1 feed=800\n");
}

TEST(Arc, TakesAPlaneChangeInItsOwnBlock) {
    EXPECT_EQ(trace("G0 Y10 Z5\nG19 G02 Y5 Z0 J0 K-5 F40."),
              "straight_traverse x=0 y=10 z=5\n"
              "select_plane plane=YZ\n"
              "arc_feed x=0 y=5 z=0 plane=YZ centre=10,0 turns=-1 feed=40\n");
}

TEST(Arc, TurnsAsOftenAsPSays) {
    EXPECT_THAT(trace("G2 X10 I5 P3 F100", DialectId::linuxcnc), HasSubstr("turns=-3"));
    EXPECT_THAT(trace("G3 I5 Z2 P2 F100", DialectId::linuxcnc), HasSubstr("turns=2"));
    EXPECT_THAT(error_of("G3 I5 P0 F100", DialectId::linuxcnc), HasSubstr("1:7: P0"));
    EXPECT_THAT(error_of("G3 I5 P1.5 F100", DialectId::linuxcnc), HasSubstr("1:7: P1.5"));
}

TEST(Arc, LosesItsFullTurnsWhereLinuxcncTakesItForLines) {
    const auto error = [](const std::string& mode, const std::string& arc,
                          DialectId id = DialectId::linuxcnc) {
        return error_of("G90 " + mode + "\nG3 X-0.03046 Y1.74497 Z4 I-50 " + arc + " F100", id);
    };
    // Of 2 degrees, two chords are within 0.0076 mm.
    EXPECT_THAT(error("G64 P0.05", "P2"), HasSubstr("LinuxCNC leaves out the full turns"));
    EXPECT_THAT(error("G64 P0.05 Q0.008", "P3"), HasSubstr("G64 Q0.008"));
    EXPECT_EQ(error("G64 P0.05 Q0.007", "P2"), "");
    EXPECT_EQ(error("G64 P0.05 Q0", "P2"), "");
    EXPECT_EQ(error("G64 P0.05", "P1"), "");
    EXPECT_EQ(error("G64", "P2"), "");
    EXPECT_EQ(error("G61", "P2"), "");
}

TEST(Arc, IsAFullCircleIfItsEndsMeetAndRefusedIfThatIsNotCertain) {
    for (const DialectId id : {DialectId::linuxcnc, DialectId::fanuc, DialectId::grbl}) {
        EXPECT_EQ(error_of("G90 G2 X0 Y0 I150 F100", id), "");
        EXPECT_THAT(error_of("G90 G2 X0 Y0.0000001 I150 F100", id),
                    HasSubstr("a full circle or none"));
        EXPECT_EQ(error_of("G90 G2 X0 Y0.01 I150 F100", id), "");
    }
    // 7e-7 radians: Grbl decides by the angle.
    EXPECT_EQ(error_of("G90 G2 X0 Y0.0001 I150 F100", DialectId::linuxcnc), "");
    EXPECT_THAT(error_of("G90 G2 X0 Y0.0001 I150 F100", DialectId::grbl),
                HasSubstr("ends 0.0001 mm from its start"));
}

TEST(Arc, WithARadiusTakesTheShortOrTheLongWay) {
    EXPECT_EQ(trace("G2 X10 Y10 R10 F100"),
              "arc_feed x=10 y=10 z=0 plane=XY centre=10,0 turns=-1 feed=100\n");
    EXPECT_EQ(trace("G3 X10 Y10 R10 F100"),
              "arc_feed x=10 y=10 z=0 plane=XY centre=0,10 turns=1 feed=100\n");
    EXPECT_EQ(trace("G2 X10 Y10 R-10 F100"),
              "arc_feed x=10 y=10 z=0 plane=XY centre=0,10 turns=-1 feed=100\n");
    EXPECT_EQ(trace("G3 X10 Y10 R-10 F100"),
              "arc_feed x=10 y=10 z=0 plane=XY centre=10,0 turns=1 feed=100\n");
    // In the ZX plane the first axis is Z: counterclockwise as seen from +Y is from Z to X.
    EXPECT_EQ(trace("G18 G3 X10 Z10 R10 F100"),
              "select_plane plane=ZX\n"
              "arc_feed x=10 y=0 z=10 plane=ZX centre=0,10 turns=1 feed=100\n");
    EXPECT_EQ(trace("G19 G2 Y10 Z10 R10 F100"),
              "select_plane plane=YZ\n"
              "arc_feed x=0 y=10 z=10 plane=YZ centre=10,0 turns=-1 feed=100\n");
}

TEST(Arc, ARadiusOfHalfTheChordIsASemicircle) {
    EXPECT_EQ(trace("G2 X10 R5 F100"),
              "arc_feed x=10 y=0 z=0 plane=XY centre=5,0 turns=-1 feed=100\n");
    EXPECT_EQ(error_of("G2 X10 R4.9995 F100"), "");
    EXPECT_EQ(error_of("G2 X10 R4.99 F100"), "1:8: R4.99: the radius 4.9900 mm is too small to "
                                             "reach the end point: half the distance is 5.0000 mm");
    // Fanuc does not move; other controls refuse it.
    EXPECT_EQ(error_of("G2 R5 F100 X0"), "");
    EXPECT_THAT(error_of("G21 G2 R5 F100 X0", DialectId::linuxcnc),
                HasSubstr("R5: an arc with R cannot end where"));
}

TEST(Arc, AbsoluteCentresAreProgramCoordinates) {
    EXPECT_EQ(trace("G21 G90.1 G0 X10\nG2 X20 I15 J0 F100", DialectId::linuxcnc),
              "straight_traverse x=10 y=0 z=0\n"
              "arc_feed x=20 y=0 z=0 plane=XY centre=15,0 turns=-1 feed=100\n");
    EXPECT_THAT(error_of("G90.1\nG2 X10 I5 F100", DialectId::linuxcnc),
                HasSubstr("2:1: G2: with G90.1 an arc needs both words of its centre"));
    EXPECT_EQ(error_of("G90.1\nG91.1\nG2 X10 I5 F100", DialectId::linuxcnc), "");
}

TEST(Arc, RefusesRadiiThatDifferAndNamesBoth) {
    EXPECT_EQ(error_of("G2 X10 Y1 I5 F100"),
              "1:1: G2: the radius of the arc is 5.0000 mm at its start and 5.0990 mm at its end");
    EXPECT_EQ(error_of("G0 X1\nG3 F100\nX11 Y1 I5"),
              "3:1: G3: the radius of the arc is 5.0000 mm at its start and 5.0990 mm at its end");
}

TEST(Arc, WarnsOfSmallDifferencesWhereTheControlHasAParameter) {
    EXPECT_EQ(warnings_of("G21 G2 X10.004 I5. F100\nM30"), "");
    EXPECT_THAT(warnings_of("G21 G2 X10.04 I5 F100\nM30"),
                HasSubstr("G2: the radius of the arc is 5.0000 mm at its start and 5.0400"));
    EXPECT_THAT(error_of("G21 G2 X10.052 I5 F100"), HasSubstr("5.0520 mm at its end"));
}

TEST(Arc, LinuxcncAllowsAThousandthOfTheRadius) {
    // LinuxCNC refuses abs_err > tolerance with rel_err > 0.001, and always 100 times the
    // tolerance.
    EXPECT_EQ(error_of("G21 G2 X10.028 I5 F100", DialectId::linuxcnc), "");
    EXPECT_THAT(error_of("G21 G2 X10.029 I5 F100", DialectId::linuxcnc), HasSubstr("1:5: G2"));
    EXPECT_EQ(error_of("G21 G2 X1000.4 I500 F100", DialectId::linuxcnc), "");
    EXPECT_THAT(error_of("G21 G2 X1000.6 I500 F100", DialectId::linuxcnc), HasSubstr("1:5: G2"));
    EXPECT_THAT(error_of("G21 G2 X10003 I5000 F100", DialectId::linuxcnc), HasSubstr("1:5: G2"));
}

TEST(Arc, NeedsACentreAndARadius) {
    EXPECT_THAT(error_of("G2 X10 F100"), HasSubstr("1:1: G2 has no centre: it needs I, J or R"));
    EXPECT_THAT(error_of("G2 X10 F100"), HasSubstr("3403#5"));
    EXPECT_THAT(error_of("G18 G2 X10 F100"),
                HasSubstr("1:5: G2 has no centre: it needs K, I or R"));
    EXPECT_THAT(error_of("G2 X10 I0 J0 F100"), HasSubstr("1:1: G2: the arc has no radius"));
}

TEST(Arc, RefusesTheOffsetOfAnotherPlane) {
    EXPECT_EQ(error_of("G2 X10 I5 K2 F100", DialectId::linuxcnc),
              "1:11: K2: G2 does not use this word here");
    EXPECT_THAT(warnings_of("G2 X10 I5 K2 F100"), HasSubstr("K2: G2 does not use this word here"));
    EXPECT_THAT(error_of("G2 X10 I5 R5 F100", DialectId::linuxcnc), HasSubstr("1:8: I5"));
}

TEST(Arc, FromAnUnknownPositionIsAnError) {
    const Environment unknown{.dialect = DialectId::fanuc};
    const Ran ran = run_text("G0 X0\nG2 X10 I5 F100\n", unknown);
    ASSERT_TRUE(ran.run.error);
    EXPECT_EQ(ran.run.error->where.line, 2u);
    EXPECT_THAT(ran.run.error->message,
                HasSubstr("G2: the start position of the arc is unknown in Y"));
    EXPECT_FALSE(run_text("G0 X0 Y0\nG2 X10 I5 F100\n", unknown).run.error);
}

TEST(Arc, NeedsAFeedRate) {
    EXPECT_THAT(error_of("G2 X10 I5"), HasSubstr("1:1: G2: no feed rate"));
}

} // namespace
} // namespace gcode
