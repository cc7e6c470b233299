#include <cmath>
#include <functional>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gcode/klartext/klartext_parser.h"
#include "gcode/language/codes.h"
#include "gcode/lower/lowering.h"
#include "gcode/siemens/siemens_line.h"
#include "tests/gcode/programs.h"

// No dialect may read a code or word and drop the motion of its block. Every code and word of the
// tables is put beside axis words: the block must move there, or be an error. The exceptions are
// listed with their reasons; a new code without a verdict fails.

namespace gcode {
namespace {

/// Programmed beside each code; all differ from the position before, X1 Y2 Z3.
constexpr double asked[3] = {11.0, 22.0, -33.0};

bool is_near(const std::optional<double>& value, double wanted) {
    return value && std::abs(*value - wanted) < 1e-6;
}

/// The ends of the motions of one line, in program and in machine coordinates.
struct Ends {
    std::vector<Position> program, machine;
};

Ends ends_of_line(const Ran& ran, const Environment& environment, uint32_t line) {
    Ends ends;
    Lowering lowering = initial_lowering(environment);
    for (const BlockCommands& block : ran.run.blocks)
        for (const CanonicalCommand& command : block.commands) {
            lowering.lower(command);
            if (block.line != line || !is_motion(command)) continue;
            ends.machine.push_back(lowering.machine);
            ends.program.push_back(program_from_machine(lowering.offsets, lowering.machine));
        }
    return ends;
}

/// Whether the motions bring X and Y to a place and pass its Z, as a canned cycle does, too.
bool reach(const std::vector<Position>& ends, const std::array<double, 3>& place) {
    if (ends.empty()) return false;
    const bool across = is_near(ends.back()[0], place[0]) && is_near(ends.back()[1], place[1]);
    return across && std::any_of(ends.begin(), ends.end(), [&](const Position& end) {
               return is_near(end[2], place[2]);
           });
}

std::array<double, 3> place(const std::function<double(double asked, double start)>& meaning) {
    constexpr double start[3] = {1.0, 2.0, 3.0};
    std::array<double, 3> there{};
    for (size_t axis = 0; axis < 3; ++axis) there[axis] = meaning(asked[axis], start[axis]);
    return there;
}

enum class Outcome { moves, error, drops };

/// The outcome of a block: its motion is as programmed if it ends at the programmed position, read
/// as absolute, incremental, in inches or in machine coordinates of the gauge line or the tip.
Outcome outcome_of(const std::string& before, const std::string& block, DialectId dialect) {
    const Environment environment = known_environment(dialect);
    const auto line = static_cast<uint32_t>(1 + std::count(before.begin(), before.end(), '\n'));
    const std::string end = dialect == DialectId::heidenhain ? "END PGM T MM\n" : "M30\n";
    const Ran ran = run_text(before + block + "\n" + end, environment);
    if (ran.run.error) {
        EXPECT_GE(ran.run.error->where.line, line) << before << ran.run.error->message;
        return Outcome::error;
    }
    const Ends ends = ends_of_line(ran, environment, line);
    const bool as_programmed =
        reach(ends.program, place([](double to, double) { return to; }))
        || reach(ends.program, place([](double to, double from) { return from + to; }))
        || reach(ends.program, place([](double to, double) { return 25.4 * to; }))
        || reach(ends.machine, place([](double to, double) { return to; }));
    return as_programmed ? Outcome::moves : Outcome::drops;
}

/// Codes and words beside which axis words are not the end of a motion, and why.
using Reasons = std::map<std::string, std::string>;

const Reasons of_every_iso_dialect = {
    {"G10", "the words are values of a table"},
    {"G28", "goes through the position to the reference point"},
    {"G30", "goes through the position to the second reference point"},
    {"G92", "the words set an offset"}};

const Reasons of_fanuc = {{"G4", "X is a time"},
                          {"G5.1", "the words name the axes of a smoothing function"},
                          {"G16", "X and Y are a radius and an angle"},
                          {"G50.1", "the words are of a mirror image"},
                          {"G51", "the words are of scaling"},
                          {"G51.1", "the words are of a mirror image"},
                          {"G52", "the words set an offset"},
                          {"G68", "the words are a centre of rotation"},
                          {"G68.2", "the words are the origin of a plane"},
                          {"G92.1", "the words choose the axes whose shift ends"}};

Reasons both(Reasons reasons, const Reasons& more) {
    reasons.insert(more.begin(), more.end());
    return reasons;
}

std::string missing_reasons(const std::vector<std::string>& dropped, const Reasons& reasons) {
    std::string missing;
    for (const std::string& code : dropped)
        if (!reasons.contains(code)) missing += code + " ";
    return missing;
}

std::string useless_reasons(const std::vector<std::string>& dropped, const Reasons& reasons) {
    std::string useless;
    for (const auto& [code, reason] : reasons)
        if (std::find(dropped.begin(), dropped.end(), code) == dropped.end()) useless += code + " ";
    return useless;
}

void expect_reasons(const std::vector<std::string>& dropped, const Reasons& reasons) {
    EXPECT_EQ(missing_reasons(dropped, reasons), "")
        << "read beside axis words without moving there, an error, or a reason in the list";
    EXPECT_EQ(useless_reasons(dropped, reasons), "") << "listed, but nothing is dropped";
}

/// The codes of a dialect beside which a motion is dropped, with any of the given other words.
std::vector<std::string> dropping_codes(DialectId dialect, const std::string& before,
                                        const std::vector<std::string>& words) {
    std::vector<std::string> dropping;
    for (int number = 0; number < 2 * tenths_end; ++number) {
        const auto code = CodeNumber(number);
        if (!find_code(code, dialect)) continue;
        const auto drops = [&](const std::string& more) {
            const std::string block = written(code) + " X11 Y22 Z-33" + more;
            return outcome_of(before, block, dialect) == Outcome::drops;
        };
        if (std::any_of(words.begin(), words.end(), drops)) dropping.push_back(written(code));
    }
    return dropping;
}

const std::vector<std::string> words_of_codes = {"",    " I5 J10", " R5 Q2",    " P1",
                                                 " K1", " H1 D1",  " R5 P1 Q2", " L2 P1"};

TEST(MotionKept, BesideEveryCodeOfLinuxcnc) {
    const std::string before = "G21 G90 F100 T1 M6 S1000 M3\nG1 X1 Y2 Z3\n";
    expect_reasons(
        dropping_codes(DialectId::linuxcnc, before, words_of_codes),
        both(of_every_iso_dialect, {{"G5.2", "a control point; the motion is that of G5.3"},
                                    {"G7", "X is a diameter"},
                                    {"G33.1", "goes there and back"},
                                    {"G43.1", "the words are a tool offset"},
                                    {"G52", "the words set an offset"}}));
}

TEST(MotionKept, BesideEveryCodeOfFanuc) {
    const std::string before = "G21 G90 F100 T1 M6 S1000 M3\nG1 X1 Y2 Z3\n";
    expect_reasons(dropping_codes(DialectId::fanuc, before, words_of_codes),
                   both(both(of_every_iso_dialect, of_fanuc), {{"G22", "the words are limits"}}));
}

TEST(MotionKept, BesideEveryCodeOfHaas) {
    const std::string before = "G21 G90 F100 T1 M6 S1000 M3\nG1 X1 Y2 Z3\n";
    expect_reasons(
        dropping_codes(DialectId::haas, before, words_of_codes),
        both(both(of_every_iso_dialect, of_fanuc), {{"G100", "the words are of a mirror image"},
                                                    {"G101", "the words are of a mirror image"},
                                                    {"G174", "taps there and comes back"},
                                                    {"G184", "taps there and comes back"}}));
}

TEST(MotionKept, BesideEveryCodeOfGrbl) {
    const std::string before = "G21 G90 F100 S1000 M3\nG1 X1 Y2 Z3\n";
    expect_reasons(dropping_codes(DialectId::grbl, before, words_of_codes),
                   both(of_every_iso_dialect, {{"G49", "takes the words and does not move"}}));
}

TEST(MotionKept, BesideEveryCodeOfSiemens) {
    const std::string before = "G710 G90 F100 T1 M6\nS1000 M3 G94\nG1 X1 Y2 Z3\n";
    expect_reasons(
        dropping_codes(DialectId::siemens, before, {"", " I5 J10", " K1", " CR=20", " F100"}),
        {{"G25", "the words are limits"},
         {"G26", "the words are limits"},
         {"G74", "goes to the reference point; the values do not count"},
         {"G75", "goes to the fixed point; the values do not count"},
         {"G110", "the words are a pole"},
         {"G111", "the words are a pole"},
         {"G112", "the words are a pole"}});
}

TEST(MotionKept, BesideEveryCodeOfSiemensIsoMode) {
    const std::string before = "G21 G90 F100 T1 M6 S1000 M3\nG1 X1 Y2 Z3\n";
    expect_reasons(dropping_codes(DialectId::siemens_iso, before, words_of_codes),
                   both(both(of_every_iso_dialect, of_fanuc), {{"G22", "the words are limits"}}));
}

TEST(MotionKept, BesideEveryCodeOfKlartext) {
    const std::string before = "BEGIN PGM T MM\nTOOL CALL 1 Z S1000\nL X+1 Y+2 Z+3 F100 M3\n";
    std::vector<std::string> dropping;
    for (int number = 0; number < 2 * tenths_end; ++number) {
        const auto code = CodeNumber(number);
        if (!find_code(code, DialectId::heidenhain) || letter_of(code) != 'M') continue;
        for (const char* words : {"L X+11 Y+22 Z-33 R0 F100 ", "L X+11 Y+22 Z-33 R0 FMAX "})
            if (outcome_of(before, words + written(code), DialectId::heidenhain) == Outcome::drops)
                dropping.push_back(written(code));
    }
    expect_reasons(dropping, {});
}

TEST(MotionKept, BesideEveryWordOfSiemens) {
    const std::string before = "G710 G90 F100 T1 M6\nS1000 M3 G94\nG1 X1 Y2 Z3\n";
    std::vector<std::string> dropping;
    for (const SiemensKeyword& keyword : siemens_keywords()) {
        const std::string name(keyword.name);
        for (const std::string& word : {name, name + "=1", name + "=AC(1)", name + "(1)",
                                        name + "(1,0)", name + "(X)", name + "[1]=1"})
            if (outcome_of(before, word + " X11 Y22 Z-33", DialectId::siemens) == Outcome::drops)
                dropping.push_back(name);
    }
    expect_reasons(dropping, {{"AMIRROR", "the words are of a frame"},
                              {"AROT", "the words are of a frame"},
                              {"ASCALE", "the words are of a frame"},
                              {"ATRANS", "the words are of a frame"},
                              {"DIAMON", "X is a diameter"},
                              {"MIRROR", "the words are of a frame"},
                              {"ROT", "the words are of a frame"},
                              {"SCALE", "the words are of a frame"},
                              {"TRANS", "the words are of a frame"}});
}

TEST(MotionKept, BesideEveryWordOfKlartext) {
    const std::string before = "BEGIN PGM T MM\nTOOL CALL 1 Z S1000\nL X+1 Y+2 Z+3 F100 M3\n";
    std::vector<std::string> dropping;
    for (const std::string& word : klartext_words())
        for (const char* rest :
             {" X+11 Y+22 Z-33", " X+11 Y+22 Z-33 R+20 DR+", " FORM X+11 Y+22 Z-33",
              " RESET TCPM X+11 Y+22 Z-33", ".1 X+11 Y+22 Z-33", " CALL 1 X+11 Y+22 Z-33",
              " PGM X+11 Y+22 Z-33"})
            if (outcome_of(before, word + rest, DialectId::heidenhain) == Outcome::drops)
                dropping.push_back(word);
    Reasons reasons = {{"BLK", "the words are corners of the raw stock"},
                       {"END", "the words are the name of the program"},
                       {"FUNCTION", "the words are parameters of TCPM"}};
    for (const std::string& word : dropping)
        if (word.starts_with("CYCL DEF")) reasons[word] = "the words are of the cycle or its name";
    expect_reasons(dropping, reasons);
}

} // namespace
} // namespace gcode
