#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/rule_table.h"
#include "core/motion/machine.h"
#include "gcode/language/control.h"
#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using enum ControlQuestion;
using testing::HasSubstr;

Environment with(DialectId dialect, std::initializer_list<std::pair<const char*, double>> stated) {
    Environment environment = known_environment(dialect);
    environment.length_offsets[core::OffsetNumber{1}] = {.length = 60.0, .diameter = 10.0};
    environment.work_offsets[0][1] = 3.0; // away from the zero of the machine
    environment.start[1] = 3.0;
    for (const auto& [key, number] : stated) {
        const ControlParameter* parameter = find_parameter(key, dialect);
        environment.control.answers[parameter->question] = *parameter->answer_of(number);
    }
    return environment;
}

/// The motions of a program, or its error. Positions have the frame of the program applied, but not
/// the length of the tool.
std::string path_of(const std::string& text, const Environment& environment) {
    const Ran ran = run_text(text, environment);
    std::string path;
    Offsets offsets;
    const auto add = [&](const Position& end, const std::string& kind) {
        const Position place = machine_from_program(offsets, end);
        path += kind;
        for (size_t axis = 0; axis < 3; ++axis)
            path += fmt::format("{}{:g}", axis == 0 ? "" : ",",
                                std::round(place[axis].value_or(-999) * 1e4) / 1e4);
        path += " ";
    };
    for (const BlockCommands& block : ran.run.blocks)
        for (const CanonicalCommand& command : block.commands) {
            if (const auto* rapid = std::get_if<StraightTraverse>(&command)) add(rapid->end, "r");
            if (const auto* feed = std::get_if<StraightFeed>(&command)) add(feed->end, "f");
            if (const auto* arc = std::get_if<ArcFeed>(&command))
                add(arc->end, fmt::format("a{}:", static_cast<int>(arc->plane)));
            if (const auto* set = std::get_if<SetOffset>(&command)) {
                offsets = set->offsets;
                offsets.tool = {};
            }
            if (const auto* length = std::get_if<UseToolLengthOffset>(&command))
                path += fmt::format("({:g},{:g},{:g}) ", length->offset[0], length->offset[1],
                                    length->offset[2]);
        }
    if (ran.run.error) path += "error: " + ran.run.error->message;
    return path;
}

std::string path_of(const std::string& text, DialectId dialect,
                    std::initializer_list<std::pair<const char*, double>> stated) {
    return path_of(text, with(dialect, stated));
}

/// A program that a control with one value of a parameter moves differently from one with another.
struct Telling {
    DialectId dialect;
    const char* key;
    double usual, other;
    const char* program;
};

constexpr DialectId fanuc = DialectId::fanuc, haas = DialectId::haas, siemens = DialectId::siemens,
                    linuxcnc = DialectId::linuxcnc, grbl = DialectId::grbl;

constexpr const char* outside_entry = "G21 G90\nG1 G42 D1 X10. F9\nX0. Y10.\nG40 X0\nM30\n";

