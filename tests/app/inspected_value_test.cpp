#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/debug/inspected_value.h"
#include "core/motion/machine.h"
#include "gcode/exec/interpreter.h"
#include "gcode/language/dialect.h"
#include "gcode/language/environment.h"
#include "gcode/text/source.h"
#include "tests/support/whole_run.h"

namespace app_test {
namespace {

using gcode::DialectId;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

/// A control and its state after a program.
struct Control {
    gcode::Environment environment;
    gcode::InterpreterState state;

    Control(const std::string& program, DialectId dialect) {
        environment.dialect = dialect;
        environment.start = gcode::zero_position;
        environment.work_offsets[1] = {-300.0, -200.0, -100.0};
        environment.length_offsets[core::OffsetNumber{3}].length = 95.0;
        environment.length_offsets[core::OffsetNumber{3}].diameter = 10.0;
        const gcode::Run run = gcode::run(*gcode::program_from_text(program), environment);
        EXPECT_FALSE(run.error) << run.error->message;
        state = run.state;
    }

    std::string text(const std::string& name) const {
        const auto value = app::value_of(name, state, environment);
        return value ? value->text : value.error().message;
    }
    std::string meaning(const std::string& name) const {
        return app::value_of(name, state, environment)->meaning;
    }
};

std::vector<std::string> names_of(const std::vector<app::NamedValue>& values) {
    std::vector<std::string> names;
    for (const app::NamedValue& value : values)
        names.push_back(value.name + "=" + value.value.text);
    return names;
}

TEST(InspectedValue, ShowsModesAsCodesWithTheirMeaning) {
    const Control control("G20 G91 G18 G55 G95\nT3 M6\nS500 M4\nM8\nF0.01 G1 X1\n"
                          "G43 H3 Z1\nG41 D3 X2\n",
                          DialectId::fanuc);
    EXPECT_EQ(control.text("plane"), "G18");
    EXPECT_EQ(control.meaning("plane"), "ZX");
    EXPECT_EQ(control.text("unit"), "G20");
    EXPECT_EQ(control.text("distance"), "G91");
    EXPECT_EQ(control.meaning("spindle"), "counterclockwise");
    EXPECT_EQ(control.text("coolant"), "M8");
    EXPECT_EQ(control.text("feed"), "0.254 mm/rev");
    EXPECT_EQ(control.text("speed"), "500 rev/min");
    EXPECT_EQ(control.text("tool"), "T3");
    EXPECT_EQ(control.text("length"), "95 mm");
    EXPECT_EQ(control.text("length_number"), "H3");
    EXPECT_EQ(control.text("offset"), "G55");
    EXPECT_EQ(control.text("motion"), "G1");
    EXPECT_EQ(control.text("H3"), "95 mm");
    EXPECT_EQ(control.text("d3"), "10 mm");
    EXPECT_EQ(control.text("H4"), "not in the table");
    EXPECT_EQ(control.text("G55"), "X-300 Y-200 Z-100");
    EXPECT_EQ(control.text("G55.y"), "-200 mm");
}

TEST(InspectedValue, ShowsThePositionsOfTipAndMachine) {
    const Control control("G21 G90 G55\nG43 H3\nG0 X10 Y20 Z30\n", DialectId::fanuc);
    EXPECT_EQ(control.text("x"), "10 mm");
    EXPECT_EQ(control.text("machine.x"), "-290 mm");
    EXPECT_EQ(control.text("Machine.Z"), "25 mm");
    EXPECT_THAT(names_of(app::axis_values(control.state)),
                testing::ElementsAre("x=10 mm", "y=20 mm", "z=30 mm", "machine.x=-290 mm",
                                     "machine.y=-180 mm", "machine.z=25 mm"));
}

TEST(InspectedValue, ReadsParametersAsTheControlNamesThem) {
    const Control fanuc("#1=4\n#100=7.5\nG0 X1\n", DialectId::fanuc);
    EXPECT_EQ(fanuc.text("#100"), "7.5");
    EXPECT_EQ(fanuc.text("#1"), "4");
    EXPECT_EQ(fanuc.text("#2"), "not set");
    EXPECT_EQ(fanuc.text("#4003"), "90"); // the code of G90 in #4003
    EXPECT_THAT(fanuc.text("R5"), HasSubstr("#1, #2"));
    const Control linuxcnc("#<_gap>=2\n#<own>=3\n#31=9\n#5=1\nG0 X1\nM2\n", DialectId::linuxcnc);
    EXPECT_EQ(linuxcnc.text("#<_GAP>"), "2");
    EXPECT_EQ(linuxcnc.text("#<own>"), "3");
    EXPECT_EQ(linuxcnc.text("#<other>"), "not set");
    EXPECT_THAT(names_of(app::parameter_values(linuxcnc.state, linuxcnc.environment)),
                AllOf(Contains("#5=1"), Contains("#31=9"), Contains("#<own>=3"),
                      Contains("#<_gap>=2"), Not(Contains("#6=0"))));
    const Control siemens("DEF REAL GAP=2.5\nR5=3\nR0=4\nG0 X1\nM30\n", DialectId::siemens);
    EXPECT_EQ(siemens.text("R5"), "3");
    EXPECT_EQ(siemens.text("r0"), "4");
    EXPECT_EQ(siemens.text("gap"), "2.5");
    EXPECT_EQ(siemens.text("$AA_IM[X]"), "1");
    EXPECT_THAT(siemens.text("#5"), HasSubstr("R1, R2"));
    EXPECT_THAT(names_of(app::parameter_values(siemens.state, siemens.environment)),
                AllOf(Contains("R5=3"), Contains("R0=4"), Contains("gap=2.5")));
    const Control heidenhain("BEGIN PGM T MM\n1 Q5 = 3\n2 L X+1 FMAX\nEND PGM T MM\n",
                             DialectId::heidenhain);
    EXPECT_EQ(heidenhain.text("Q5"), "3");
    EXPECT_EQ(heidenhain.text("plane"), "XY"); // Klartext has no G17
}

TEST(InspectedValue, NamesTheNearestNameIfThereIsNoSuchValue) {
    const Control control("G0 X1\n", DialectId::fanuc);
    EXPECT_THAT(control.text("plain"), HasSubstr("nearest name is 'plane'"));
    EXPECT_THAT(control.text("G60.x"), HasSubstr("nearest name is"));
    EXPECT_THAT(control.text(""), HasSubstr("the name of a value is missing"));
    EXPECT_FALSE(app::names_value("plain"));
    EXPECT_TRUE(app::names_value("G54.1P12.z"));
    EXPECT_FALSE(app::names_value("G54.1P900.z"));
}

TEST(InspectedValue, KnowsEveryNameThatItOffers) {
    const Control control("G0 X1\n", DialectId::fanuc);
    size_t offered = 0;
    for (const std::string& name : app::names_beginning("")) {
        EXPECT_TRUE(app::value_of(name, control.state, control.environment)) << name;
        ++offered;
    }
    EXPECT_GT(offered, 50u);
    EXPECT_THAT(app::names_beginning("MACHINE."), Contains("machine.x"));
    for (const app::NamedValue& value : app::modal_values(control.state, control.environment))
        EXPECT_EQ(app::value_of(value.name, control.state, control.environment), value.value);
}

TEST(InspectedValue, ListsOffsetsThatHoldSomething) {
    const Control control("G21 G90 G54\nG52 X5\nG10 L2 P3 X1\nG0 X1\n", DialectId::fanuc);
    EXPECT_THAT(names_of(app::offset_values(control.state)),
                testing::ElementsAre("G54=X0 Y0 Z0", "G55=X-300 Y-200 Z-100", "G56=X1 Y0 Z0",
                                     "G52=X5 Y0 Z0", "H3=95 mm"));
}

} // namespace
} // namespace app_test
