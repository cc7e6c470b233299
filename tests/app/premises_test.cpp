#include <gtest/gtest.h>

#include "tests/app/checked.h"

namespace app_test {
namespace {

using test_support::SetupWriter;

/// The worked example with a clamp from Y104 on that is 12 higher than the stock.
SetupWriter plate(const std::string& dialect) {
    SetupWriter setup;
    setup.program("dialect = \"" + dialect + "\"\nstart = { X = -350, Y = -200, Z = 0 }\n");
    setup.fixture("clamp", "box = [[40, 104, -30], [60, 130, 12]]\n");
    return setup;
}

constexpr const char* head = "G21 G90 G17 G40 G49 G80 G94\nG54\nT1 M6\nG43 H1 G0 Z100.\nS1000 M3\n";

std::string lone_g49() { return head + std::string("G0 X50. Y50.\nG0 Z50.\nG49\nM30\n"); }

/// The rules of all errors, with their lines.
std::string errors_with(const std::string& program, const std::string& stated,
                        const std::string& dialect = "fanuc") {
    return check(plate(dialect).also(stated), program).errors();
}

TEST(Premises, AnOpenParameterMakesTheWorstReadingTheVerdict) {
    const Checked open = check(plate("fanuc"), lone_g49());
    EXPECT_EQ(open.errors(), "open-premise 8");
    EXPECT_EQ(open.verdict, "collision");
    EXPECT_EQ(open.status, 1);
    const FindingLine finding = open.finding("open-premise");
    EXPECT_NE(finding.message.find("parameter 5006#6 (TOS) is 0"), std::string::npos);
    EXPECT_NE(finding.message.find("line 8"), std::string::npos) << finding.message;
    EXPECT_NE(finding.cure.find("\"5006#6\" = 1 or 0 under [control]"), std::string::npos);
}

TEST(Premises, AReadingWithManyErrorsIsNotFollowedToItsEnd) {
    // If G91 is active at the start, X runs away beyond its limits.
    std::string program = "G21 G17 G40 G49 G80 G94\nG54\nT1 M6\nG43 H1 G0 Z100.\nS1000 M3\n";
    for (int i = 0; i < 250; ++i) program += i % 2 ? "G0 X20. Y50.\n" : "G0 X80. Y50.\n";
    program += "M30\n";
    const Checked cut_short = check(plate("fanuc"), program);
    const std::string message = cut_short.finding("open-premise").message;
    EXPECT_NE(message.find(" more follow; what comes after them was not checked."),
              std::string::npos)
        << message;
    EXPECT_EQ(cut_short.verdict, "undecided");
    // Where only collisions of other readings are reported, all of them are looked for.
    const Checked whole =
        check(plate("fanuc").also("[rules]\nopen-premise = \"warning\"\n"), program);
    const std::string all = whole.finding("open-premise").message;
    EXPECT_EQ(all.find("not checked"), std::string::npos) << all;
    EXPECT_NE(all.find(" more follow."), std::string::npos) << all;
}

TEST(Premises, ACommentAllowsNoReadingThatCollides) {
    const std::string program =
        head
        + std::string("G0 X50. Y50.\nG0 Z50.\nIF [#500 EQ 1] GOTO 10 (feeler: allow "
                      "open-premise)\nGOTO 20\nN10 G0 Z-5.\nN20 G0 Z100.\nM30\n");
    const SetupWriter setup = plate("fanuc").also("[rules]\nallow_comments = true\n");
    const Checked checked = check(setup, program);
    EXPECT_EQ(checked.verdict, "collision");
    EXPECT_NE(checked.errors().find("open-premise"), std::string::npos) << checked.errors();
    EXPECT_EQ(checked.status, 1);
}

TEST(Premises, AStatedParameterDecides) {
    EXPECT_EQ(errors_with(lone_g49(), "[control]\n\"5006#6\" = 1\n"), "");
    const std::string moves = errors_with(lone_g49(), "[control]\n\"5006#6\" = 0\n");
    EXPECT_NE(moves.find("rapid-in-stock 8"), std::string::npos) << moves;
    EXPECT_EQ(moves.find("open-premise"), std::string::npos) << moves;
}

TEST(Premises, AnErrorAboutTheWholeProgramIsInEveryReading) {
    const std::string above = head + std::string("G0 X50. Y50.\nG1 X90. F500.\nX10.\nX90.\n");
    const Checked checked = check(plate("fanuc"), above + "G49\nG0 Z200.\nM30\n");
    EXPECT_NE(checked.errors().find("nothing-cut"), std::string::npos) << checked.errors();
    bool has_premise = false;
    for (const std::string& assumption : checked.assumptions) {
        has_premise = has_premise || assumption.find("TOS") != std::string::npos;
        EXPECT_EQ(assumption.find("does not occur"), std::string::npos) << assumption;
    }
    EXPECT_TRUE(has_premise);
}

TEST(Premises, BlockDeleteIsANoteWhereBothPositionsWereChecked) {
    const std::string program = head + std::string("G0 X50. Y50.\n/G0 Z60.\nG0 Z90.\nM30\n");
    const FindingLine both = check(plate("fanuc"), program).finding("block-delete");
    EXPECT_EQ(both.severity, "note");
    EXPECT_EQ(both.cure, "");
    EXPECT_NE(both.message.find("different from line 7 on; both positions of the switch were "
                                "checked"),
              std::string::npos)
        << both.message;
    const FindingLine one =
        check(plate("fanuc"), program, {"--block-delete", "off"}).finding("block-delete");
    EXPECT_EQ(one.severity, "warning");
    EXPECT_NE(one.cure.find("--block-delete on"), std::string::npos) << one.cure;
}

TEST(Premises, ALengthThatNobodyStatedIsNotZero) {
    // The control's length of the tool is not known: with TOS = 0, G49 moves Z by it.
    const std::string program = "%\nO1\n" + lone_g49() + "%\n";
    const test_support::ScopedFolder folder;
    const std::string file = folder.write("p.nc", program);
    const auto errors = [&](const std::vector<std::string>& more) {
        return check_files(file, "", more).errors();
    };
    EXPECT_EQ(errors({"--dialect", "fanuc"}), "open-premise 10");
    EXPECT_EQ(errors({"--dialect", "linuxcnc"}), "");
}

TEST(Premises, AReadingThatTheCheckCannotFinishIsUndecided) {
    const std::string branch = head + std::string("G0 X50. Y50.\nIF[#1005EQ1]GOTO77\nGOTO88\n");
    const std::string end = "N88 G0 Z200.\nM30\n";
    const std::string missing = branch + "N77 G65 P9810 Z-10.\n" + end;
    EXPECT_EQ(errors_with(missing, "[control]\n\"5006#6\" = 1\n"), "open-premise 7");
    // After an alarm of the program, nothing moves.
    const std::string alarm = branch + "N77 #3000=1 (NO PART)\n" + end;
    EXPECT_EQ(errors_with(alarm, "[control]\n\"5006#6\" = 1\n"), "");
}

TEST(Premises, TheCheckMayStopInTheBlockOfAPremise) {
    // X10 is 10 mm or 0.010 mm, and G999 does not exist.
    const Checked stopped = check(plate("fanuc"), head + std::string("G0 Y50.\nG999 X10\nM30\n"));
    EXPECT_EQ(stopped.status, 2);
    EXPECT_EQ(stopped.verdict, "undecided");
    EXPECT_EQ(stopped.errors(), "") << "every reading stops there";
}

TEST(Premises, EachBlockDeleteSwitchIsOneOfItsOwn) {
    const auto errors = [](const std::string& up, const std::string& across) {
        return errors_with(head + std::string("G0 X50. Y50.\nG0 Z5.\n") + up + " G0 Z60.\n" + across
                               + " G0 Y115.\nG0 Z100.\nM30\n",
                           "[control]\n\"5006#6\" = 1\n");
    };
    EXPECT_EQ(errors("/2", "/2"), ""); // both or none
    EXPECT_EQ(errors("/", "/1"), "");
    EXPECT_EQ(errors("/2", "/3"), "open-premise 8");
}

TEST(Premises, AReadingWithoutErrorsIsAnAssumption) {
    const Checked safe =
        check(plate("fanuc"), head + std::string("G0 X50. Y50.\nG0 Z200.\nG49\nM30\n"));
    EXPECT_EQ(safe.errors(), "");
    EXPECT_EQ(safe.verdict, "clear");
    bool said = false;
    for (const std::string& assumption : safe.assumptions)
        said = said || assumption.find("5006#6 (TOS) is 0") != std::string::npos;
    EXPECT_TRUE(said);
}

TEST(Premises, APresetStatesItsParameters) {
    SetupWriter setup = plate("fanuc");
    setup.root("mesh_size = 0.5\ncontrol = \"fanuc-0i-mf\"");
    const std::string as_delivered = check(setup, lone_g49()).errors();
    EXPECT_NE(as_delivered.find("rapid-in-stock 8"), std::string::npos) << as_delivered;
    EXPECT_EQ(errors_with(lone_g49(), "[control]\npreset = \"fanuc-0i-mf\"\n\"5006#6\" = 1\n"), "");
}

TEST(Premises, APresetSelectsTheDialect) {
    SetupWriter setup;
    setup.program("start = { X = -350, Y = -200, Z = 0 }\n");
    setup.root("mesh_size = 0.5\ncontrol = \"haas-ngc\"");
    const Checked result = check(setup, "G21 G90\nG187 P1 E0.05\nM30\n");
    EXPECT_NE(result.status, 2) << result.err;
}

TEST(Premises, AnAssumedLengthIsSaid) {
    const std::string program = head + std::string("G98 G73 X50. Y50. Z-5. R2. Q2. F100.\nM30\n");
    const auto said = [](const Checked& result) {
        std::string text;
        for (const std::string& assumption : result.assumptions)
            if (assumption.find("5114") != std::string::npos) text += assumption;
        return text;
    };
    const Checked assumed = check(plate("fanuc"), program);
    EXPECT_EQ(assumed.errors(), "");
    EXPECT_NE(said(assumed).find("5114, the retract of G73, is 1 mm"), std::string::npos);
    EXPECT_EQ(said(check(plate("fanuc").also("[control]\n\"5114\" = 0.5\n"), program)), "");
}

TEST(Premises, AWordOfTheMakerIsAValue) {
    const std::string program = "G90 G17 G40 G49 G80\nG54\nT1 M6\nG43 H1 G0 Z4.\nM30\n";
    for (const char* unit : {"MM", "INCH"}) {
        const Checked result =
            check(plate("haas").also(std::string("[control]\n\"setting 9\" = \"") + unit + "\"\n"),
                  program);
        EXPECT_NE(result.status, 2) << result.err;
    }
}

TEST(Premises, APositionUnderControlMovesTheToolChange) {
    const std::string program = "G21 G90 G17\nG54\nG0 X50 Y50\nT1 M6\nG43 G0 Z60\nM2\n";
    const std::string away = errors_with(program, "", "linuxcnc");
    const std::string into =
        errors_with(program, "[control]\nTOOL_CHANGE_POSITION = [-300, -150, -480]\n", "linuxcnc");
    EXPECT_NE(away, into);
    EXPECT_NE(into.find("rapid-in-stock 5"), std::string::npos) << into;
}

TEST(Premises, LengthsWithoutAPointAreReadBothWays) {
    const std::string program = head + std::string("G0 X50. Y50.\nG0 Z50\nG0 Y150.\nM30\n");
    for (const char* dialect : {"fanuc", "haas"}) {
        EXPECT_NE(errors_with(program, "", dialect).find("open-premise 7"), std::string::npos);
        const std::string key = dialect == std::string("haas") ? "\"setting 162\"" : "\"3401#0\"";
        EXPECT_EQ(errors_with(program, "[control]\n" + key + " = 1\n", dialect), "");
        const std::string steps = errors_with(program, "[control]\n" + key + " = 0\n", dialect);
        EXPECT_EQ(steps.find("open-premise"), std::string::npos) << steps;
        EXPECT_NE(steps, "");
    }
    EXPECT_EQ(check(plate("fanuc"), program, {"--no-decimal-point", "units"}).errors(), "");
}

TEST(Premises, AStatedValueOfAVariableDecidesABranch) {
    const std::string program =
        head + std::string("G0 X50. Y50.\nG0 Z5.\nIF[#500EQ1]GOTO20\nG0 Z60.\nN20 G0 Y150.\nM30\n");
    EXPECT_EQ(errors_with(program, ""), "open-premise 8");
    EXPECT_EQ(errors_with(program, "[program.values]\n\"#500\" = 2\n"), "");
    EXPECT_NE(errors_with(program, "[program.values]\n\"#500\" = 1\n").find("collision 10"),
              std::string::npos);
}

TEST(Premises, NestedBranchesAreFollowed) {
    // The crash needs both conditions to hold.
    const std::string program = head
                                + std::string("G0 X50. Y50.\nG0 Z60.\nIF[#1000EQ0]GOTO20\n"
                                              "IF[#1001EQ0]GOTO20\nG0 Z5.\nN20 G0 Y150.\nM30\n");
    const Checked result = check(plate("fanuc"), program);
    EXPECT_EQ(result.verdict, "collision");
    EXPECT_NE(result.errors().find("open-premise"), std::string::npos);
    EXPECT_NE(result.finding("open-premise").message.find(" and "), std::string::npos);
}

TEST(Premises, AConditionThatIsMetAgainKeepsItsOutcome) {
    // Both ways lead to line 15 in the same state. Only if #500 is 1, the second pass goes down.
    const std::string program = head
                                + std::string("#1=0\nG0 X50. Y50.\nG0 Z50.\n"
                                              "WHILE [#1 LT 2] DO1\n"
                                              "IF [#500 EQ 1] GOTO 10\nG0 Z50.\nGOTO 20\n"
                                              "N10 G0 Z[50-60*#1]\nGOTO 20\n"
                                              "N20 IF [#501 EQ 1] GOTO 30\n"
                                              "N30 #1=#1+1\nEND1\nG0 Z100.\nM30\n");
    EXPECT_EQ(check(plate("fanuc"), program).verdict, "collision");
    EXPECT_EQ(errors_with(program, "[program.values]\n\"#500\" = 0\n\"#501\" = 0\n"), "");
}

TEST(Premises, TooManyReadingsAreUndecided) {
    std::string program = head + std::string("#1=0\n");
    for (int i = 0; i < 80; ++i)
        program += "IF[#" + std::to_string(500 + i) + "EQ1] THEN #1=#1+1\nG0 Z[100.+#1]\n";
    const Checked result = check(plate("fanuc"), program + "M30\n");
    EXPECT_NE(result.errors().find("open-premise"), std::string::npos);
    EXPECT_EQ(result.verdict, "undecided");
}

TEST(Premises, ALoopThatCountsAnInputEndsAndIsNotClear) {
    const std::string program =
        head
        + std::string("G0 X50. Y50.\nG0 Z60.\nWHILE[#1000EQ0]DO1\nG91 G0 Z-1.\nG90\nEND1\nM30\n");
    const Checked result = check(plate("fanuc"), program);
    EXPECT_NE(result.verdict, "clear");
    EXPECT_NE(result.errors(), "");
}

TEST(Premises, AnUnknownPositionIsNeverClear) {
    const Checked result =
        check(plate("fanuc"), head + std::string("G0 X50. Y50.\nG0 Z#500\nG0 Y150.\nM30\n"));
    EXPECT_NE(result.errors().find("unknown-value 7"), std::string::npos) << result.errors();
    EXPECT_NE(result.verdict, "clear");
}

TEST(Premises, ACollisionIsAnErrorWhateverTheSeverityOfTheRule) {
    const std::string open = errors_with(lone_g49(), "");
    EXPECT_NE(open, "");
    for (const char* severity : {"off", "note", "warning"}) {
        const std::string rules = std::string("[rules]\nopen-premise = \"") + severity + "\"\n";
        const Checked result = check(plate("fanuc").also(rules), lone_g49());
        EXPECT_EQ(result.errors(), open) << severity;
        EXPECT_EQ(result.verdict, "collision") << severity;
        EXPECT_EQ(result.status, 1) << severity;
    }
}

TEST(Premises, AReadingWithoutACollisionHasTheSeverityOfTheRule) {
    // If #500 is 1, the tool passes 1 mm above the clamp.
    const std::string program = head
                                + std::string("G0 X50. Y50.\nG0 Z60.\nIF[#500NE1]GOTO20\nG0 Z13.\n"
                                              "N20 G0 Y150.\nM30\n");
    const auto with = [&](const std::string& rules) {
        return check(plate("fanuc").also("[rules]\n" + rules), program);
    };
    EXPECT_EQ(with("").errors(), "open-premise 8");
    const Checked warned = with("open-premise = \"warning\"\n");
    EXPECT_EQ(warned.finding("open-premise").severity, "warning");
    EXPECT_EQ(warned.status, 0);
    const Checked off = with("open-premise = \"off\"\n");
    EXPECT_EQ(off.verdict, "clear");
    EXPECT_EQ(off.status, 0);
    // What the assumed reading would report as a warning is not an error in another one.
    const Checked lowered = with("rapid-near-clamp = \"warning\"\n");
    EXPECT_EQ(lowered.finding("open-premise").severity, "warning");
    EXPECT_EQ(lowered.status, 0);
}

TEST(Premises, AnErrorThatNeedsTwoPremisesNamesBoth) {
    // Only if the length change moves Z and #500 is 3, the tool meets the clamp: 95 mm lower.
    const std::string program =
        head
        + std::string("G0 X50. Y150.\nG0 Z100.\nG49\nIF[#500EQ3]GOTO10\nG43 H1\n"
                      "N10 G0 Y50.\nM30\n");
    const FindingLine finding = check(plate("fanuc"), program).finding("open-premise");
    for (const char* part : {"5006#6", "#500", "the condition in line 9 holds"})
        EXPECT_NE(finding.message.find(part), std::string::npos) << finding.message;
    EXPECT_NE(finding.cure.find("\"5006#6\" = 1 or 0"), std::string::npos) << finding.cure;
    EXPECT_NE(finding.cure.find("#500"), std::string::npos) << finding.cure;
    EXPECT_EQ(errors_with(program, "[control]\n\"5006#6\" = 1\n"), "");
}

TEST(Premises, ACopyNamesTheVariableThatItWasCopiedFrom) {
    const std::string tail = "IF[#1NE1]GOTO10\nG0 Z5.\nN10 G0 Y150.\nM30\n";
    for (const std::string& copy :
         {std::string("#1=#500\n"), std::string("#101=#500\n#1=#101\n")}) {
        const std::string program = head + std::string("G0 X50. Y50.\nG0 Z60.\n") + copy + tail;
        const Checked open = check(plate("fanuc"), program);
        EXPECT_EQ(open.verdict, "collision");
        EXPECT_NE(open.finding("open-premise").cure.find("#500 "), std::string::npos)
            << open.finding("open-premise").cure;
        EXPECT_EQ(errors_with(program, "[program.values]\n\"#500\" = 0\n"), "");
    }
}

struct BadControl {
    const char *table, *error;
};

class BadControlTable : public testing::TestWithParam<BadControl> {};

TEST_P(BadControlTable, IsRefusedWithAWayOut) {
    const test_support::ScopedFolder folder;
    const std::string program = folder.write("program.nc", lone_g49());
    const std::string setup =
        folder.write("setup.toml", plate("fanuc").also(GetParam().table).text());
    const test_support::Ran ran = feeler({"check", program, "--setup", setup});
    EXPECT_EQ(ran.status, 2);
    EXPECT_NE(ran.err.find(GetParam().error), std::string::npos) << ran.err;
}

INSTANTIATE_TEST_SUITE_P(
    Premises, BadControlTable,
    testing::Values(BadControl{"[control]\n\"5006#7\" = 1\n", "did you mean \"5006#6\""},
                    BadControl{"[control]\n\"5006#6\" = 2\n", "must be 1"},
                    BadControl{"[control]\npreset = \"fanuc-0i\"\n", "fanuc-0i-mf"},
                    BadControl{"[control]\n\"5114\" = -1\n", "a number from 0 to 1000 (mm)"},
                    BadControl{"[control]\n\"5148\" = 3\n", "1, -1, 2 or -2"},
                    BadControl{"[control]\n\"setting 9\" = \"CM\"\n", "\"MM\" or \"INCH\""},
                    BadControl{"[control]\n\"1240\" = [1, 2]\n", "3, 6 or 9 coordinates"},
                    BadControl{"[control]\n\"1240\" = { X = 1, Y = 2 }\n", "X, Y and Z"},
                    BadControl{"[control]\n\"1240\" = { X = 1, Q = 2 }\n", "Q"},
                    BadControl{"[control]\nTOOL_CHANGE_AT_G30 = 1\n", "true or false"},
                    BadControl{"[control]\nTOOL_CHANGE_POS = [0, 0, 0]\n",
                               "did you mean \"TOOL_CHANGE_POSITION\""},
                    BadControl{"[control]\n\"setting 45\" = \"ON\"\n", "not supported"},
                    BadControl{"[control]\n\"setting 43\" = \"B\"\n", "type B is not supported"},
                    BadControl{"[control]\npresett = \"fanuc-0i-mf\"\n", "did you mean \"preset\""},
                    BadControl{"[control]\nTOS = 1\n", "did you mean \"5006#6\""},
                    BadControl{"[control]\nSETTING9 = \"MM\"\n", "did you mean \"setting 9\""},
                    BadControl{"[control]\npreset = 5\n",
                               "the name of a control in quotes: fanuc-0i-mf"},
                    BadControl{"[program.values]\nX = 1\n", "is not the name of a variable"}));

} // namespace
} // namespace app_test