constexpr Telling tellings[] = {
    {fanuc, "5006#6", 1, 0, "G21 G90\nG43 H1 G0 Z100.\nZ50.\nG49\nM30\n"},
    {fanuc, "0#2", 0, 1, "G90\nG0 X1.\nM30\n"},
    {haas, "setting 9", 0, 1, "G90\nG0 X1.\nM30\n"},
    {siemens, "MD20150[12]", 2, 1, "G90\nG0 X1\nM30\n"},
    {fanuc, "3402#3", 0, 1, "G21\nG0 X1.\nX1.\nM30\n"},
    {siemens, "MD20150[13]", 1, 2, "G71\nG0 X1\nX1\nM30\n"},
    {fanuc, "3402#0", 0, 1, "G21 G90 F100.\nX1.\nM30\n"},
    {fanuc, "3402#1", 0, 1, "G21 G90\nG2 X1. I.5 F9\nG2 X2. I.5\nM30\n"},
    {fanuc, "3402#2", 0, 1, "G21 G90\nG2 X1. I.5 F9\nG2 X2. I.5\nM30\n"},
    {siemens, "MD20150[5]", 1, 2, "G71 G90\nG2 X1 I0.5 F9\nM30\n"},
    {siemens, "MD20150[7]", 2, 1, "G71 G90\nG0 X1\nM30\n"},
    {fanuc, "5001#1", 0, 1, "G21 G90 G18\nG43 H1 G0 Z100. Y100.\nM30\n"},
    {fanuc, "5001#0", 0, 1, "G21 G90\nG43 H1 G0 X100.\nZ100.\nM30\n"},
    {fanuc, "5001#6", 0, 1, "G21 G90\nG43 H1 G0 Z100.\nG10 L10 P1 R70.\nG0 Z50.\nM30\n"},
    {fanuc, "5003#0", 0, 1, outside_entry},
    {fanuc, "5003#1", 0, 1, "G21 G90 F9\nG41 D1\nG1 X10.\nX20.\nG40\nX30.\nM30\n"},
    {fanuc, "5101#0", 1, 0, "G21 G90 G18\nG81 X1. Y-5. Z-5. R2. F9\nM30\n"},
    {haas, "setting 28", 1, 0, "G21 G90 G98\nG0 Z10.\nG81 Z-5. R2. F9\nX5.\nM30\n"},
    {fanuc, "5114", 1, 0.5, "G21 G90\nG0 Z10.\nG73 X1. Z-5. R2. Q3. F9\nM30\n"},
    {fanuc, "5115", 1, 0.5, "G21 G90\nG0 Z10.\nG83 X1. Z-5. R2. Q3. F9\nM30\n"},
    {haas, "setting 22", 1, 0.5, "G21 G90\nG0 Z10.\nG83 X1. Z-5. R2. Q3. F9\nM30\n"},
    {haas, "setting 52", 0, 3, "G21 G90\nG0 Z10.\nG83 X1. Z-5. R2. Q3. F9\nM30\n"},
    {fanuc, "5148", 1, -2, "G21 G90\nG0 Z10.\nG76 X1. Z-5. R2. Q1. F9\nM30\n"},
    {haas, "setting 27", 1, 2, "G21 G90\nG0 Z10.\nG76 X1. Z-5. R2. Q1. F9\nM30\n"},
    {fanuc, "5400#0", 1, 0, "G21 G90\nG68 X0 Y0 R30.\nG91 G68 X0 Y0 R60.\nG90 G0 X10.\nM30\n"},
    {fanuc, "5410", 30, 60, "G21 G90\nG68 X0 Y0\nG0 X10.\nM30\n"},
    {fanuc, "5400#7", 1, 0, "G21 G90\nG51 X0 Y0 Z0 P2000\nG0 X10.\nM30\n"},
    {fanuc, "5411", 2, 3, "G21 G90\nG51 X0 Y0 Z0\nG0 X10.\nM30\n"},
    {fanuc, "5401#0", 1, 0, "G21 G90\nG51 X0 Y0 Z0 P2.\nG0 Z10.\nM30\n"},
    {fanuc, "3403#5", 1, 0, "G21 G90\nG2 X10. Y10. F9\nM30\n"},
    {haas, "setting 29", 0, 1, "G21 G90\nG0 X5.\nG91 X1.\nX1.\nM30\n"},
    {haas, "setting 71", 2, 3, "G21 G90\nG51 X0 Y0 Z0\nG0 X10.\nM30\n"},
    {haas, "setting 72", 30, 60, "G21 G90\nG68 X0 Y0\nG0 X10.\nM30\n"},
    {haas, "setting 73", 0, 1, "G21 G90\nG68 X0 Y0 R30.\nG91 G68 X0 Y0 R60.\nG90 G0 X9.\nM30\n"},
    {haas, "setting 33", 1, 3, "G21 G90\nG52 X10.\nG0 X1.\nM30\n"},
    {fanuc, "3410", 0.005, 1, "G21 G90\nG2 X10.5 I5. F9\nM30\n"},
    {linuxcnc, "CENTER_ARC_RADIUS_TOLERANCE_MM", 0.01, 1, "G21 G90\nG2 X10.5 I5 F9\nM2\n"},
    {linuxcnc, "CENTER_ARC_RADIUS_TOLERANCE_INCH", 0.001, 1, "G20 G90\nG2 X10.5 I5 F9\nM2\n"},
};

class TellingProgram : public testing::TestWithParam<Telling> {};

TEST_P(TellingProgram, MovesDifferentlyWithAnotherValue) {
    const Telling& row = GetParam();
    const std::string usual = path_of(row.program, row.dialect, {{row.key, row.usual}});
    EXPECT_NE(usual, path_of(row.program, row.dialect, {{row.key, row.other}})) << usual;
    const ControlParameter& parameter = *find_parameter(row.key, row.dialect);
    if (parameter.values.empty() || parameter.question == arc_tolerance
        || parameter.question == arc_tolerance_inch)
        return;
    EXPECT_EQ(usual, path_of(row.program, row.dialect, {})) << "the first value is assumed";
    EXPECT_EQ(parameter.values[0].number, row.usual);
}

INSTANTIATE_TEST_SUITE_P(Control, TellingProgram, testing::ValuesIn(tellings));

