#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "gcode/exec/readings.h"
#include "gcode/language/control.h"
#include "tests/gcode/programs.h"

namespace gcode {
namespace {

Environment reporting(DialectId dialect) {
    Environment environment = known_environment(dialect);
    environment.control.reports_premises = true;
    environment.length_offsets[core::OffsetNumber{1}] = {.length = 60.0};
    environment.tool_lengths[core::ToolNumber{1}] = 60.0;
    return environment;
}

/// A program run to its end, with its last state.
struct Read {
    Program program;
    std::unique_ptr<ProgramLibrary> library;
    InterpreterState state;
    std::vector<double> xs; // X after each block that moves
    std::string warnings;
    std::optional<core::Error> error;

    bool visits(double x) const { return std::find(xs.begin(), xs.end(), x) != xs.end(); }

    /// "8 taken 0 of 2" for each premise that was met.
    std::string met() const {
        std::string text;
        for (const OpenPremise& premise : state.readings->met)
            text += (text.empty() ? "" : ", ") + std::to_string(premise.line) + " taken "
                    + std::to_string(premise.taken);
        return text;
    }
};

Read read(const std::string& text, const Environment& environment,
          const std::map<PremiseId, size_t>& chosen = {}) {
    Read result;
    result.program = program_from_text(text, "test.nc").value();
    result.library = std::make_unique<ProgramLibrary>(result.program, dialect(environment.dialect));
    Interpreter interpreter(*result.library, environment);
    result.state = initial_state(environment);
    result.state.readings.write().chosen = chosen;
    while (true) {
        const auto next = interpreter.next(result.state);
        if (!next) result.error = next.error();
        if (!next || !*next) return result;
        for (const CanonicalCommand& command : (*next)->commands)
            if (is_motion(command))
                result.xs.push_back(result.state.modal.position[0].value_or(-1));
        for (const Warning& warning : (*next)->warnings)
            result.warnings += std::string(warning.rule) + ": " + warning.message + "\n";
    }
}

PremiseId length_premise() { return {.question = ControlQuestion::length_change_moves}; }

constexpr const char* lone_g49 = "G21 G90 G94\nG43 H1 G0 Z100.\nZ50.\nG49\nM30\n";

TEST(Readings, ALengthChangeAloneIsOpenOnFanuc) {
    const Read usual = read(lone_g49, reporting(DialectId::fanuc));
    EXPECT_EQ(usual.met(), "4 taken 0");
    EXPECT_EQ(usual.state.modal.position[2], 110.0); // the machine stays: 50 + 60
}

TEST(Readings, ALengthChangeAloneMovesWhereThatIsChosen) {
    const Read moved = read(lone_g49, reporting(DialectId::fanuc), {{length_premise(), 1}});
    EXPECT_EQ(moved.met(), "4 taken 1");
    EXPECT_EQ(moved.state.modal.position[2], 50.0);
}

TEST(Readings, AStatedParameterIsNotOpen) {
    for (const bool moves : {false, true}) {
        Environment environment = reporting(DialectId::fanuc);
        environment.control.answers[ControlQuestion::length_change_moves] = moves;
        const Read stated = read(lone_g49, environment);
        EXPECT_EQ(stated.met(), "");
        EXPECT_EQ(stated.state.modal.position[2], moves ? 50.0 : 110.0);
    }
}

TEST(Readings, ALengthChangeWithAbsoluteZIsNotOpen) {
    EXPECT_EQ(read("G21 G90\nG43 H1 G0 Z100.\nG49 Z200.\nM30\n", reporting(DialectId::fanuc)).met(),
              "");
}

TEST(Readings, ALengthChangeIsOpenOnFanucOnly) {
    for (const DialectId dialect : {DialectId::haas, DialectId::linuxcnc})
        EXPECT_EQ(read(lone_g49, reporting(dialect)).met(), "") << int(dialect);
}

TEST(Readings, AnEnvironmentThatDoesNotReportPremisesMeetsNone) {
    Environment environment = reporting(DialectId::fanuc);
    environment.control.reports_premises = false;
    EXPECT_EQ(read(lone_g49, environment).met(), "");
    EXPECT_EQ(read("G21 G90\nG0 X#500\nM30\n", environment).warnings, "");
}

TEST(Readings, ALengthWithoutAPointIsOpenOnFanucAndHaas) {
    constexpr const char* text = "G21 G90 G94\nG0 X0 Y0.\nX100\nX50.\nM30\n";
    for (const DialectId dialect : {DialectId::fanuc, DialectId::haas}) {
        const Read units = read(text, reporting(dialect));
        EXPECT_EQ(units.met(), "3 taken 0");
        const Read steps =
            read(text, reporting(dialect), {{{.question = ControlQuestion::point_is_implied}, 1}});
        EXPECT_TRUE(units.visits(100));
        EXPECT_TRUE(steps.visits(0.1));
        EXPECT_TRUE(steps.visits(50));
    }
    EXPECT_EQ(read(text, reporting(DialectId::linuxcnc)).met(), "");
}

TEST(Readings, ABranchOnAnInputIsOpen) {
    const Read low =
        read("G21 G90\nIF[#1000EQ1]GOTO10\nG0 X1.\nN10 G0 X2.\nM30\n", reporting(DialectId::fanuc));
    EXPECT_EQ(low.met(), "2 taken 0");
    EXPECT_TRUE(low.visits(1));
    const Read high = read("G21 G90\nIF[#1000EQ1]GOTO10\nG0 X1.\nN10 G0 X2.\nM30\n",
                           reporting(DialectId::fanuc), {{{.line = {0, 2}}, 1}});
    EXPECT_EQ(high.met(), "2 taken 1");
    EXPECT_FALSE(high.visits(1));
}

TEST(Readings, AnAnswerOfTheOperatorIsOpen) {
    constexpr const char* text = "G21 G90\n#501=0.\nM109 P501 (CLAMPED?)\n"
                                 "IF [#501 EQ 89.] GOTO10\nG0 X1.\nN10 G0 X2.\nM30\n";
    const Read no = read(text, reporting(DialectId::haas));
    EXPECT_EQ(no.met(), "4 taken 0");
    EXPECT_TRUE(no.visits(1));
    const Read yes = read(text, reporting(DialectId::haas), {{{.line = {0, 4}}, 1}});
    EXPECT_EQ(yes.met(), "4 taken 1");
    EXPECT_FALSE(yes.visits(1));
    Environment stated = reporting(DialectId::haas);
    stated.control.values[501] = 89.0;
    const Read known = read(text, stated);
    EXPECT_EQ(known.met(), "");
    EXPECT_FALSE(known.visits(1));
    const Read used = read("G21 G90\nM109 P10501\nG0 X#501\nM30\n", reporting(DialectId::haas));
    EXPECT_NE(used.warnings.find("unknown-value"), std::string::npos) << used.warnings;
}

TEST(Readings, AStoredPositionOfGrblIsUnknown) {
    Environment environment = reporting(DialectId::grbl);
    environment.home = {};
    const Read unknown = read("G21 G90\nG28 G91 Z0\nG90\n", environment);
    EXPECT_NE(unknown.warnings.find("unknown-value"), std::string::npos) << unknown.warnings;
    EXPECT_FALSE(unknown.state.modal.position[2]);
    const Read stored = read("G21 G90\nG0 X7 Z30\nG28.1\nG0 Z5\nG28 G91 Z0\nG90\n", environment);
    EXPECT_EQ(stored.warnings, "");
    EXPECT_EQ(stored.state.modal.position[2], 30.0);
}

TEST(Readings, ABranchOnAVariableThatWasNeverSetIsOpen) {
    constexpr std::pair<DialectId, const char*> programs[] = {
        {DialectId::fanuc, "G21 G90\nIF[#500EQ1]GOTO10\nG0 X1.\nN10 G0 X2.\nM30\n"},
        {DialectId::haas, "G21 G90\nIF[#500EQ1]GOTO10\nG0 X1.\nN10 G0 X2.\nM30\n"},
        {DialectId::linuxcnc, "G21 G90\no1 if [#500 EQ 1]\nG0 X1\no1 endif\nM2\n"},
        {DialectId::siemens, "G71 G90\nIF R5==1 GOTOF MARK\nG0 X1\nMARK: G0 X2\nM30\n"},
        {DialectId::heidenhain, "BEGIN PGM A MM\nFN 9: IF +Q5 EQU +1 GOTO LBL 1\nL X+1 FMAX\n"
                                "LBL 1\nL X+2 FMAX\nEND PGM A MM\n"},
    };
    for (const auto& [dialect, text] : programs) {
        const Read open = read(text, reporting(dialect));
        EXPECT_EQ(open.met(), "2 taken 0") << text;
        EXPECT_FALSE(open.error) << open.error->message;
    }
}

/// A Fanuc program in which each condition that holds skips the move to X1, X2 ...
std::string program_with(const std::vector<std::string>& lines) {
    std::string text = "G21 G90\n";
    int label = 0;
    for (const std::string& line : lines) {
        if (!line.starts_with("IF")) {
            text += line + "\n";
            continue;
        }
        const std::string n = std::to_string(++label);
        text += line + "GOTO" + n + "\nG0 X" + n + ".\nN" + n + "\n";
    }
    return text + "M30\n";
}

TEST(Readings, AConditionThatEarlierOnesSettleIsNotOpen) {
    const std::vector<std::vector<std::string>> programs = {
        {"IF[#500EQ1]", "IF[#500EQ1]"},
        {"IF[#500EQ1]", "IF[#500NE1]"},
        {"IF[#500GE0]", "IF[#500LT0]"},
        {"IF[#500LT0]", "IF[0LE#500]"},
        {"#1=#500", "IF[#500EQ1]", "IF[#1EQ1]"},
        {"#1=#500*2", "IF[#1EQ1]", "#2=#1", "IF[#2EQ1]"},
        {"IF[#500EQ#501]", "IF[#501NE#500]"},
        {"IF[#500LT#501]", "IF[#501GT#500]"},
        {"IF[[#500EQ1]OR[#501EQ1]]", "IF[[#500EQ1]OR[#501EQ1]]"},
        {"#1=#1000", "IF[#1EQ1]", "IF[#1EQ1]"},
    };
    for (const auto& lines : programs) {
        const std::string text = program_with(lines);
        const Read open = read(text, reporting(DialectId::fanuc));
        EXPECT_EQ(open.state.readings->met.size(), 1U) << text;
    }
}

TEST(Readings, AConditionThatEarlierOnesDoNotSettleIsOpen) {
    const std::vector<std::vector<std::string>> programs = {
        {"IF[#500EQ1]", "IF[#500EQ2]"},                     // 0 is assumed: neither
        {"IF[#500EQ1]", "IF[#501EQ1]"},                     //
        {"IF[#1000EQ1]", "IF[#1000EQ1]"},                   // an input
        {"#1=#1000", "IF[#1EQ1]", "#1=#1000", "IF[#1EQ1]"}, //
        {"IF[#500EQ1]", "#500=#501", "IF[#500EQ1]"},
        {"#2=1", "IF[#500EQ#2]", "#2=2", "IF[#500EQ#2]"},
        {"IF[#500EQ0]", "IF[#500LT1]"}, // vacant: not 0, but less than 1
        {"#1=#1000", "#2=#1", "IF[#1EQ1]", "#1=#1000", "IF[#1EQ1]"},
    };
    for (const auto& lines : programs) {
        const std::string text = program_with(lines);
        const Read open = read(text, reporting(DialectId::fanuc));
        EXPECT_EQ(open.state.readings->met.size(), 2U) << text;
    }
}

TEST(Readings, TheOutcomeThatWasChosenSettlesLaterConditions) {
    const std::string text =
        program_with({"IF[#500EQ1]", "IF[#500GT0]", "IF[#500EQ2]", "IF[#500NE1]"});
    const Read one = read(text, reporting(DialectId::fanuc), {{{.line = {0, 2}}, 1}});
    EXPECT_EQ(one.met(), "2 taken 1");
    EXPECT_FALSE(one.visits(1));
    EXPECT_FALSE(one.visits(2));
    EXPECT_TRUE(one.visits(3));
    EXPECT_TRUE(one.visits(4));
}

TEST(Readings, AnArgumentOfACallStandsForItsVariable) {
    const Read macro = read("G21 G90\nIF[#500EQ1]GOTO1\nG0 X1.\nN1 G65 P9000 A#500\nM30\n"
                            "O9000\nIF[#1EQ1]GOTO2\nG0 X2.\nN2 M99\n",
                            reporting(DialectId::fanuc));
    EXPECT_EQ(macro.state.readings->met.size(), 1U);
    const Read named = read("G21 G90\nG65 P9000 A#500\nM30\nO9000\nIF[#1EQ1]GOTO2\nG0 X2.\n"
                            "N2 M99\n",
                            reporting(DialectId::fanuc));
    ASSERT_EQ(named.state.readings->met.size(), 1U);
    EXPECT_NE(named.state.readings->met[0].cure.find("#500"), std::string::npos)
        << named.state.readings->met[0].cure;
    const Read call = read("o<a> sub\no1 if [#1 EQ 1]\nG0 X1\no1 endif\no<a> endsub\nG21 G90\n"
                           "o2 if [#500 EQ 1]\nG0 X2\no2 endif\no<a> call [#500]\n"
                           "o<a> call [#501]\nM2\n",
                           reporting(DialectId::linuxcnc));
    EXPECT_EQ(call.state.readings->met.size(), 2U);
}

TEST(Readings, EachLanguageSettlesConditions) {
    constexpr std::pair<DialectId, const char*> programs[] = {
        {DialectId::haas, "G21 G90\nIF[#500EQ1]GOTO10\nG0 X1.\nN10 IF[#500EQ1]GOTO20\nG0 X2.\n"
                          "N20 M30\n"},
        {DialectId::linuxcnc, "G21 G90\no1 if [#500 EQ 1]\nG0 X1\no1 endif\no2 if [#500 NE 1]\n"
                              "G0 X2\no2 endif\nM2\n"},
        {DialectId::siemens, "G71 G90\nIF R5==1 GOTOF A1\nG0 X1\nA1: IF R5<>1 GOTOF A2\nG0 X2\n"
                             "A2: M30\n"},
        {DialectId::heidenhain, "BEGIN PGM A MM\nFN 9: IF +Q5 EQU +1 GOTO LBL 1\nL X+1 FMAX\n"
                                "LBL 1\nFN 10: IF +Q5 NE +1 GOTO LBL 2\nL X+2 FMAX\nLBL 2\n"
                                "END PGM A MM\n"},
    };
    for (const auto& [dialect, text] : programs)
        EXPECT_EQ(read(text, reporting(dialect)).met(), "2 taken 0") << text;
}

TEST(Readings, AVariableThatTheProgramMakesVacantIsKnown) {
    const Read vacant = read("G21 G90\n#500=#0\nIF[#500EQ#0]GOTO10\nG0 X1.\nN10 G0 X2.\nM30\n",
                             reporting(DialectId::fanuc));
    EXPECT_EQ(vacant.met(), "");
    EXPECT_FALSE(vacant.visits(1));
}

TEST(Readings, AVariableForWhichTheProgramWaitsChanges) {
    const Read waits =
        read("G21 G90\nN1 IF[#500EQ0]GOTO1\nIF[#500EQ0]GOTO10\nG0 X1.\nN10 G0 X2.\nM30\n",
             reporting(DialectId::fanuc), {{{.line = {0, 2}}, 1}});
    EXPECT_FALSE(waits.error) << waits.error->message;
    EXPECT_TRUE(waits.visits(2));
}

TEST(Readings, ASetVariableIsKnown) {
    EXPECT_EQ(read("G90\n#500=3\nIF[#500EQ1]GOTO10\nG0 X1.\nN10 G0 X2.\nM30\n",
                   reporting(DialectId::fanuc))
                  .met(),
              "");
    Environment stated = reporting(DialectId::fanuc);
    stated.control.values = {{500, 1.0}, {1000, 1.0}};
    const Read read_500 = read("G21 G90\nIF[#500EQ1]GOTO10\nG0 X1.\nN10 G0 X2.\nM30\n", stated);
    EXPECT_EQ(read_500.met(), "");
    EXPECT_FALSE(read_500.visits(1));
    const Read read_1000 = read("G21 G90\nIF[#1000EQ1]GOTO10\nG0 X1.\nN10 G0 X2.\nM30\n", stated);
    EXPECT_EQ(read_1000.met(), "");
    EXPECT_FALSE(read_1000.visits(1));
}

TEST(Readings, AnUnknownValueIsFollowedThroughAssignmentsCallsAndMacros) {
    constexpr const char* programs[] = {
        "#1=#1000\nIF[#1EQ1]GOTO10\nG0 X1.\nN10 G0 X2.\nM30\n",
        "#101=#1000+1\n#1=#101*2\nIF[#1GT1]GOTO10\nG0 X1.\nN10 G0 X2.\nM30\n",
        "G65 P9000 A#1000\nM30\nO9000\nIF[#1EQ1]GOTO10\nG0 X1.\nN10 G0 X2.\nM99\n",
    };
    for (const char* text : programs)
        EXPECT_NE(read(text, reporting(DialectId::fanuc)).met(), "") << text;
    EXPECT_NE(read("o<a> sub\no1 if [#1 EQ 1]\nG0 X1\no1 endif\no<a> endsub\n"
                   "M66 P0 L0\no<a> call [#5399]\nM2\n",
                   reporting(DialectId::linuxcnc))
                  .met(),
              "");
    EXPECT_EQ(read("G90\n#1=#1000\n#1=2\nIF[#1EQ1]GOTO10\nG0 X1.\nN10 G0 X2.\nM30\n",
                   reporting(DialectId::fanuc))
                  .met(),
              "");
}

TEST(Readings, AnUnknownValueInAnAxisWordMakesThePositionUnknown) {
    const Read unknown = read("G21 G90\nG0 X#500 Y5.\nM30\n", reporting(DialectId::fanuc));
    EXPECT_NE(unknown.warnings.find("unknown-value"), std::string::npos);
    EXPECT_FALSE(unknown.state.modal.position[0]);
    EXPECT_EQ(unknown.state.modal.position[1], 5.0);
    const Read feed = read("G21 G90 G94\nG1 X5. F[100+#500]\nM30\n", reporting(DialectId::fanuc));
    EXPECT_EQ(feed.warnings.find("unknown-value"), std::string::npos) << feed.warnings;
}

TEST(Readings, TheSameConditionOnTheSameVariableHasOneOutcome) {
    const Read twice =
        read("G21 G90\nIF[#500EQ1]GOTO10\nN10 G0 X1.\nIF[#500EQ1]GOTO20\nN20 G0 X2.\nM30\n",
             reporting(DialectId::fanuc));
    EXPECT_EQ(twice.met(), "2 taken 0");
    const Read same = read("G21\nN1 #1=1\nIF[#500EQ1] THEN #1=2\nIF[#500EQ1] THEN #1=2\nM30\n",
                           reporting(DialectId::fanuc));
    EXPECT_EQ(same.met(), "3 taken 0");
}

TEST(Readings, AProgramThatWaitsForAnInputGoesOn) {
    const Read waiting =
        read("G21\nN10 IF[#1000EQ0]GOTO10\nG0 X1.\nM30\n", reporting(DialectId::fanuc));
    EXPECT_FALSE(waiting.error) << waiting.error->message;
    EXPECT_TRUE(waiting.visits(1));
    const Read loop =
        read("G21\nWHILE[#1000EQ0]DO1\nEND1\nG0 X1.\nM30\n", reporting(DialectId::fanuc));
    EXPECT_FALSE(loop.error) << loop.error->message;
    EXPECT_TRUE(loop.visits(1));
}

TEST(Readings, AnAlternativeReadingIsReachedFromTheStateBeforeItsBlock) {
    // What a check does: copy the state before the block, choose, run on.
    const Environment environment = reporting(DialectId::fanuc);
    const Program program = program_from_text(lone_g49, "test.nc").value();
    ProgramLibrary library(program, dialect(environment.dialect));
    Interpreter interpreter(library, environment);
    InterpreterState state = initial_state(environment), before;
    while (true) {
        before = state;
        const auto next = interpreter.next(state);
        ASSERT_TRUE(next && *next);
        if (!state.readings->met.empty()) break;
    }
    before.readings.write().chosen = {{length_premise(), 1}};
    ASSERT_TRUE(interpreter.next(before).value());
    EXPECT_EQ(before.modal.position[2], 50.0);
    EXPECT_TRUE(before.readings->met.back().is_chosen);
    EXPECT_NE(digest_of(before), digest_of(state));
}

TEST(Readings, WhereASkipMoveStoppedIsOpen) {
    for (const DialectId dialect : {DialectId::fanuc, DialectId::haas}) {
        const Read branch =
            read("G21 G90 G94\nG31 Z2. F100.\nIF[#5063GT10.]GOTO9\nG0 X1.\nN9 X2.\nM30\n",
                 reporting(dialect));
        EXPECT_EQ(branch.met(), "3 taken 0");
        const Read word =
            read("G21 G90 G94\nG31 X2. F100.\nG0 X[#5061+2.]\nM30\n", reporting(dialect));
        EXPECT_NE(word.warnings.find("unknown-value: X depends on #5061"), std::string::npos)
            << word.warnings;
        EXPECT_FALSE(word.state.modal.position[0]);
    }
}

TEST(Readings, AVariableOfTheMachineThatIsNotModelledIsOpen) {
    for (const int number : {1300, 3030, 4201, 5401, 7501, 8501})
        EXPECT_EQ(
            read("G21 G90\nIF[#" + std::to_string(number) + "GT3]GOTO10\nG0 X1.\nN10 G0 X2.\nM30\n",
                 reporting(DialectId::haas))
                .met(),
            "2 taken 0")
            << number;
    EXPECT_EQ(
        read("G21 G90\nIF[#4003EQ90]GOTO10\nG0 X1.\nN10 G0 X2.\nM30\n", reporting(DialectId::haas))
            .met(),
        "");
}

TEST(Readings, AnOffsetSetToAnUnknownValueIsReported) {
    constexpr std::tuple<DialectId, const char*, const char*> programs[] = {
        {DialectId::fanuc, "G21 G90\n#5203=#500\nG0 Z20.\nM30\n", "#5203 depends on #500"},
        {DialectId::fanuc, "G21 G90\n#2002=#500\nG0 Z20.\nM30\n", "#2002 depends on #500"},
        {DialectId::haas, "G21 G90\n#5223=#500\nG0 Z20.\nM30\n", "#5223 depends on #500"},
        {DialectId::linuxcnc, "G21 G90\n#5223=#120\nG0 Z20\nM2\n", "#5223 depends on #120"},
    };
    for (const auto& [dialect, text, message] : programs) {
        const Read offset = read(text, reporting(dialect));
        EXPECT_NE(offset.warnings.find(std::string("unknown-value: ") + message), std::string::npos)
            << text << offset.warnings;
    }
    EXPECT_EQ(read("G21 G90\n#5203=-30.\nG0 Z20.\nM30\n", reporting(DialectId::fanuc))
                  .warnings.find("unknown-value"),
              std::string::npos);
}

TEST(Readings, PreassignedQParametersAreKnownOrOpen) {
    const auto jump = [](int number) {
        return "BEGIN PGM A MM\nTOOL CALL 1 Z S1000\nFN 11: IF +Q" + std::to_string(number)
               + " GT +3 GOTO LBL 1\nL X+1 FMAX\nLBL 1\nL X+2 FMAX\nEND PGM A MM\n";
    };
    Environment environment = reporting(DialectId::heidenhain);
    environment.tool_diameters[core::ToolNumber{1}] = 12.0;
    for (const int known : {108, 109, 111, 113, 114})
        EXPECT_EQ(read(jump(known), environment).met(), "") << known;
    EXPECT_FALSE(read(jump(108), environment).visits(1)); // the radius is 6
    EXPECT_TRUE(read(jump(113), environment).visits(1));
    for (const int open : {100, 110, 112, 115, 119})
        EXPECT_EQ(read(jump(open), environment).met(), "3 taken 0") << open;
    environment = reporting(DialectId::heidenhain);
    const Read unknown = read(jump(108), environment);
    EXPECT_EQ(unknown.met(), "3 taken 0");
    EXPECT_NE(unknown.state.readings->met[0].reason.find("depends on Q108"), std::string::npos);
}

TEST(Readings, ADwellAndAMessageMayBeUnknown) {
    const Read dwell = read("G21 G90\nG4 X#500\nG0 X1.\nM30\n", reporting(DialectId::fanuc));
    EXPECT_FALSE(dwell.error) << dwell.error->message;
    EXPECT_EQ(dwell.warnings.find("unknown-value"), std::string::npos) << dwell.warnings;
    EXPECT_EQ(read("G21 G90 G94\nG4 P#120\nG0 X1\nM2\n", reporting(DialectId::linuxcnc))
                  .warnings.find("unknown-value"),
              std::string::npos);
    EXPECT_EQ(read("G71 G90\nMSG(R5)\nG0 X1\nM30\n", reporting(DialectId::siemens))
                  .warnings.find("unknown-value"),
              std::string::npos);
}

TEST(Readings, AnUnknownFeedOrSpeedIsAssumed) {
    const Read feed = read("G21 G90 G94\nG1 X5. F#500\nM30\n", reporting(DialectId::fanuc));
    EXPECT_FALSE(feed.error) << feed.error->message;
    EXPECT_NE(feed.warnings.find("F depends on #500"), std::string::npos) << feed.warnings;
    EXPECT_EQ(feed.warnings.find("unknown-value"), std::string::npos);
    const Read speed =
        read("G21 G90 G94\nS#120 M3\nG1 X5 F100\nM2\n", reporting(DialectId::linuxcnc));
    EXPECT_GT(speed.state.modal.speed, 0.0);
}

TEST(Readings, ALoopUntilAnUnknownValueEnds) {
    const Read loop =
        read("G71 G90\nREPEAT\nG0 Z5\nUNTIL R5>3\nG0 X1\nM30\n", reporting(DialectId::siemens));
    EXPECT_FALSE(loop.error) << loop.error->message;
    EXPECT_TRUE(loop.visits(1));
}

TEST(Readings, AJumpToAnUnknownNumberNamesItsVariable) {
    const Read jump = read("G21\nGOTO#500\nN9 G0 X1.\nM30\n", reporting(DialectId::fanuc));
    ASSERT_TRUE(jump.error);
    EXPECT_NE(jump.error->message.find("#500"), std::string::npos) << jump.error->message;
}

TEST(Readings, TheProgramRunsOnTheMachineAndNotInAPreview) {
    EXPECT_TRUE(read("G21 G90\no1 if [#<_task> EQ 1]\nG0 X1\no1 endif\nM2\n",
                     reporting(DialectId::linuxcnc))
                    .visits(1));
}

TEST(ControlPresets, StateParametersThatTheirDialectHas) {
    for (const ControlPreset& preset : control_presets()) {
        EXPECT_EQ(find_preset(preset.name), &preset);
        for (const auto& [key, number] : preset.values)
            EXPECT_TRUE(find_parameter(key, preset.dialect)->answer_of(number))
                << preset.name << " " << key;
    }
}

} // namespace
} // namespace gcode
