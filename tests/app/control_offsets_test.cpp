#include <random>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/report/text/offset_report.h"
#include "app/report/text/text_report.h"
#include "app/setup/control/control_offsets.h"
#include "app/setup/control/offset_differences.h"
#include "app/setup/control/used_offsets.h"
#include "app/setup/program_settings.h"
#include "app/setup/setup_file.h"
#include "gcode/language/dialect.h"
#include "gcode/text/source.h"
#include "tests/support/scoped_folder.h"

namespace app {
namespace {

using core::OffsetNumber;
using gcode::DialectId;
using gcode::LengthUnit;

const test_support::ScopedFolder& kept_folder() {
    static const test_support::ScopedFolder kept;
    return kept;
}

ControlReading fanuc_reading() {
    return {.dialect = DialectId::fanuc, .unit = LengthUnit::mm, .unit_is_stated = true};
}

ControlReading linuxcnc_reading() {
    return {.dialect = DialectId::linuxcnc, .unit = LengthUnit::mm, .unit_is_stated = true};
}

core::Result<ControlOffsets> read_text(const std::string& text, const ControlReading& reading,
                                       const std::string& name = "offsets.txt") {
    return read_control_offsets({kept_folder().write(name, text)}, reading);
}

ControlOffsets offsets_in(const std::string& text,
                          const ControlReading& reading = fanuc_reading()) {
    const auto read = read_text(text, reading);
    EXPECT_TRUE(read.has_value()) << error_text(read.error());
    return read.value_or(ControlOffsets{});
}

std::string mistake_in(const std::string& text, const ControlReading& reading = fanuc_reading()) {
    const auto read = read_text(text, reading);
    EXPECT_FALSE(read.has_value()) << text;
    return read ? "" : error_text(read.error());
}

std::optional<double> value_of_place(const std::optional<ControlValue>& place) {
    return place ? std::optional(place->value) : std::nullopt;
}

std::optional<double> origin_of(const ControlOffsets& offsets, size_t index, size_t axis) {
    const auto found = offsets.work.find(index);
    return found == offsets.work.end() ? std::nullopt : value_of_place(found->second.axes[axis]);
}

ControlToolOffset tool_in(const ControlOffsets& offsets, int number) {
    const auto found = offsets.tools.find(OffsetNumber{number});
    return found == offsets.tools.end() ? ControlToolOffset{} : found->second;
}

TEST(ControlOffsets, ReadsBlocksWithG10) {
    const ControlOffsets read = offsets_in(
        "%\nO9001 (OFFSETS)\nG90\nG10 L2 P0 X0. Y0. Z1.5\nG10 L2 P1 X-350.123 Y-200. Z-420.5 A90.\n"
        "G10L20P3X1.Y2.Z3.\nG10 L10 P1 R120.5 (T1 END MILL)\nG10 L11 P1 R-0.02\nG10 L12 P1 R5.\n"
        "N10 G10 L13 P1 R0.01\nG10 L10 P2 R98. G10 L12 P2 R3.\nM30\n%\n");
    EXPECT_EQ(origin_of(read, 0, 0), -350.123);
    EXPECT_EQ(origin_of(read, 0, 3), 90.0);
    EXPECT_EQ(origin_of(read, gcode::plain_offset_count + 2, 2), 3.0);
    EXPECT_EQ(value_of_place(read.external.axes[2]), 1.5);
    EXPECT_EQ(value_of_place(tool_in(read, 1).length), 120.5);
    EXPECT_EQ(value_of_place(tool_in(read, 1).wear), -0.02);
    EXPECT_EQ(value_of_place(tool_in(read, 1).diameter), 5.0);
    EXPECT_EQ(value_of_place(tool_in(read, 1).diameter_wear), 0.01);
    EXPECT_EQ(value_of_place(tool_in(read, 2).length), 98.0);
    EXPECT_EQ(value_of_place(tool_in(read, 2).diameter), 3.0);
    EXPECT_EQ(tool_in(read, 1).length->line, 7u);
    EXPECT_TRUE(read.notes.empty());
}

TEST(ControlOffsets, ReadsRadiiInchesAndSteps) {
    ControlReading reading = fanuc_reading();
    reading.sizes_are_radii = true;
    reading.counts_smallest_steps = true;
    const ControlOffsets read = offsets_in("G20\nG10 L10 P1 R4.5\nG10 L12 P1 R.25\nG21 G10 L10 P2 "
                                           "R120500\nG10 L2 P1 X-350123 B90000\n",
                                           reading);
    EXPECT_EQ(value_of_place(tool_in(read, 1).length), 114.3);
    EXPECT_TRUE(tool_in(read, 1).length->in_inches);
    EXPECT_EQ(value_of_place(tool_in(read, 1).diameter), 12.7);
    EXPECT_DOUBLE_EQ(*value_of_place(tool_in(read, 2).length), 120.5);
    EXPECT_DOUBLE_EQ(*origin_of(read, 0, 0), -350.123);
    EXPECT_DOUBLE_EQ(*origin_of(read, 0, 4), 90.0);
}

TEST(ControlOffsets, AddsUnderG91OnlyToWhatIsStated) {
    const ControlOffsets read = offsets_in("G90 G10 L2 P1 X10.\nG91 G10 L2 P1 X2.5\n");
    EXPECT_EQ(origin_of(read, 0, 0), 12.5);
    EXPECT_NE(mistake_in("G10 G91 L2 P1 X2.5").find("G91 adds to a value of G54 X"),
              std::string::npos);
}

TEST(ControlOffsets, SkipsWhatElseAFileOfProgramsHolds) {
    const ControlOffsets read =
        offsets_in("%\nO0001\nG65 P9810 X[#24+1] F#9\nIF[#1EQ#0]GOTO10\nG0 X1 Y2\n"
                   "G10 L50\nN1240 P1 R100\nN1241 P1 R0\nG10 L10 P9 R9.\nG11\n/G10 L2 P2 X5.\n"
                   "O0002\n(G10 L2 P3 X7.)\nM30\n%\n");
    EXPECT_EQ(origin_of(read, 1, 0), 5.0);
    EXPECT_EQ(read.work.size(), 1u);
    EXPECT_TRUE(read.tools.empty());
    ASSERT_EQ(read.notes.size(), 1u);
    EXPECT_NE(read.notes[0].find("G10 L50 in line 6 is not read"), std::string::npos);
}

TEST(ControlOffsets, ReadsLinesThatBeginWithAMarkOrAComment) {
    EXPECT_EQ(origin_of(offsets_in("\xEF\xBB\xBFG10 L2 P1 X1.\r\n"), 0, 0), 1.0);
    EXPECT_EQ(origin_of(offsets_in("(a) g10 (b) l2 p1 (c) x1. (d)"), 0, 0), 1.0);
    EXPECT_EQ(origin_of(offsets_in("G10 L2 P1 X1. ; a G10"), 0, 0), 1.0);
}

TEST(ControlOffsets, ReadsOneValueForEachNumber) {
    for (const char* text :
         {"G10 L11 P1 R120.\nG10 L11 P2 R98.\n", "G10 P1 R120.\nG10 P2 R98.\n"}) {
        const ControlOffsets read = offsets_in(text);
        EXPECT_EQ(value_of_place(tool_in(read, 1).length), 120.0) << text;
        EXPECT_FALSE(tool_in(read, 1).wear) << text;
        ASSERT_EQ(read.notes.size(), 1u);
        EXPECT_NE(read.notes[0].find("memory A"), std::string::npos);
    }
}

TEST(ControlOffsets, TheLastOfSeveralValuesCounts) {
    const ControlOffsets read = offsets_in("G10 L10 P1 R1.\nG10 L10 P1 R1.\nG10 L10 P1 R2.\n");
    EXPECT_EQ(value_of_place(tool_in(read, 1).length), 2.0);
    ASSERT_EQ(read.notes.size(), 1u);
    EXPECT_NE(read.notes[0].find("line 3: H1 was 1.000 before"), std::string::npos);
}

TEST(ControlOffsets, RefusesBlocksThatCannotBeRead) {
    const std::pair<const char*, const char*> cases[] = {
        {"G10 L10 P1 R#500", "'R#500' is no word with a number"},
        {"G10 L10 P1", "needs R"},
        {"G10 L10 R5.", "needs P"},
        {"G10 X5.", "needs L"},
        {"G10 L10 P0 R5.", "P0: must be a whole number from 1 to 999"},
        {"G10 L10 P1.5 R5.", "P1.5"},
        {"G10 L2 P10 X5.", "from 0 to 9"},
        {"G10 L20 P301 X5.", "from 1 to 300"},
        {"G10 L2 P1 X5. X6.", "X is there twice"},
        {"G10 L2 P1 X", "no word with a number"},
        {"G10 L2 P1 X1. Ö", "no word with a number"},
        {"IF[#1EQ0] G10 L2 P1 X1.", "no word with a number"},
        {"#1=5 G10 L10 P1 R5.", "'#1=5 G10 L10 P1 R5.' is no word"},
    };
    for (const auto& [text, message] : cases)
        EXPECT_NE(mistake_in(text).find(message), std::string::npos)
            << text << ": " << mistake_in(text);
    EXPECT_NE(mistake_in("G21\nG10 L10 P1 R#5").find("offsets.txt:2:12"), std::string::npos)
        << mistake_in("G21\nG10 L10 P1 R#5");
    EXPECT_NE(mistake_in("G10 L20 P1 X0", linuxcnc_reading()).find("where the machine was"),
              std::string::npos);
}

TEST(ControlOffsets, ReadsLinuxCncsVariables) {
    const ControlOffsets read =
        offsets_in("5161\t0.0\n5210\t1\n5211\t3.5\n5220\t1\n5221\t-350\n5222\t-200\n5223\t-420\n"
                   "5230\t12.5\n5381\t7\n5390\t0\n",
                   linuxcnc_reading());
    EXPECT_EQ(origin_of(read, 0, 0), -350.0);
    EXPECT_EQ(origin_of(read, 8, 0), 7.0);
    EXPECT_EQ(value_of_place(read.work.at(0).rotation_deg), 12.5);
    EXPECT_EQ(value_of_place(read.shift.axes[0]), 3.5);
    EXPECT_EQ(read.work.at(0).axes[2]->line, 7u);
    const ControlOffsets off = offsets_in("5210 0\n5211 3.5\n5221 1\n", linuxcnc_reading());
    EXPECT_FALSE(off.shift.axes[0]);
}

TEST(ControlOffsets, ReadsLinuxCncsToolTable) {
    ControlReading reading = linuxcnc_reading();
    reading.unit = LengthUnit::inch;
    const ControlOffsets read =
        offsets_in("; tools\nT1 P1 Z+4.0 D0.25 ;mill\nT12 P2 Z1 ;probe\n", reading);
    EXPECT_EQ(value_of_place(tool_in(read, 1).length), 101.6);
    EXPECT_EQ(value_of_place(tool_in(read, 1).diameter), 6.35);
    EXPECT_FALSE(tool_in(read, 12).diameter);
    EXPECT_EQ(tool_in(read, 12).length->line, 3u);
    EXPECT_TRUE(tool_in(read, 12).length->in_inches);
}

TEST(ControlOffsets, ReadsHaassToolOffsets) {
    const std::string text =
        "<?xml version=\"1.0\" ?>\n<TOOL_OFFSET>\n<TOOL1>\n<ID>03-0549</ID>\n"
        "<LENGTH_GEOMETRY>131.838</LENGTH_GEOMETRY>\n<LENGTH_WEAR>0.5</LENGTH_WEAR>\n"
        "<DIAMETER_GEOMETRY>12.720</DIAMETER_GEOMETRY>\n<DIAMETER_WEAR></DIAMETER_WEAR>\n</TOOL1>\n"
        "<TOOL200><LENGTH_GEOMETRY>1</LENGTH_GEOMETRY></TOOL200>\n<MD5></MD5>\n</TOOL_OFFSET>\n";
    ControlReading reading = fanuc_reading();
    const ControlOffsets read = offsets_in(text, reading);
    EXPECT_EQ(value_of_place(tool_in(read, 1).length), 131.838);
    EXPECT_EQ(value_of_place(tool_in(read, 1).wear), 0.5);
    EXPECT_EQ(value_of_place(tool_in(read, 1).diameter), 12.72);
    EXPECT_FALSE(tool_in(read, 1).diameter_wear);
    EXPECT_EQ(tool_in(read, 1).length->line, 5u);
    EXPECT_EQ(value_of_place(tool_in(read, 200).length), 1.0);
    reading.sizes_are_radii = true;
    EXPECT_EQ(value_of_place(tool_in(offsets_in(text, reading), 1).diameter), 25.44);
    const ControlOffsets more = offsets_in(
        "<A><WORK_OFFSET/><TOOL_OFFSET><TOOL1><LENGTH_GEOMETRY>1</LENGTH_GEOMETRY></TOOL1>"
        "</TOOL_OFFSET></A>");
    ASSERT_EQ(more.notes.size(), 1u);
    EXPECT_NE(more.notes[0].find("WORK_OFFSET is not read"), std::string::npos);
    EXPECT_NE(mistake_in("<A/>").find("no TOOL_OFFSET"), std::string::npos);
    EXPECT_NE(mistake_in("<TOOL_OFFSET>\n<TOOL1>").find("not valid XML"), std::string::npos);
    EXPECT_NE(mistake_in("<TOOL_OFFSET><TOOL1>\n<LENGTH_GEOMETRY>nan</LENGTH_GEOMETRY></TOOL1>"
                         "</TOOL_OFFSET>")
                  .find("offsets.txt:2: LENGTH_GEOMETRY: 'nan' is not a number"),
              std::string::npos);
}

TEST(ControlOffsets, RefusesOtherFiles) {
    for (const char* text : {"", "hello world\n", "{\"a\": 1}", "%\nO1\nG0 X1\nM30\n%\n", "1\n"})
        EXPECT_NE(mistake_in(text).find("no file with offsets that is known"), std::string::npos)
            << text;
    const auto missing = read_control_offsets({"no/such.txt"}, fanuc_reading());
    ASSERT_FALSE(missing.has_value());
    EXPECT_EQ(missing.error().file, "no/such.txt");
}

TEST(ControlOffsets, SaysInWhichUnitItReads) {
    ControlReading reading = fanuc_reading();
    reading.unit_is_stated = false;
    for (const char* text :
         {"G10 L10 P1 R1.", "5221 1", "T1 Z1", "<TOOL_OFFSET><TOOL1/></TOOL_OFFSET>"})
        EXPECT_EQ(offsets_in(text, reading).notes.size(), 1u) << text;
    EXPECT_TRUE(offsets_in("G21 G10 L10 P1 R1.", reading).notes.empty());
}

/// Damages a text: bytes change, lines are repeated, the end is lost.
std::string damaged(std::string text, std::mt19937& random) {
    for (unsigned change = 0; change < 1 + random() % 4; ++change) {
        const size_t at = text.empty() ? 0 : random() % text.size();
        switch (random() % 4) {
        case 0:
            text.resize(at);
            break;
        case 1:
            if (!text.empty()) text[at] = static_cast<char>(random() % 256);
            break;
        case 2:
            text.insert(at, text.substr(at / 2, random() % 30));
            break;
        default:
            text.erase(at, random() % 20);
            break;
        }
    }
    return text;
}

TEST(ControlOffsets, DamagedFilesAreReadOrRefused) {
    const std::string samples[] = {
        "%\nO9001\nG90\nG10 L2 P1 X-350.123 Y-200. Z-420.5\nG10 L10 P1 R120.5 (T1)\nG91 G10 L11 P1 "
        "R1.\nG10 L50\nN1 R1\nG11\n%\n",
        "5210\t1\n5211\t3.5\n5221\t-350\n5230\t12.5\n", "T1 P1 Z+4.0 D0.25 ;mill\nT12 P2 Z1\n",
        "<?xml version=\"1.0\"?>\n<TOOL_OFFSET><TOOL1><LENGTH_GEOMETRY>131.838</LENGTH_GEOMETRY>"
        "</TOOL1></TOOL_OFFSET>\n"};
    std::mt19937 random(20260101);
    size_t accepted = 0, refused = 0;
    for (int round = 0; round < 800; ++round) {
        const std::string text = damaged(samples[round % 4], random);
        const auto read = read_text(text, round % 8 < 4 ? fanuc_reading() : linuxcnc_reading());
        ++(read ? accepted : refused);
        if (!read) {
            EXPECT_FALSE(read.error().message.empty());
            EXPECT_FALSE(read.error().file.empty());
        }
    }
    EXPECT_GT(accepted, 80u);
    EXPECT_GT(refused, 80u);
}

// --- comparison ---------------------------------------------------------------------------------

SetupFile setup_with(const std::string& toml) {
    auto read = read_setup(kept_folder().write("plate.toml", toml), {});
    EXPECT_TRUE(read.has_value()) << error_text(read.error());
    return read.value_or(SetupFile{});
}

const char* const plate = R"(
[program]
dialect = "fanuc"
[offsets]
G54 = { X = -350, Y = -200, Z = -420 }
[stock]
box = [[0, 0, -30], [100, 100, 0]]
[[tool]]
number = 1
shape = "flat"
diameter = 10
flute_length = 20
gauge_length = 120
stick_out = 40
holder = [[40, 40, 80]]
[[tool]]
number = 2
shape = "flat"
diameter = 6
flute_length = 15
gauge_length = 98
)";

std::map<std::string, ComparedOffset> rows_of(const OffsetComparison& comparison) {
    std::map<std::string, ComparedOffset> rows;
    for (const ComparedOffset& value : comparison.values)
        EXPECT_TRUE(rows.emplace(value.name, value).second) << value.name;
    return rows;
}

TEST(OffsetDifferences, ComparesWhatTheProgramUses) {
    const SetupFile setup = setup_with(plate);
    const ControlOffsets control =
        offsets_in("G10 L2 P1 X-350. Y-200.0004 Z-419.5\nG10 L2 P2 X1. Y1. Z1.\n"
                   "G10 L10 P1 R119.9\nG10 L11 P1 R0.1\nG10 L10 P2 R97.\nG10 L12 P1 R10.002\n");
    const auto compared = differences(setup, control,
                                      {.work = {0},
                                       .lengths = {OffsetNumber{1}, OffsetNumber{3}},
                                       .diameters = {OffsetNumber{1}}});
    const auto rows = rows_of(compared);
    ASSERT_EQ(rows.size(), 6u);
    EXPECT_EQ(rows.at("G54 X").state, OffsetState::equal);
    EXPECT_EQ(rows.at("G54 Y").state, OffsetState::equal);
    EXPECT_EQ(rows.at("G54 Z").state, OffsetState::differs);
    EXPECT_EQ(rows.at("G54 Z").line, 1u);
    EXPECT_EQ(rows.at("H1").state, OffsetState::equal); // with its wear
    EXPECT_EQ(rows.at("H3").state, OffsetState::not_in_setup);
    EXPECT_EQ(rows.at("D1").state, OffsetState::differs);
    EXPECT_EQ(compared.differences(), 3u);
}

/// The set-up after its work offsets were replaced by those of the control.
std::string taken(const std::string& text, const std::string& control,
                  const std::set<size_t>& used = {0}) {
    const auto changed =
        with_work_offsets(text, differences(setup_with(text), offsets_in(control), {.work = used}));
    EXPECT_TRUE(changed) << (changed ? "" : changed.error().message);
    return changed.value_or("");
}

TEST(OffsetDifferences, AreGoneAfterTheControlsWereTaken) {
    const std::string control = "G10 L2 P1 X-350. Y-201.25 Z-419.5\nG10 L2 P2 X1. Y2. Z3. A30.\n";
    const std::string text = taken(plate, control, {0, 1});
    EXPECT_NE(text.find("G54 = { X = -350, Y = -201.25, Z = -419.5 }"), std::string::npos) << text;
    const auto left =
        differences(setup_with(text), offsets_in(control), {.work = {0, 1}}).differences();
    EXPECT_EQ(left, 0u) << text;
    EXPECT_EQ(taken(text, control, {0, 1}), text);
}

TEST(OffsetDifferences, KeepWhatTheControlDoesNotStateAndWhatIsEqual) {
    EXPECT_EQ(taken(plate, "G10 L2 P1 X-350.0004\n"), std::string(plate));
    const std::string text = taken(plate, "G10 L2 P1 Z-400.\n");
    EXPECT_NE(text.find("G54 = { X = -350, Y = -200, Z = -400 }"), std::string::npos) << text;
}

TEST(OffsetDifferences, TakeTheRestOfAnOffsetFromTheVariablesFile) {
    kept_folder().write("old.var", "5221 -350\n5222 -200\n5223 -420\n");
    std::string text(plate);
    const std::string before = text.substr(0, text.find("[stock]"));
    text.replace(0, before.size(), "[program]\ndialect = \"linuxcnc\"\nparameters = \"old.var\"\n");
    text = taken(text, "G10 L2 P1 X-350. Y-200. Z-410.\n");
    EXPECT_NE(text.find("G54 = { X = -350, Y = -200, Z = -410 }"), std::string::npos) << text;
}

TEST(OffsetDifferences, LeavesOutKindsThatNoFileStates) {
    const SetupFile setup = setup_with(plate);
    const UsedOffsets used{.work = {0}, .lengths = {OffsetNumber{1}}, .diameters = {}};
    const auto lengths = differences(setup, offsets_in("G10 L10 P1 R120.\n"), used);
    EXPECT_EQ(rows_of(lengths).size(), 1u);
    EXPECT_EQ(lengths.differences(), 0u);
    ASSERT_EQ(lengths.notes.size(), 1u);
    EXPECT_EQ(lengths.notes[0], "no file states work offsets");
    const auto other = differences(setup, offsets_in("G10 L2 P2 X1.\n"), used);
    EXPECT_EQ(rows_of(other).at("G54 X").state, OffsetState::not_on_control);
}

TEST(OffsetDifferences, CountsInTheLastDigitOfInches) {
    const SetupFile setup = setup_with(plate);
    const UsedOffsets used{.work = {}, .lengths = {OffsetNumber{1}}, .diameters = {}};
    // 120 mm is 4.72441 inch; the control shows 4.7244.
    EXPECT_EQ(differences(setup, offsets_in("G20 G10 L10 P1 R4.7244\n"), used).differences(), 0u);
    EXPECT_EQ(differences(setup, offsets_in("G20 G10 L10 P1 R4.7243\n"), used).differences(), 1u);
    EXPECT_EQ(differences(setup, offsets_in("G10 L10 P1 R120.0005\n"), used).differences(), 0u);
    EXPECT_EQ(differences(setup, offsets_in("G10 L10 P1 R120.0007\n"), used).differences(), 1u);
}

TEST(OffsetDifferences, AddsTheExternalOffset) {
    const SetupFile setup = setup_with(plate);
    const auto compared =
        differences(setup, offsets_in("G10 L2 P0 Z-1.\nG10 L2 P1 X-350. Y-200. Z-419.\n"), {});
    EXPECT_EQ(compared.differences(), 0u);
    EXPECT_EQ(compared.notes.size(), 1u);
}

TEST(OffsetDifferences, ShowsRotationAndG92) {
    SetupFile setup = setup_with(plate);
    const ControlOffsets control =
        offsets_in("5210 1\n5211 2\n5221 -350\n5222 -200\n5223 -420\n5230 3\n", linuxcnc_reading());
    const auto rows = rows_of(differences(setup, control, {}));
    EXPECT_EQ(rows.at("G54 rotation").state, OffsetState::differs);
    EXPECT_TRUE(rows.at("G54 rotation").is_angle);
    EXPECT_EQ(rows.at("G92 X").control, 2.0);
}

TEST(OffsetDifferences, TellsWhatAProgramUses) {
    const auto program = gcode::read_program(kept_folder().write(
        "use.nc", "O1\nG21 G90\nT1 M6\nG55 G0 X0 Y0\nG43 H1 Z5.\nG41 D21 G1 X10. F100.\nY20.\nG40 "
                  "X0\nG53 G0 Z0\nG10 L2 P3 X1. Y1. Z1.\nG56 G0 X0\nG10 L10 P2 R50.\nG43 H2 Z5.\n"
                  "G57\nM30\n"));
    ASSERT_TRUE(program.has_value());
    gcode::Environment environment;
    environment.dialect = DialectId::fanuc;
    environment.length_offsets[OffsetNumber{1}] = {.length = 10.0};
    environment.length_offsets[OffsetNumber{21}] = {.diameter = 6.0};
    const UsedOffsets used = used_offsets(*program, environment);
    EXPECT_EQ(used.work, (std::set<size_t>{1}));
    EXPECT_EQ(used.lengths, (std::set<OffsetNumber>{OffsetNumber{1}}));
    EXPECT_EQ(used.diameters, (std::set<OffsetNumber>{OffsetNumber{21}}));
}

TEST(OffsetDifferences, LinuxCncTakesTheNumbersOfTheTool) {
    const auto program = gcode::read_program(kept_folder().write(
        "own.ngc",
        "G21 G90 G64 P0.01\nT7 M6 G43\nG0 X0 Y0 Z5\nG41 G1 X10 F100\nY20\nG40 X0\nM2\n"));
    ASSERT_TRUE(program.has_value());
    gcode::Environment environment;
    environment.tool_lengths[core::ToolNumber{7}] = 50.0;
    environment.tool_diameters[core::ToolNumber{7}] = 4.0;
    const UsedOffsets used = used_offsets(*program, environment);
    EXPECT_EQ(used.lengths, (std::set<OffsetNumber>{OffsetNumber{7}}));
    EXPECT_EQ(used.diameters, (std::set<OffsetNumber>{OffsetNumber{7}}));
}

TEST(OffsetDifferences, AreShownAsTextAndJson) {
    const SetupFile setup = setup_with(plate);
    const auto compared =
        differences(setup, offsets_in("G10 L2 P1 X-350. Y-200. Z-419.5\n"), {.work = {0}});
    const std::string text = offset_text(compared, {"plate.toml", {"offsets.txt"}});
    EXPECT_NE(text.find("G54 Z               -420.000    -419.500      +0.500   differs ("),
              std::string::npos)
        << text;
    EXPECT_NE(text.find("1 of 3 values does not agree."), std::string::npos) << text;
    const auto json = nlohmann::json::parse(offset_json(compared, {"", {"offsets.txt"}}));
    EXPECT_EQ(json.at("schema"), 1);
    EXPECT_EQ(json.at("differences"), 1);
    EXPECT_TRUE(json.at("setup").is_null());
    EXPECT_EQ(json.at("values").at(2).at("state"), "differs");
    EXPECT_EQ(json.at("values").at(2).at("difference"), 0.5);
    EXPECT_NE(offset_text({}, {}).find("Nothing was compared."), std::string::npos);
}

TEST(OffsetDifferences, AreShownInTheUnitOfTheSetup) {
    const SetupFile setup = setup_with("length_unit = \"inch\"\n[program]\ndialect = \"fanuc\"\n"
                                       "[offsets]\nG54 = { X = -14, Y = -8, Z = -16.5, A = 30 }\n");
    const auto compared =
        differences(setup, offsets_in("G20 G10 L2 P1 X-14. Y-8.0005 Z-16.5 A31.\n"), {.work = {0}});
    const std::string text = offset_text(compared, {"plate.toml", {"offsets.txt"}});
    for (const char* row : {"inches, degrees       set-up     control  difference",
                            "G54 X               -14.0000    -14.0000      0.0000\n",
                            "G54 Y                -8.0000     -8.0005     -0.0005   differs (",
                            "G54 A                 30.000      31.000      +1.000   differs ("})
        EXPECT_NE(text.find(row), std::string::npos) << row << "\n" << text;
    const auto json = nlohmann::json::parse(offset_json(compared, {"", {"offsets.txt"}}));
    EXPECT_EQ(json.at("values").at(0).at("unit"), "mm");
    EXPECT_EQ(json.at("values").at(0).at("setup"), -14 * 25.4);
}

} // namespace
} // namespace app