// What they change is tested elsewhere: by checks, below, or in siemens_readings_test.cpp; or only
// one value is supported.
const std::set<std::string_view> told_elsewhere = {"3401#0",
                                                   "setting 162",
                                                   "6001#6",
                                                   "1401#1",
                                                   "setting 335",
                                                   "3402#6",
                                                   "setting 56",
                                                   "1013#1",
                                                   "1013#0",
                                                   "5431#0",
                                                   "",
                                                   "setting 85",
                                                   "MD10884",
                                                   "SD42940",
                                                   "MD20270",
                                                   "MD10760",
                                                   "MD10602",
                                                   "MD21104",
                                                   "ORIWKS",
                                                   "MD24530",
                                                   "12321",
                                                   "12322",
                                                   "5axiskins W",
                                                   "G53.1 P1",
                                                   "MD21100",
                                                   "MD21102",
                                                   "SD42980",
                                                   "MD20382",
                                                   "SD42440",
                                                   "SD42442",
                                                   "MD22550",
                                                   "MD20150[17]",
                                                   "MD20210",
                                                   "1008#0",
                                                   "M428",
                                                   "1008#1",
                                                   "M6 T",
                                                   "19625",
                                                   "setting 43",
                                                   "setting 45",
                                                   "setting 46",
                                                   "setting 47",
                                                   "setting 48",
                                                   "setting 58",
                                                   "LINEAR_UNITS",
                                                   "tool offset memory",
                                                   "setting 40",
                                                   "5004#2",
                                                   "6001#7"};

TEST(Control, EachParameterHasAProgramThatTellsItsValuesApart) {
    for (const ControlParameter& parameter : control_parameters()) {
        const bool is_told =
            std::any_of(std::begin(tellings), std::end(tellings),
                        [&](const Telling& row) { return row.key == parameter.key; });
        EXPECT_NE(is_told, told_elsewhere.contains(parameter.key)) << parameter.key;
    }
}

TEST(Control, ValuesOfAParameterDifferAndHaveASource) {
    for (const ControlParameter& parameter : control_parameters()) {
        EXPECT_FALSE(parameter.source.empty()) << parameter.key;
        EXPECT_NE(parameter.key.empty(), parameter.statement.empty()) << parameter.name;
        EXPECT_EQ(parameter.values.empty(), parameter.choices().starts_with("a number")
                                                && parameter.if_not_stated == IfNotStated::go_on)
            << parameter.key;
        EXPECT_TRUE(!parameter.is_open() || parameter.values.size() > 1) << parameter.key;
        std::set<double> numbers, answers;
        for (const ParameterValue& value : parameter.values) {
            numbers.insert(value.number);
            answers.insert(value.answer);
            EXPECT_EQ(parameter.answer_of(value.number), value.answer) << parameter.key;
        }
        EXPECT_EQ(numbers.size(), parameter.values.size()) << parameter.key;
        EXPECT_TRUE(parameter.values.size() < 2 || answers.size() > 1) << parameter.key;
        if (parameter.key.empty()) continue;
        for (const DialectId dialect : parameter.dialects)
            EXPECT_EQ(find_parameter(parameter.key, dialect), &parameter) << parameter.key;
    }
}

TEST(Control, KeysAreUniqueInADialect) {
    for (const Dialect& dialect : all_dialects())
        for (const ControlSetting& setting : control_settings())
            EXPECT_FALSE(find_parameter(setting.key, dialect.id)) << setting.key;
}

/// The keys in the first column but one of the manual's table.
TEST(Control, TheManualListsAllParameters) {
    std::ifstream file(source_dir / "docs/manual/controls-and-dialects.md");
    std::stringstream manual;
    manual << file.rdbuf();
    for (const ControlParameter& parameter : control_parameters()) {
        if (parameter.key.empty()) continue;
        EXPECT_THAT(manual.str(), HasSubstr(fmt::format("| `\"{}\"`", parameter.key)));
    }
    for (const ControlSetting& setting : control_settings()) {
        const bool is_bare = setting.key[0] >= 'A' && setting.key[0] <= 'Z'
                             && setting.key.find(' ') == std::string_view::npos;
        EXPECT_THAT(manual.str(), HasSubstr(is_bare ? fmt::format("| `{}`", setting.key)
                                                    : fmt::format("| `\"{}\"`", setting.key)));
    }
}

TEST(Control, TheEntryToAContourIsStraightOrHasACorner) {
    // Type A: straight to the offset start of the next move. Type B: round the corner, as on the
    // contour; it is acute here.
    constexpr const char* acute = "G21 G90\nG1 G42 D1 X10. F9\nX0. Y10.\nM30\n";
    EXPECT_THAT(path_of(acute, fanuc, {{"5003#0", 0}}), testing::StartsWith("f13.5355,3.5355,0 "));
    EXPECT_THAT(path_of(acute, fanuc, {{"5003#0", 1}}),
                testing::StartsWith("f15,-5,0 f17.0711,0,0 "));
    constexpr const char* obtuse = "G21 G90\nG1 G42 D1 X10. F9\nX10. Y10.\nM30\n";
    EXPECT_THAT(path_of(obtuse, fanuc, {{"5003#0", 0}}), testing::StartsWith("f15,0,0 "));
    EXPECT_THAT(path_of(obtuse, fanuc, {{"5003#0", 1}}), testing::StartsWith("f15,-5,0 "));
    constexpr const char* inside = "G21 G90\nG1 G41 D1 X10. F9\nX10. Y10.\nM30\n";
    EXPECT_EQ(path_of(inside, fanuc, {{"5003#0", 0}}), path_of(inside, fanuc, {{"5003#0", 1}}));
}

