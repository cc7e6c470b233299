#include <algorithm>
#include <map>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gcode/exec/readings.h"
#include "gcode/language/control.h"
#include "gcode/language/dialect.h"
#include "tests/gcode/klartext_programs.h"
#include "tests/gcode/siemens_programs.h"

namespace gcode {
namespace {

using enum ControlQuestion;
using testing::HasSubstr;

Environment reporting() {
    Environment environment = known_environment(DialectId::siemens);
    environment.control.reports_premises = true;
    environment.tool_lengths[core::ToolNumber{1}] = 60.0;
    environment.length_offsets[core::OffsetNumber{1}] = {.length = 60.0};
    return environment;
}

/// The last state of a program. With a question, it runs with the other answer to it.
InterpreterState last_state(const std::string& text, const Environment& environment,
                            std::optional<ControlQuestion> other = {}) {
    const Program program = program_from_text(text, "test.mpf").value();
    ProgramLibrary library(program, dialect(environment.dialect));
    Interpreter interpreter(library, environment);
    InterpreterState state = initial_state(environment);
    if (other) state.readings.write().chosen = {{PremiseId{.question = *other}, 1}};
    while (true) {
        const auto next = interpreter.next(state);
        if (!next) ADD_FAILURE() << next.error().message;
        if (!next || !*next) return state;
    }
}

/// The machine coordinates of the gauge line at the end.
Position machine_after(const std::string& text, std::optional<ControlQuestion> other = {}) {
    const InterpreterState state = last_state(text, reporting(), other);
    return machine_from_program(state.modal.offsets, state.modal.position);
}

/// "MD10760 in line 3" for each premise that was met.
std::string met(const std::string& text) {
    const InterpreterState state = last_state(text, reporting());
    std::string found;
    for (const OpenPremise& premise : state.readings->met)
        found += std::string(find_parameter(premise.id.question.value(), DialectId::siemens)->key)
                 + " in line " + std::to_string(premise.line) + "\n";
    return found;
}

TEST(SiemensReadings, AUsualProgramMeetsNone) {
    EXPECT_EQ(met("G17 G71 G90 G94 G40\nG54\nSUPA G0 Z0 D0\nT1\nM6\nG0 X-20 Y50 D1 S6000 M3\n"
                  "Z60\nG1 Z-5 F300\nG3 X-20 Y50 I5 J0\nG91 G1 X5\nG90 X0\nG0 Z60\nSUPA G0 Z0 D0\n"
                  "M30\n"),
              "");
}

TEST(SiemensReadings, EachDialectThatAsksAboutPointsHasAParameter) {
    for (const Dialect& each : all_dialects())
        if (each.decimal_points_matter) {
            EXPECT_NE(find_parameter(point_is_implied, each.id), nullptr) << each.name;
        }
}

constexpr const char* iso_without_point = "G291\nG21 G90 G0 X50\nM30\n";

TEST(SiemensReadings, NumbersWithoutAPointAreOpenInIsoMode) {
    EXPECT_EQ(met(iso_without_point), "MD10884 in line 2\n");
    EXPECT_EQ(machine_after(iso_without_point)[0], 50.0);
    EXPECT_EQ(machine_after(iso_without_point, point_is_implied)[0], 0.05);
    EXPECT_EQ(met("G291\nG21 G90 G0 X50.\nM30\n"), "");
}

TEST(SiemensReadings, TheAxisOfTheLengthIsOpenOutsideG17) {
    const std::string text = "G17 G90 T1 M6\nD1 G0 Z100\nG18\nG1 X6 Z0 F100\nM30\n";
    EXPECT_EQ(met(text), "SD42940 in line 4\n");
    EXPECT_EQ(machine_after(text)[2], 60.0);
    const Position follows = machine_after(text, length_keeps_axis);
    EXPECT_EQ(follows[2], 0.0);
}

TEST(SiemensReadings, AnArcAfterG18ShowsThatTheLengthStays) {
    EXPECT_EQ(met("G17 G90 T1 M6\nD1 G0 Z100\nG18\nG3 X10 Z100 CR=5 F100\nG1 Z90\nG17\nM30\n"), "");
}

TEST(SiemensReadings, TheLengthComesBackToZWithG17) {
    const std::string text = "G17 G90 T1 M6\nD1 G0 Z100\nG18\nG1 Y0 Z0 F100\nG17\nG0 Y0 Z0\nM30\n";
    const Position follows = machine_after(text, length_keeps_axis);
    EXPECT_EQ(follows[1], 0.0);
    EXPECT_EQ(follows[2], 60.0);
}

TEST(SiemensReadings, AToolChangeWithoutDIsOpen) {
    const std::string text = "G90\nT1\nM6\nG0 X10\nZ100\nM30\n";
    EXPECT_EQ(met(text), "MD20270 in line 5\n");
    EXPECT_EQ(machine_after(text)[2], 160.0);
    EXPECT_EQ(machine_after(text, change_selects_edge)[2], 100.0);
    EXPECT_EQ(met("G90\nT1\nM6\nG0 X10\nD1\nZ100\nM30\n"), "");
    EXPECT_EQ(met("G90\nT1 M6 D1\nG0 Z100\nM30\n"), "");
    EXPECT_EQ(met("G90\nT0 M6\nG0 Z100\nM30\n"), "");
}

TEST(SiemensReadings, MachineCoordinatesWithALengthAreOpen) {
    for (const std::string code : {"SUPA", "G53", "G153"}) {
        const std::string text = "G90 T1 M6 D1\nG0 Z100\n" + code + " G0 Z20\nM30\n";
        EXPECT_EQ(met(text), "MD10760 in line 3\n") << code;
        EXPECT_EQ(machine_after(text)[2], 80.0) << code;
        EXPECT_EQ(machine_after(text, machine_moves_tip)[2], 20.0) << code;
    }
    EXPECT_EQ(met("G90 T1 M6 D1\nSUPA G0 X0 Y0\nSUPA Z0 D0\nM30\n"), "");
}

TEST(SiemensReadings, IsoModeReadsMachineCoordinatesAsNativePrograms) {
    const std::string text = "G291\nG21 G90 T1 M6\nG43 H1 G0 Z100.\nG53 Z20.\nM30\n";
    EXPECT_EQ(met(text), "MD10760 in line 4\n");
    EXPECT_EQ(machine_after(text)[2], 80.0);
}

TEST(SiemensReadings, ALengthChangeAloneIsOpenInIsoMode) {
    const std::string text = "G291\nG21 G90 T1 M6\nG43 H1 G0 Z100.\nG49\nM30\n";
    EXPECT_EQ(met(text), "MD20382 in line 4\n");
    EXPECT_EQ(machine_after(text)[2], 160.0);
    EXPECT_EQ(machine_after(text, length_change_moves)[2], 100.0);
}

TEST(SiemensReadings, IncrementsAfterAChangeOfTheOffsetAreOpen) {
    const std::string text = "G90 G0 X0 Y50\nTRANS Y50\nG91 Y10\nM30\n";
    EXPECT_EQ(met(text), "SD42440 in line 3\n");
    EXPECT_EQ(machine_after(text)[1], 110.0);
    EXPECT_EQ(machine_after(text, increment_has_offset)[1], 60.0);
    EXPECT_EQ(met("G90 G0 X0 Y50\nTRANS Y50\nG91 X10\nM30\n"), "");
    EXPECT_EQ(met("G90 G0 X0 Y50\nTRANS Y50\nY0\nY=IC(10)\nM30\n"), "");
}

TEST(SiemensReadings, IncrementsAfterAChangeOfTheLengthAreOpen) {
    const std::string text = "G90 G0 Z200\nT1 M6 D1\nZ=IC(10)\nZ=IC(10)\nM30\n";
    EXPECT_EQ(met(text), "SD42442 in line 3\n");
    EXPECT_EQ(machine_after(text)[2], 280.0);
    EXPECT_EQ(machine_after(text, increment_has_length)[2], 220.0);
}

TEST(SiemensReadings, IncrementsInMachineCoordinatesCountFromHere) {
    EXPECT_EQ(machine_after("G90 G0 X30 Z100\nSUPA Z=IC(50)\nSUPA G91 X10\nM30\n")[2], 150.0);
    EXPECT_EQ(machine_after("G90 G0 X30 Z100\nSUPA Z=IC(50)\nSUPA G91 X10\nM30\n")[0], 40.0);
}

TEST(SiemensWordsOfPosts, AreReadWithoutTheirValues) {
    EXPECT_EQ(siemens("FGROUP(X,Y)\nSPOS=DC(90)\nSPOS=IC(90)\nG75 FP=1 Z1=0\n"),
              siemens("SPOS=90\nSPOS=90\nG75 Z1=0\n"));
    EXPECT_THAT(siemens_error("G75 FP=2 Z1=0\n"), HasSubstr("FP=2"));
}

TEST(SiemensHoles, OnTheCircleAreNotProven) {
    const std::string holes = "G0 X0 Y0 Z10 F100\nMCALL CYCLE82(10,0,2,-5)\nHOLES2(0,0,20,0,0,4";
    EXPECT_THAT(warnings_of(holes + ",1010)\nMCALL\n", DialectId::siemens),
                HasSubstr("may travel from hole to hole on the circle"));
    EXPECT_EQ(warnings_of(holes + ",0)\nMCALL\n", DialectId::siemens),
              warnings_of(holes + ")\nMCALL\n", DialectId::siemens));
}

constexpr const char* drilling = "TOOL CALL 1 Z S1000 F250\nL X+0 Y+0 Z+100 R0 FMAX M3\n"
                                 "CYCL DEF 200 DRILLING Q200=2 Q201=-10 Q206=150 Q202=10 Q210=0 "
                                 "Q203=5 Q204=50 Q211=0\n";

TEST(KlartextCalls, ZOfCyclCallPosShiftsTheSurface) {
    const std::string text =
        klartext(std::string(drilling) + "CYCL CALL POS X+30 Y+40 Z-15 FMAX\n");
    EXPECT_THAT(text, HasSubstr("straight_traverse x=30 y=40 z=100\n"
                                "straight_traverse x=30 y=40 z=-8\n"));
    EXPECT_THAT(text, HasSubstr("straight_feed x=30 y=40 z=-20 feed=150\n"));
    EXPECT_THAT(text, HasSubstr("straight_traverse x=30 y=40 z=40\n"));
}

TEST(KlartextCalls, CyclCallPosFromBelowTheSurfaceFirstGoesUp) {
    EXPECT_THAT(klartext(std::string(drilling) + "L Z-30 FMAX\nCYCL CALL POS X+30 Y+40 Z+0 FMAX\n"),
                HasSubstr("straight_traverse x=0 y=0 z=-30\n"
                          "straight_traverse x=0 y=0 z=7\n"
                          "straight_traverse x=30 y=40 z=7\n"));
}

TEST(KlartextCycles, RefuseADepthOfTheFullDiameter) {
    const std::string text(drilling);
    EXPECT_THAT(klartext_error(text.substr(0, text.size() - 1) + " Q395=1\n"), HasSubstr("Q395=1"));
    EXPECT_EQ(klartext(text.substr(0, text.size() - 1) + " Q395=0\nCYCL CALL\n"),
              klartext(text + "CYCL CALL\n"));
}

TEST(KlartextCycles, CentreWithTheFeedOfTheToolCall) {
    const std::string centring = "TOOL CALL 1 Z S1000 F250\nL X+0 Y+0 Z+100 R0 FMAX M3\n"
                                 "CYCL DEF 240 CENTERING Q200=2 Q343=0 Q201=-3 Q344=-10 "
                                 "Q206=FAUTO Q211=0 Q203=0 Q204=50\nCYCL CALL\n";
    EXPECT_THAT(klartext(centring), HasSubstr("straight_feed x=0 y=0 z=-3 feed=250\n"));
    std::string by_diameter = centring;
    by_diameter.replace(by_diameter.find("Q343=0"), 6, "Q343=1");
    EXPECT_THAT(klartext_error(by_diameter), HasSubstr("Q343=1"));
}

TEST(KlartextCycles, AnotherDatumIsNotProven) {
    const auto datum = [](int row) {
        return "CYCL DEF 247 DATUM SETTING Q339=" + std::to_string(row) + "\n";
    };
    const auto doubt_after = [&](const std::string& lines) {
        return last_state(klartext_program(lines), known_environment(DialectId::heidenhain))
                   .modal.doubt
               & datum_is_in_doubt;
    };
    EXPECT_EQ(doubt_after(datum(1) + datum(1)), 0);
    EXPECT_NE(doubt_after(datum(1) + datum(2)), 0);
    EXPECT_EQ(doubt_after(datum(1) + datum(2) + datum(1)), 0);
}

TEST(KlartextMotion, RefusesIncrementsInMachineCoordinates) {
    EXPECT_THAT(klartext_error("L Z+100 FMAX\nL IZ-55 R0 FMAX M91\n"),
                HasSubstr("incremental words with M91"));
}

} // namespace
} // namespace gcode
