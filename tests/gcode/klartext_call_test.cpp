#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/klartext_programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* drilling = "TOOL CALL 1 Z S1000 F250\nL X+0 Y+0 Z+100 R0 FMAX M3\n"
                                 "CYCL DEF 200 DRILLING Q200=2 Q201=-10 Q206=150 Q202=40 Q210=0 "
                                 "Q203=5 Q204=50 Q211=0\n";

// Heidenhain TNC 640, cycle programming: the parameters of a cycle are global Q parameters.
TEST(KlartextCycles, TakeTheirParametersAtTheCall) {
    const std::string text = klartext(std::string(drilling)
                                      + "CYCL CALL\nFN 0: Q201 = -28\nCYCL CALL\n"
                                        "FN 0: Q206 = 99\nL X+5 R0 FMAX M99\n");
    EXPECT_THAT(text, HasSubstr("z=-5 feed=150"));
    EXPECT_THAT(text, HasSubstr("x=0 y=0 z=-23 feed=150"));
    EXPECT_THAT(text, HasSubstr("x=5 y=0 z=-23 feed=99"));
    EXPECT_THAT(klartext_error(std::string(drilling) + "FN 0: Q395 = 1\nCYCL CALL\n"),
                HasSubstr("Q395=1"));
}

TEST(KlartextCycles, DoubtTheWayOnThePitchCircle) {
    const auto warnings = [](const std::string& way) {
        return warnings_of(klartext_program(std::string(drilling)
                                            + "CYCL DEF 220 POLAR PATTERN Q216=50 Q217=50 Q244=80 "
                                              "Q245=0 Q246=360 Q247=0 Q241=4 Q200=2 Q203=0 Q204=50 "
                                              "Q301=0 Q365="
                                            + way + "\n"),
                           DialectId::heidenhain);
    };
    EXPECT_THAT(warnings("1"), HasSubstr("on the pitch circle"));
    EXPECT_THAT(warnings("0"), Not(HasSubstr("on the pitch circle")));
}

TEST(KlartextCycles, ReadNamesWithPoints) {
    const std::string pecking = "TOOL CALL 1 Z S1000\nL X+0 Y+0 Z+100 R0 FMAX M3\n"
                                "CYCL DEF 1.0 TIEFBOHREN\nCYCL DEF 1.1 ABST 2\n"
                                "CYCL DEF 1.2 TIEFE -20\nCYCL DEF 1.3 ZUSTLG 5\n";
    const std::string rest = "CYCL DEF 1.5 F200\nL Z+2 R0 FMAX M99\n";
    EXPECT_EQ(klartext(pecking + "CYCL DEF 1.4 V.ZEIT 0.5\n" + rest),
              klartext(pecking + "CYCL DEF 1.4 DWELL .5\n" + rest));
    EXPECT_EQ(klartext_error(pecking + "CYCL DEF 1.4 V.ZEIT 0\n" + rest), "");
}

TEST(KlartextCodes, SayWhatMayIntervene) {
    const auto warnings = [](const std::string& code) {
        return warnings_of(klartext_program("L X+0 R0 FMAX " + code + "\n"), DialectId::heidenhain);
    };
    EXPECT_THAT(warnings("M118 X1 Y1"), HasSubstr("shifts by the handwheel"));
    EXPECT_THAT(warnings("M101"), HasSubstr("replacement tool"));
    EXPECT_THAT(klartext_error("L X+0 R0 FMAX M104\n"), HasSubstr("CYCL DEF 247"));
}

} // namespace
} // namespace gcode