TEST(Control, TheExitFromAContourIsStraightOrHasACorner) {
    constexpr const char* obtuse = "G21 G90\nG1 G42 D1 X10. F9\nX20.\nG40 Y20.\nM30\n";
    EXPECT_EQ(path_of(obtuse, fanuc, {{"5003#0", 0}}), "f10,-5,0 f20,-5,0 f20,20,0 ");
    EXPECT_EQ(path_of(obtuse, fanuc, {{"5003#0", 1}}), "f10,-5,0 f25,-5,0 f20,20,0 ");
    constexpr const char* acute = "G21 G90\nG1 G42 D1 X10. F9\nX20.\nG40 X10. Y10.\nM30\n";
    EXPECT_EQ(path_of(acute, fanuc, {{"5003#0", 1}}), "f10,-5,0 f25,-5,0 f27.0711,0,0 f10,10,0 ");
}

TEST(Control, CompensationAloneMayShiftTheToolAtOnce) {
    constexpr const char* alone = "G21 G90 F9\nG41 D1\nG1 X10.\nX20.\nG40\nX30.\nM30\n";
    EXPECT_EQ(path_of(alone, fanuc, {{"5003#1", 0}}), "f10,5,0 f20,5,0 f30,0,0 ");
    EXPECT_EQ(path_of(alone, fanuc, {{"5003#1", 1}}), "f0,5,0 f10,5,0 f20,5,0 f20,0,0 f30,0,0 ");
}

TEST(Control, LengthOffsetsActAlongTheAxisOfTheirType) {
    constexpr const char* plane = "G21 G90 G18\nG43 H1 G0 Y100. Z100.\nM30\n";
    EXPECT_THAT(path_of(plane, fanuc, {{"5001#1", 0}}), HasSubstr("(0,0,60)"));
    EXPECT_THAT(path_of(plane, fanuc, {{"5001#1", 1}}), HasSubstr("(0,60,0)"));
    constexpr const char* named = "G21 G90\nG43 H1 G0 X100.\nM30\n";
    EXPECT_THAT(path_of(named, fanuc, {{"5001#0", 1}}), HasSubstr("(60,0,0)"));
}

TEST(Control, CyclesDrillAlongTheAxisOfTheirParameter) {
    constexpr const char* text = "G21 G90 G18\nG0 Y20. Z20.\nG99 G81 X1. Y-5. Z-7. R2. F9\nM30\n";
    EXPECT_THAT(path_of(text, fanuc, {{"5101#0", 1}}), HasSubstr("f1,-5,-7"));
    EXPECT_THAT(path_of(text, fanuc, {{"5101#0", 0}}), HasSubstr("r1,-5,2 f1,-5,-7 r1,-5,2"));
}

TEST(Control, APeckReturnsAboveR) {
    const std::string path = path_of("G21 G90\nG0 Z10.\nG99 G83 X1. Z-5. R2. Q4. F9\nM30\n", haas,
                                     {{"setting 52", 3}, {"setting 22", 0.5}});
    EXPECT_EQ(path, "r0,0,10 r1,0,10 r1,0,2 f1,0,-2 r1,0,5 r1,0,-1.5 f1,0,-5 r1,0,2 ");
}

TEST(Control, LeastIncrementsDependOnTheIncrementSystem) {
    constexpr const char* text = "G21 G90\nG0 X1000\nM30\n";
    const auto x = [&](std::initializer_list<std::pair<const char*, double>> stated) {
        Environment environment = with(fanuc, stated);
        environment.counts_smallest_steps = true;
        return path_of(text, environment);
    };
    EXPECT_EQ(x({}), "r1,0,0 ");
    EXPECT_EQ(x({{"1013#1", 1}}), "r0.1,0,0 ");
    EXPECT_EQ(x({{"1013#0", 1}}), "r10,0,0 ");
}

/// A value of a setting put into the environment.
Environment set(DialectId dialect, std::string_view key, const SettingValue& value) {
    Environment environment = known_environment(dialect);
    find_setting(key, dialect)->set(environment, value);
    return environment;
}

TEST(Control, ReferencePointsAreWhereG28AndG30Go) {
    const Position at{{1.0, 2.0, 3.0}};
    EXPECT_EQ(path_of("G21 G90\nG28\nM30\n", set(fanuc, "1240", at)), "r1,2,3 ");
    EXPECT_EQ(path_of("G21 G90\nG30\nM30\n", set(fanuc, "1241", at)), "r1,2,3 ");
    EXPECT_EQ(path_of("G21 G90\nG30 P3 X0 Y0 Z0\nM30\n", set(fanuc, "1242", at)), "r0,0,0 r1,2,3 ");
    EXPECT_EQ(path_of("G21 G90\nG30 P4 X0 Y0 Z0\nM30\n", set(fanuc, "1243", at)), "r0,0,0 r1,2,3 ");
    EXPECT_THAT(path_of("G21 G90\nG30 P4 X0\nM30\n", set(fanuc, "1242", at)), HasSubstr("1243"));
}

TEST(Control, G60EndsInOneDirection) {
    EXPECT_EQ(
        path_of("G21 G90\nG60 X10. Y5.\nM30\n", set(fanuc, "5440", Position{{0.5, -0.5, 0.0}})),
        "r9.5,5.5,0 r10,5,0 ");
    EXPECT_EQ(path_of("G21 G90\nG60 X10.\nM30\n", set(haas, "setting 35", 0.5)),
              "r10.5,0,0 r10,0,0 ");
    Environment modal = set(fanuc, "5440", Position{{0.5, 0.5, 0.0}});
    modal.control.answers[one_way_is_modal] = 1;
    EXPECT_THAT(path_of("G21 G90\nG60 X10.\nM30\n", modal), HasSubstr("5431#0"));
}

TEST(Control, AToolChangeMovesWhereTheSettingsSay) {
    EXPECT_EQ(path_of("G21 G90\nT1 M6\nM2\n",
                      set(linuxcnc, "TOOL_CHANGE_POSITION", Position{{1.0, 2.0, 3.0}})),
              "r1,2,3 ");
    EXPECT_EQ(path_of("G21 G90\nT1 M6\nM2\n", set(linuxcnc, "TOOL_CHANGE_AT_G30", true)),
              "r0,0,-50 ");
    Environment low = set(linuxcnc, "TOOL_CHANGE_QUILL_UP", true);
    low.start[2] = -20.0;
    EXPECT_EQ(path_of("G21 G90\nT1 M6\nM2\n", low), "r0,0,0 ");
    EXPECT_TRUE(
        set(linuxcnc, "TOOL_CHANGE_WITH_SPINDLE_ON", true).tool_change.keeps_spindle_running);
    EXPECT_EQ(set(linuxcnc, "WRAPPED_ROTARY", std::string("A")).wrapped_axes, "A");
    EXPECT_EQ(path_of("G0 X1\nM2\n", set(linuxcnc, "RS274NGC_STARTUP_CODE", std::string("G20"))),
              "r25.4,0,0 ");
}

TEST(Control, Setting85RoundsCornersUntilG187) {
    Environment environment = with(haas, {{"setting 85", 0.6}});
    EXPECT_EQ(initial_state(environment).modal.path_tolerance, 0.6);
    const Ran ran = run_text("G187 E0.1\nG187\nM30\n", environment);
    std::vector<double> tolerances;
    for (const BlockCommands& block : ran.run.blocks)
        for (const CanonicalCommand& command : block.commands)
            if (const auto* mode = std::get_if<SetPathMode>(&command))
                tolerances.push_back(mode->tolerance);
    ASSERT_EQ(tolerances.size(), 2U);
    EXPECT_GT(tolerances[0], 0.0);
    EXPECT_EQ(tolerances[1], 0.6);
}

/// "5003#0 3 of 2" for each premise that a program meets: the question, the line, the readings.
std::string met(const std::string& text, Environment environment) {
    environment.control.reports_premises = true;
    const Ran ran = run_text(text, environment);
    std::string found;
    for (const OpenPremise& premise : ran.run.state.readings->met) {
        const ControlParameter* parameter =
            premise.id.question ? find_parameter(*premise.id.question, environment.dialect)
                                : nullptr;
        found +=
            fmt::format("{}{} {} of {}", found.empty() ? "" : ", ",
                        parameter ? parameter->key : "?", premise.line, premise.readings.size());
    }
    return found;
}

TEST(Control, APremiseIsMetWhereItMatters) {
    const Environment known = with(fanuc, {});
    EXPECT_EQ(met("G21 G90\nG0 X1.\nG43 H1 Z100.\nG81 X1. Z-5. R2. F9\nM30\n", known), "");
    EXPECT_EQ(met("G21\nG0 X1.\nM30\n", known), "3402#3 2 of 2");
    EXPECT_EQ(met("G21\nG91 G0 X1.\nM30\n", known), "");
    EXPECT_EQ(met("G21 G90\nG0 X0.\nG73 X1. Z-5. R2. Q3. F9\nM30\n", known), "5114 3 of 1");
    EXPECT_EQ(met("G21 G90\nG0 X0.\nG76 X1. Z-5. R2. Q3. F9\nM30\n", known), "5148 3 of 4");
    EXPECT_EQ(met("G21 G90\nG1 G41 D1 X10. F9\nY20.\nG40 X0.\nM30\n", known), "5003#0 2 of 2");
    EXPECT_EQ(met("G21 G90\nG0 X0.\nG41 D1\nG1 X10. F9\nY20.\nG40 X0.\nM30\n", known),
              "5003#1 3 of 2, 5003#0 3 of 2");
}

TEST(Control, AStatedParameterIsNoPremise) {
    EXPECT_EQ(met("G21\nG0 X1.\nM30\n", with(fanuc, {{"3402#3", 0}, {"3402#6", 1}})), "");
    EXPECT_EQ(met("G21\nG0 X1.\nM30\n", with(fanuc, {{"3402#3", 0}})), "3402#6 2 of 2");
    EXPECT_EQ(met("G21 G90\nG0 X0.\nG73 X1. Z-5. R2. Q3. F9\nM30\n", with(fanuc, {{"5114", 1.5}})),
              "");
}

TEST(Control, TheDistanceModeOfABlockCountsForItsLengthOffset) {
    // The change of the length offset moves Z, whether G91 is in the block or before it.
    const auto path = [](const char* text) { return path_of(text, fanuc, {{"5006#6", 0}}); };
    EXPECT_EQ(path("G21 G90\nG0 Z9.\nG91 G43 H1 Z1.\nG90 X5.\nM30\n"),
              path("G21 G90\nG0 Z9.\nG91\nG43 H1 Z1.\nG90 X5.\nM30\n"));
    const Environment open = with(fanuc, {});
    EXPECT_EQ(met("G21 G90\nG43 H1 G0 Z100.\nG91 G28 Z0. G49\nM30\n", open), "5006#6 3 of 2");
    EXPECT_EQ(met("G21 G90\nG43 H1 G0 Z100.\nG90 G28 Z0. G49\nM30\n", open), "");
}

TEST(Control, G101MirrorsAboutTheWorkZero) {
    EXPECT_EQ(path_of("G21 G90\nG101 X50.\nG0 X10.\nM30\n", haas, {}), "r-10,3,0 ");
    EXPECT_EQ(path_of("G21 G90\nG51.1 X50.\nG0 X10.\nM30\n", haas, {}), "r90,3,0 ");
}

TEST(Control, G92CancelsG52AlongItsAxes) {
    constexpr const char* text = "G21 G90\nG52 X80. Y20.\nG0 X0. Y0.\nG92 X0.\nG52 X0. Y0.\n"
                                 "G0 X0. Y0.\nM30\n";
    for (const DialectId dialect : {fanuc, haas})
        EXPECT_EQ(path_of(text, dialect, {}), "r80,23,0 r80,3,0 ");
}

TEST(Control, VariablesFrom5201AreG52OnHaas) {
    constexpr const char* text = "G21 G90\n#5201=30.\nG0 X1.\nG52 X0.\nG0 X1.\nM30\n";
    EXPECT_EQ(path_of(text, haas, {}), "r31,3,0 r1,3,0 ");
    EXPECT_EQ(path_of(text, fanuc, {}), "r31,3,0 r31,3,0 ");
}

TEST(Control, RIsAMotionWordOfACycleOnFanuc) {
    constexpr const char* text = "G21 G90 G99\nG0 Z10.\nG81 Z-5. R2. F9\nR-1.\nX5.\nM30\n";
    EXPECT_EQ(path_of(text, fanuc, {}),
              "r0,0,10 r0,0,10 r0,0,2 f0,0,-5 r0,0,2 r0,0,2 r0,0,-1 f0,0,-5 r0,0,-1 r5,0,-1 "
              "f5,0,-5 r5,0,-1 ");
    // A cycle code alone does not drill.
    EXPECT_EQ(path_of("G21 G90 G99\nG0 Z10.\nG81 X1. Z-5. R2. F9\nG82\nM30\n", fanuc, {}),
              "r0,0,10 r1,0,10 r1,0,2 f1,0,-5 r1,0,2 ");
}

TEST(Control, AnArcByRadiusToItsStartMovesNothing) {
    EXPECT_EQ(path_of("G21 G90\nG2 X0. Y0. R5. F9\nG0 X1.\nM30\n", fanuc, {}), "r1,0,0 ");
    EXPECT_THAT(path_of("G21 G90\nG2 X0. Y0. R5. F9\nM30\n", haas, {}), HasSubstr("error"));
}

/// With something described that could be hit.
Environment described(Environment environment) {
    environment.control.follows_start = true;
    return environment;
}

TEST(Control, ModesOfAnEarlierProgramAreNotThoseOfPowerOn) {
    EXPECT_EQ(met("G21\nG0 X1.\nM30\n", with(fanuc, {{"3402#3", 0}, {"3402#6", 0}})),
              "3402#3 2 of 2");
    EXPECT_EQ(met("G21\nG0 X1.\nM30\n", with(haas, {{"setting 56", 1}})), "");
    EXPECT_EQ(met("G21\nG0 X1.\nM30\n", described(with(haas, {{"setting 56", 0}}))), " 2 of 2");
    EXPECT_EQ(met("G21\nG0 X1.\nM30\n", with(haas, {{"setting 56", 0}})), "");
}

TEST(Control, ACycleBeforeG98AndG99RetractsAsAnEarlierProgramLeftIt) {
    constexpr const char* drills = "G21 G90 G17\nG0 Z10.\nG81 X1. Z-5. R2. F9\nX2.\nM30\n";
    const auto given = [](DialectId dialect,
                          std::initializer_list<std::pair<const char*, double>> stated) {
        return described(with(dialect, stated));
    };
    EXPECT_EQ(met(drills, given(fanuc, {{"3402#6", 0}})), " 3 of 2");
    EXPECT_EQ(met(drills, given(fanuc, {})), "3402#6 3 of 2");
    EXPECT_EQ(met(drills, given(haas, {{"setting 28", 1}, {"setting 56", 0}})), " 3 of 2");
    EXPECT_EQ(met(drills, given(fanuc, {{"3402#6", 1}})), "");
    EXPECT_EQ(
        met("G21 G90 G17 G98\nG0 Z10.\nG81 X1. Z-5. R2. F9\nM30\n", given(fanuc, {{"3402#6", 0}})),
        "");
}

TEST(Control, AMoveBeforeG54IsInTheOffsetThatAnEarlierProgramLeft) {
    const auto two = [](DialectId dialect,
                        std::initializer_list<std::pair<const char*, double>> is) {
        Environment environment = described(with(dialect, is));
        environment.work_offsets[1][2] = -50.0;
        return environment;
    };
    EXPECT_EQ(met("G21 G90\nG0 X1.\nM30\n", two(fanuc, {{"3402#6", 0}})), "? 2 of 2");
    EXPECT_EQ(met("G21 G90\nG0 X1.\nM30\n", two(haas, {{"setting 56", 0}})), "? 2 of 2");
    EXPECT_EQ(met("G21 G90\nG0 X1.\nM30\n", two(fanuc, {})), "3402#6 2 of 2");
    EXPECT_EQ(met("G21 G90\nG0 X1.\nM30\n", two(linuxcnc, {})), "? 2 of 2");
    EXPECT_EQ(met("G21 G90\nG0 X1.\nM30\n", two(grbl, {})), "? 2 of 2");
    EXPECT_EQ(met("G21 G90\nG54 G0 X1.\nM30\n", two(grbl, {})), "");
    EXPECT_EQ(met("G21 G90\nG54 G0 X1.\nM30\n", two(fanuc, {{"3402#6", 0}})), "");
    EXPECT_EQ(met("G21 G90\nG53 Z0.\nG54 G0 X1.\nM30\n", two(fanuc, {{"3402#6", 0}})), "");
    EXPECT_EQ(met("G21 G90\nG0 X1.\nM30\n", two(fanuc, {{"3402#6", 1}})), "");
    EXPECT_EQ(met("G21 G90\nG0 X1.\nM30\n", with(fanuc, {{"3402#6", 0}})), "");
}

TEST(Control, MdiMayLeaveOtherModes) {
    for (const DialectId dialect : {linuxcnc, grbl}) {
        EXPECT_EQ(met("G21 G17\nG0 X1\nM30\n", described(with(dialect, {}))), " 2 of 2");
        EXPECT_EQ(met("G21 G17\nG0 X1\nM30\n", with(dialect, {})), "");
        EXPECT_EQ(met("G21 G17 G90\nG0 X1\nM30\n", described(with(dialect, {}))), "");
        EXPECT_EQ(met("G21 G90\nG0 X0 Y0\nG2 X2 I1 F9\nM30\n", described(with(dialect, {}))),
                  " 3 of 2");
    }
    constexpr const char* drills = "G21 G17 G90\nG0 Z10\nM3 S9\nG81 X1 Z-5 R2 F9\nM2\n";
    EXPECT_EQ(met(drills, described(with(linuxcnc, {}))), " 4 of 2");
    EXPECT_EQ(met(drills, with(linuxcnc, {})), "");
}

TEST(Control, VariablesOfTheMainProgramAreKeptOnLinuxcnc) {
    EXPECT_EQ(met("G21 G90\no1 if [#5 GT 0]\nG0 X1\no1 endif\nM2\n", with(linuxcnc, {})),
              "? 2 of 2");
    EXPECT_EQ(met("G21 G90\n#5=0\no1 if [#5 GT 0]\nG0 X1\no1 endif\nM2\n", with(linuxcnc, {})), "");
    EXPECT_EQ(met("o2 sub\no1 if [#5 GT 0]\nG0 X1\no1 endif\no2 endsub\nG21 G90\no2 call [1]\n"
                  "M2\n",
                  with(linuxcnc, {})),
              "");
}

TEST(Control, AnIncrementalModeMayEndWithItsBlock) {
    const Environment open = with(haas, {{"setting 56", 1}});
    EXPECT_EQ(met("G21 G90\nG91 G0 X1.\nM5\nX1.\nX1.\nM30\n", open), "setting 29 4 of 2");
    EXPECT_EQ(met("G21 G90\nG91 G28 Z0.\nG90 G0 X1.\nM30\n", open), "");
    EXPECT_EQ(path_of("G21 G90\nG91 G0 X1.\nX5.\nM30\n", haas, {{"setting 29", 1}}),
              "r1,0,0 r5,0,0 ");
}

TEST(Control, M6MayTakeTheToolThatWaits) {
    const auto changes = [](const char* text, double number) {
        const Ran ran = run_text(text, with(fanuc, {{"M6 T", number}}));
        std::string tools;
        for (const BlockCommands& block : ran.run.blocks)
            for (const CanonicalCommand& command : block.commands)
                if (const auto* change = std::get_if<ChangeTool>(&command))
                    tools += std::to_string(core::value_of(*change->tool));
        return tools;
    };
    constexpr const char* waits = "T2\nM6 T1\nM6\nM30\n";
    EXPECT_EQ(changes(waits, 1), "11");
    EXPECT_EQ(changes(waits, 2), "21");
    const Environment open = with(fanuc, {});
    EXPECT_EQ(met(waits, open), "M6 T 2 of 2");
    EXPECT_EQ(met("T1 M6\nT2 M6\nM30\n", open), "");
    EXPECT_EQ(met("T1\nM6\nT2\nT2 M6\nM30\n", open), "");
}

/// The angles of A after each block that moves.
std::string angles_of(const std::string& text, Environment environment) {
    core::Machine machine;
    for (const size_t axis : {0, 1, 2, 3}) machine.axes[axis].present = true;
    environment.machine = std::make_shared<const core::Machine>(machine);
    const Ran ran = run_text(text, environment);
    std::string angles;
    for (const BlockCommands& block : ran.run.blocks)
        for (const CanonicalCommand& command : block.commands)
            if (const auto* rapid = std::get_if<StraightTraverse>(&command))
                angles += fmt::format("{:g} ", rapid->end[3].value_or(-999));
    return angles;
}

TEST(Control, ARotaryAxisTurnsTheWayOfItsParameters) {
    constexpr const char* text = "G21 G90\nG0 A30.\nA330.\nA-300.\nA10.\nM30\n";
    EXPECT_EQ(angles_of(text, with(fanuc, {{"1008#0", 0}})), "30 330 -300 10 ");
    EXPECT_EQ(angles_of(text, with(fanuc, {{"1008#0", 1}, {"1008#1", 0}})), "30 -30 60 10 ");
    EXPECT_EQ(angles_of(text, with(fanuc, {{"1008#0", 1}, {"1008#1", 1}})), "30 330 300 370 ");
    EXPECT_EQ(angles_of("G21 G90\nG0 A180.\nM30\n", with(fanuc, {{"1008#0", 1}, {"1008#1", 0}})),
              "180 ");
}

TEST(Control, M99InTheMainProgramStartsItAgainUntilNothingChanges) {
    EXPECT_EQ(path_of("G21 G90\nG0 X1.\nX2.\nM99\n", fanuc, {}),
              "r1,0,0 r2,0,0 r1,0,0 r2,0,0 r1,0,0 r2,0,0 ");
    EXPECT_EQ(path_of("O1\nG21 G90\n#1=#1+1\nIF[#1GT2]GOTO9\nG0 X#1\nM99\nN9 M30\n", fanuc, {}),
              "r1,0,0 r2,0,0 ");
    const Ran counts = run_text("G21 G91\nG0 X1.\nM99\n", with(fanuc, {}));
    const auto warning = end_warning(with(fanuc, {}), counts.run.state);
    ASSERT_TRUE(warning);
    EXPECT_EQ(warning->rule, core::rule_id("undecided"));
}

TEST(Control, AToolChangeRaisesZOnHaas) {
    EXPECT_EQ(path_of("G21 G90\nT1 M6\nG0 Z-20.\nT2 M6\nG0 X1.\nM30\n", haas, {}),
              "r0,0,-20 r0,0,0 r1,0,0 ");
    EXPECT_EQ(path_of("G21 G90\nT1 M6\nG0 Z-20.\nT1 M6\nG0 X1.\nM30\n", haas, {}),
              "r0,0,-20 r1,0,-20 ");
}

} // namespace
} // namespace gcode
