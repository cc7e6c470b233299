#include <algorithm>
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/checked.h"
#include "tests/support/program_writer.h"

namespace app_test {
namespace {

using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::json;

/// The tables of a complete set-up for the plate of 100 x 100 x 30. All but the last are described
/// in machine coordinates or relative to G54.
const std::vector<std::pair<std::string, std::string>> tables = {
    {"machine", test_support::SetupWriter::mill()},
    {"offsets", "[offsets]\nG54 = { X = -350, Y = -200, Z = -420 }\n"},
    {"stock", "[stock]\nbox = [[0, 0, -30], [100, 100, 0]]\n"},
    {"fixture", "[[fixture]]\nname = \"clamp\"\nbox = [[40, 104, -30], [60, 130, 12]]\n"},
    {"tool", "[[tool]]\n" + test_support::flat_10},
    {"start", "[program]\nstart = { X = -350, Y = -200, Z = 0 }\n"},
};
constexpr unsigned all_tables = 0x3F;

/// The set-up with the tables of which the bit is set.
std::string setup_of(unsigned chosen) {
    std::string text;
    for (size_t i = 0; i < tables.size(); ++i)
        if ((chosen >> i & 1U) != 0) text += tables[i].second + "\n";
    return text;
}

unsigned without(const std::string& name) {
    unsigned chosen = all_tables;
    for (size_t i = 0; i < tables.size(); ++i)
        if (tables[i].first == name) chosen &= ~(1U << i);
    return chosen;
}

const std::string slot =
    test_support::program({"G0 X-20. Y50.", "Z-5.", "G1 X120. F800.", "G0 Z60."});

/// `feeler check` with a set-up; without one if the text is empty.
test_support::Ran run(const std::string& program, const std::string& setup,
                      std::vector<std::string> more = {}) {
    const test_support::ScopedFolder folder;
    folder.write("p.nc", program);
    std::vector<std::string> words = {"check", folder / "p.nc"};
    if (!setup.empty()) {
        folder.write("s.toml", setup);
        more.insert(more.end(), {"--setup", folder / "s.toml"});
    }
    words.insert(words.end(), more.begin(), more.end());
    return feeler(words);
}

Json json_of(const std::string& program, const std::string& setup) {
    return Json::parse(run(program, setup, {"--format", "json"}).out);
}

TEST(Coverage, OfACompleteSetupMakesTheHeadlineClear) {
    const Json report = json_of(slot, setup_of(all_tables));
    EXPECT_EQ(report["headline"], "CLEAR");
    EXPECT_EQ(report["coverage"]["complete"], true);
    EXPECT_EQ(report["coverage"]["tools_without_holder"], Json::array());
    const std::string text = run(slot, setup_of(all_tables)).out;
    EXPECT_THAT(text, HasSubstr("p.nc: CLEAR\n"));
    EXPECT_THAT(text, Not(HasSubstr("unchecked")));
}

TEST(Coverage, NamesWhatASetupLacks) {
    const std::map<std::string, std::pair<std::string, std::string>> lacks = {
        {"machine", {"limits", "missing"}}, {"offsets", {"offsets", "inferred"}},
        {"stock", {"stock", "inferred"}},   {"fixture", {"fixtures", "missing"}},
        {"tool", {"holders", "missing"}},   {"start", {"start", "inferred"}}};
    for (const auto& [table, item] : lacks) {
        const Json report = json_of(slot, setup_of(without(table)));
        EXPECT_EQ(report["verdict"], "clear") << table;
        EXPECT_EQ(report["headline"], "NO ERROR IN THE PROGRAM ITSELF") << table;
        EXPECT_EQ(report["coverage"][item.first], item.second) << table;
        EXPECT_EQ(report["coverage"]["complete"], false) << table;
    }
    EXPECT_EQ(json_of(slot, setup_of(without("tool")))["coverage"]["tools_without_holder"],
              Json::array({1}));
}

TEST(Coverage, WhatASetupCallsAssumedIsNotDescribed) {
    for (const std::string word : {"stock", "offsets", "start"}) {
        const Json report = json_of(slot, "assumed = [\"" + word + "\"]\n" + setup_of(all_tables));
        EXPECT_EQ(report["headline"], "NO ERROR IN THE PROGRAM ITSELF") << word;
        EXPECT_EQ(report["coverage"][word], "inferred") << word;
    }
    const auto wrong = run(slot, "assumed = [\"stok\"]\n" + setup_of(all_tables));
    EXPECT_EQ(wrong.status, 2);
    EXPECT_THAT(wrong.err, HasSubstr("is a list of stock, offsets, start"));
}

/// A tool of which nobody states the diameter, or where the holder is.
TEST(Coverage, ToolsOfWhichASizeIsAGuessAreNotDescribed) {
    const std::string rest = setup_of(without("tool"));
    const std::string holder = "holder = [[40, 40, 60]]\n";
    const auto with_tool = [&](const std::string& sizes) {
        return json_of(slot, rest + "[[tool]]\nnumber = 1\n" + sizes + holder);
    };
    for (const char* sizes : {"", "diameter = 10\n", "stick_out = 40\n",
                              "diameter = 10\nstick_out = 40\n", // the shank may rub
                              "diameter = 10\nshank = [[10, 8, 10]]\n",
                              "shape = \"flat\"\ndiameter = 10\nflute_length = 25\n"
                              "stick_out = \"unknown\"\n"}) {
        const Json report = with_tool(sizes);
        EXPECT_EQ(report["headline"], "NO ERROR IN THE PROGRAM ITSELF") << sizes;
        EXPECT_EQ(report["coverage"]["tools"], "inferred") << sizes;
        EXPECT_EQ(report["coverage"]["tools_assumed"], Json::array({1})) << sizes;
    }
    const Json report = with_tool("diameter = 10\nflute_length = 25\nstick_out = 40\n");
    EXPECT_EQ(report["coverage"]["tools"], "described");
    EXPECT_EQ(report["headline"], "CLEAR");
    const std::string rapid = test_support::program({"G0 X-20. Y50.", "Z60."});
    EXPECT_EQ(json_of(rapid, rest + "[[tool]]\nnumber = 1\n" + holder)["coverage"]["tools"],
              "inferred");
    const std::string text = run(slot, rest + "[[tool]]\nnumber = 1\n" + holder).out;
    EXPECT_THAT(text, HasSubstr("size of T1: assumed"));
}

/// The diameter in a comment counts against one that the set-up states, even alone.
TEST(Coverage, ToolsInPartAreComparedWithTheComment) {
    const std::string rest = setup_of(without("tool"));
    const std::string tool =
        "[[tool]]\nnumber = 1\ndiameter = 12\nstick_out = 40\nholder = [[40, 40, 60]]\n";
    const auto ran = [&](const std::string& size) {
        return run("(T1 D=" + size + " - FLAT END MILL)\n" + slot, rest + tool).out;
    };
    EXPECT_THAT(ran("16."), HasSubstr("tool-mismatch"));
    EXPECT_THAT(ran("12."), Not(HasSubstr("tool-mismatch")));
}

/// So do those of a library, also if the set-up states their holder.
TEST(Coverage, ToolsOfALibraryAreComparedWithTheComment) {
    const auto ran = [&](const std::string& entry, const std::string& comment,
                         const std::string& tool) {
        const test_support::ScopedFolder folder;
        folder.write("l.json", R"({"data": [{"unit": "millimeters", "post-process": {"number": 1},)"
                                   + entry + "}]}");
        const std::string setup = folder.write("s.toml", "tool_library = \"l.json\"\n"
                                                             + setup_of(without("tool")) + tool);
        const std::string program = folder.write("p.nc", "(" + comment + ")\n" + slot);
        return feeler({"check", program, "--setup", setup}).out;
    };
    const std::string mill =
        R"("type": "flat end mill", "geometry": {"DC": 12, "LCF": 26, "LB": 40, "SFDM": 12})";
    const std::string held = "[[tool]]\nnumber = 1\nholder = [[40, 40, 60]]\n";
    for (const std::string& tool : {std::string(), held}) {
        EXPECT_THAT(ran(mill, "T1 D=16. - FLAT END MILL", tool), HasSubstr("tool-mismatch"));
        EXPECT_THAT(ran(mill, "T1 D=12. - FLAT END MILL", tool), Not(HasSubstr("tool-mismatch")));
    }
    // The D of a comment is the diameter at the tip.
    const std::string tapered = R"("type": "tapered mill", "geometry": {"DC": 3, "TA": 5,
        "LCF": 22, "LB": 40, "SFDM": 8})";
    const std::string faces = R"("type": "face mill", "geometry": {"DC": 50, "DCX": 62,
        "LCF": 8, "LB": 40, "SFDM": 22})";
    const std::string rounds = R"("type": "radius mill", "geometry": {"DC": 6, "RE": 3,
        "LCF": 10, "LB": 40, "SFDM": 12})";
    for (const auto& [entry, comment] :
         {std::pair{tapered, "T1 D=3. CR=0. TAPER=5DEG - TAPERED MILL"},
          std::pair{faces, "T1 D=50. CR=0. - FACE MILL"},
          std::pair{rounds, "T1 D=6. CR=3. - RADIUS MILL"}})
        EXPECT_THAT(ran(entry, comment, ""), Not(HasSubstr("tool-mismatch"))) << comment;
}

TEST(Coverage, LimitsAreNotCheckedAgainstAnAssumedOffset) {
    std::string beyond = setup_of(all_tables);
    const std::string offset = "X = -350";
    beyond.replace(beyond.find(offset), offset.size(), "X = 350");
    EXPECT_EQ(run(slot, beyond).status, 1);
    const Json report = json_of(slot, "assumed = [\"offsets\"]\n" + beyond);
    EXPECT_EQ(report["findings"], Json::array());
    EXPECT_EQ(report["coverage"]["limits"], "missing");
}

/// Without tools, the length that G43 adds is not known, so neither is Z of the machine.
TEST(Coverage, LimitsOfZAreNotCheckedWhileTheLengthIsAGuess) {
    std::string low = setup_of(without("tool"));
    const std::string offset = "Z = -420";
    low.replace(low.find(offset), offset.size(), "Z = -500");
    EXPECT_THAT(run(slot, low).out, Not(HasSubstr("over-travel")));
    const std::string machine = test_support::program({"G0 X-20. Y50.", "G53 G0 Z-900."});
    EXPECT_THAT(run(machine, low).out, HasSubstr("over-travel"));
}

TEST(Coverage, TheStockIsNotDescribedWhereAnotherOffsetCutsBesideIt) {
    const std::string both = "[offsets]\nG54 = { X = -350, Y = -200, Z = -420 }\n"
                             "G55 = { X = -120, Y = -200, Z = -420 }\n";
    const std::string program =
        test_support::program({"G0 X-20. Y50.", "Z-5.", "G1 X120. F800.", "G0 Z60.", "G55",
                               "G0 X0. Y50.", "Z2.", "G1 Z-3. F200.", "X40. F800.", "G0 Z60."});
    const Json report = json_of(program, setup_of(without("offsets")) + both);
    EXPECT_EQ(report["headline"], "NO ERROR IN THE PROGRAM ITSELF") << report["findings"];
    EXPECT_EQ(report["coverage"]["stock"], "inferred");
}

/// 0 states that no tool is in the spindle at the start, so nothing is too low before T1.
TEST(Coverage, AnEmptySpindleAtTheStartMayBeStated) {
    std::string setup = setup_of(all_tables);
    const std::string start = "start = { X = -350, Y = -200, Z = 0 }";
    const std::string low = "start = { X = -300, Y = -85, Z = -390 }"; // in the clamp with a tool
    setup.replace(setup.find(start), start.size(), low);
    const std::string program = "O1000\nG21 G90 G17 G54\nG0 X-20. Y50.\nG53 G0 Z0.\nT1 M6\n"
                                "S6000 M3\nG0 G43 H1 Z60.\nZ-5.\nG1 X120. F800.\nG0 Z60.\nM30\n";
    EXPECT_THAT(run(program, setup).out, HasSubstr("which tool is in the spindle at the start"));
    setup.replace(setup.find(low), low.size(), low + "\ntool_at_start = 0");
    EXPECT_THAT(run(program, setup).out, Not(HasSubstr("which tool is in the spindle")));
    EXPECT_EQ(run(program, setup).status, 0) << run(program, setup).out;
}

/// Nothing states how Z was set, so a tool that is described may not be in the way more than one
/// that is not.
TEST(Coverage, AToolIsTouchedOffIfNeitherOffsetsNorLengthsAreStated) {
    const std::string by_hand = "G21 G90 G54\nT1 M6\nM3 S3000\nG0 X30 Y20\nG0 Z50\nG0 Z2\n"
                                "G1 Z-3 F200\nG1 X70 F600\nG0 Z50\nM5\nM30\n";
    const std::string tool =
        "[[tool]]\nnumber = 1\nshape = \"flat\"\ndiameter = 10\nflute_length = 25\n";
    for (const std::string dialect : {"grbl", "fanuc"}) {
        const auto ran = run(by_hand, "[program]\ndialect = \"" + dialect + "\"\n" + tool);
        EXPECT_EQ(ran.status, 0) << ran.out;
        EXPECT_THAT(ran.out, HasSubstr("Z is touched off with each tool"));
    }
}

TEST(Coverage, OffsetsIncludeThoseOfRapids) {
    for (const std::string offset : {"G55", "G54.1 P7"}) {
        const std::string program =
            test_support::program({"G0 X-20. Y50.", "Z-5.", "G1 X120. F800.", "G0 Z60.",
                                   offset + " G0 X0. Y0.", "G0 Z60."});
        const Json report = json_of(program, setup_of(all_tables));
        EXPECT_EQ(report["coverage"]["offsets"], "inferred") << offset;
    }
    const std::string machine = test_support::program({"G0 X-20. Y50.", "G53 G0 Z0."});
    EXPECT_EQ(json_of(machine, setup_of(all_tables))["coverage"]["offsets"], "described");
}

TEST(Coverage, AWrittenSetupIsAssumedUntilSomebodyStatesIt) {
    const test_support::ScopedFolder folder;
    const std::string program = folder.write("p.nc", slot), setup = folder / "s.toml";
    ASSERT_EQ(feeler({"setup", program, "-o", setup}).status, 0);
    const Json bare = Json::parse(feeler({"check", program, "--format", "json"}).out);
    const Json report =
        Json::parse(feeler({"check", program, "--setup", setup, "--format", "json"}).out);
    EXPECT_EQ(report["coverage"], bare["coverage"]);
    EXPECT_EQ(report["headline"], bare["headline"]);
}

TEST(Coverage, IsCompleteWithoutFixturesIfTheSetupSaysSo) {
    const std::string none = "fixtures = \"none\"\n" + setup_of(without("fixture"));
    EXPECT_EQ(json_of(slot, none)["headline"], "CLEAR");
    const auto both = run(slot, "fixtures = \"none\"\n" + setup_of(all_tables));
    EXPECT_EQ(both.status, 2);
    EXPECT_THAT(both.err, HasSubstr("contradicts the [[fixture]] tables"));
}

TEST(Coverage, WithoutASetupStandsFirstInTheSummary) {
    const std::string text = run(slot, "").out;
    EXPECT_THAT(text, HasSubstr("p.nc: NO ERROR IN THE PROGRAM ITSELF\n"
                                "  unchecked  holder of T1, fixtures, axis limits: not described; "
                                "stock, size of\n             T1, work offsets"));
    EXPECT_THAT(text, Not(HasSubstr("CLEAR")));
}

TEST(Coverage, IsInEveryFormat) {
    const std::map<std::string, std::string> expected = {
        {"html", "<b>Not checked:</b> holder of T1"},
        {"json", "\"headline\": \"NO ERROR IN THE PROGRAM ITSELF\""},
        {"jsonl", "\"fixtures\":\"missing\""},
        {"sarif", "NO ERROR IN THE PROGRAM ITSELF. Not checked: holder of T1"},
        {"junit", "NO ERROR IN THE PROGRAM ITSELF\n    unchecked: holder of T1"}};
    for (const auto& [format, words] : expected)
        EXPECT_THAT(run(slot, "", {"--format", format}).out, HasSubstr(words)) << format;
}

TEST(Coverage, OfManyProgramsIsInTheSummaryAndInTheirResults) {
    const test_support::ScopedFolder folder;
    folder.write("a.nc", slot);
    folder.write("b.nc", slot);
    folder.write("b.toml", setup_of(all_tables));
    const auto batch = [&](const std::string& format) {
        return feeler({"check", folder.path().string(), "--no-cache", "--format", format}).out;
    };
    EXPECT_THAT(batch("text"), HasSubstr("1 clear, 1 no error\n  unchecked: holders in 1, fixtures "
                                         "in 1, axis limits in 1: not described"));
    const Json programs = Json::parse(batch("json"))["programs"];
    EXPECT_EQ(programs[0]["headline"], "NO ERROR IN THE PROGRAM ITSELF");
    EXPECT_EQ(programs[0]["coverage"]["holders"], "missing");
    EXPECT_EQ(programs[1]["headline"], "CLEAR");
    EXPECT_THAT(batch("csv"), HasSubstr("NO ERROR IN THE PROGRAM ITSELF,\"holder of T1, fixtures"));
}

TEST(Coverage, MayBeRequired) {
    const auto lacking = run(slot, "", {"--require", "coverage"});
    EXPECT_EQ(lacking.status, 1);
    EXPECT_THAT(lacking.out, HasSubstr("error    incomplete-setup"));
    EXPECT_THAT(lacking.out, HasSubstr("p.nc: REQUIRED COVERAGE IS MISSING; no error in the "));
    EXPECT_THAT(lacking.out, HasSubstr("findings   1 error"));
    EXPECT_EQ(run(slot, setup_of(all_tables), {"--require", "coverage"}).status, 0);
    for (const auto& [name, text] : tables)
        EXPECT_EQ(run(slot, setup_of(without(name)), {"--require", "coverage"}).status, 1) << name;
    EXPECT_EQ(run(slot, "", {"--require", "miracles"}).status, 2);
}

TEST(Coverage, ThatIsRequiredAndMissingIsCalledSoInEveryFormat) {
    const std::string headline = "REQUIRED COVERAGE IS MISSING; no error in the program itself";
    for (const char* format : {"text", "html", "json", "jsonl", "sarif", "junit"}) {
        const auto ran = run(slot, "", {"--require", "coverage", "--format", format});
        EXPECT_EQ(ran.status, 1) << format;
        EXPECT_THAT(ran.out, HasSubstr(headline)) << format;
        EXPECT_THAT(ran.out, Not(HasSubstr("NO ERROR IN THE PROGRAM ITSELF"))) << format;
    }
    const auto junit = run(slot, "", {"--require", "coverage", "--format", "junit"});
    EXPECT_THAT(junit.out,
                HasSubstr("message=\"" + headline + ": 1 error\" type=\"incomplete-setup\""));
}

TEST(Coverage, OfLimitsThatNeedAWorkOffsetNamesTheWorkOffset) {
    const auto lacking = run(slot, setup_of(without("offsets")), {"--require", "coverage"});
    const std::string out = lacking.out;
    EXPECT_THAT(out, HasSubstr("because no work offset is"));
    EXPECT_THAT(out, HasSubstr("[offsets]"));
    EXPECT_THAT(out, Not(HasSubstr("axis limits: not described")));
    EXPECT_THAT(run(slot, setup_of(without("machine"))).out,
                HasSubstr("axis limits: not described"));
}

TEST(Coverage, MayBeRequiredOfManyProgramsAndByTheirProject) {
    const test_support::ScopedFolder folder;
    folder.write("a.nc", slot);
    EXPECT_EQ(feeler({"check", folder.path().string(), "--no-cache"}).status, 0);
    EXPECT_EQ(
        feeler({"check", folder.path().string(), "--no-cache", "--require", "coverage"}).status, 1);
    folder.write("feeler.toml", "require = [\"coverage\"]\n[[program]]\nfiles = \"a.nc\"\n");
    const auto by_project = feeler({"check", folder.path().string(), "--no-cache"});
    EXPECT_EQ(by_project.status, 1) << by_project.out << by_project.err;
    EXPECT_THAT(by_project.out, HasSubstr("incomplete-setup"));
    folder.write("feeler.toml", "require = [\"all\"]\n[[program]]\nfiles = \"a.nc\"\n");
    EXPECT_EQ(feeler({"check", folder.path().string(), "--no-cache"}).status, 2);
}

TEST(Coverage, OfAProgramThatMovesNothingIsNotClear) {
    for (const std::string still : {"(only a comment)\n(and another)\nM30\n", "G21 G90\nM30\n"}) {
        const auto bare = run(still, "");
        EXPECT_THAT(bare.out, HasSubstr("NOTHING CHECKED, the program moves nothing")) << still;
        EXPECT_THAT(bare.out, HasSubstr("error    nothing-moves")) << still;
        EXPECT_EQ(bare.status, 1) << still;
        EXPECT_THAT(bare.out, Not(HasSubstr("CLEAR"))) << still;
        EXPECT_THAT(run(still, setup_of(all_tables)).out, HasSubstr("NOTHING CHECKED")) << still;
    }
}

TEST(Coverage, OfAStoppedProgramGivesTheReasonFirst) {
    const std::string text = run("G21 G90\nG0 X0\nG1 X=\nM30\n", "").out;
    const size_t reason = text.find("  stopped    ");
    EXPECT_THAT(text, HasSubstr("STOPPED, not checked to its end\n  stopped    "));
    EXPECT_LT(reason, text.find("assuming"));
    EXPECT_THAT(text, Not(HasSubstr(" 0 errors")));
}

struct Outcome {
    int status = 0;
    std::string verdict;
    std::set<std::string> errors; // rules
};

int badness(const Outcome& outcome) {
    const std::vector<std::string> verdicts = {"clear", "undecided", "violation", "collision"};
    const auto at = std::find(verdicts.begin(), verdicts.end(), outcome.verdict);
    return 10 * outcome.status + static_cast<int>(at - verdicts.begin());
}

Outcome outcome_of(const std::string& program, unsigned chosen) {
    const auto ran = run(program, setup_of(chosen), {"--format", "json"});
    const Json report = Json::parse(ran.out, nullptr, false);
    Outcome outcome{ran.status, "none", {}};
    if (report.is_discarded()) return outcome;
    outcome.verdict = report["verdict"];
    for (const Json& finding : report["findings"])
        if (finding["severity"] == "error") outcome.errors.insert(finding["rule"]);
    return outcome;
}

/// Whether an outcome has an error that one with less information has not: something was found.
bool found_more(const Outcome& more, const Outcome& less) {
    return std::any_of(more.errors.begin(), more.errors.end(), [&](const std::string& rule) {
        return rule != "undecided" && !less.errors.contains(rule);
    });
}

/// Outcomes of a program with every subset of the tables. Adding a table never makes the outcome
/// worse without a finding of its own.
void expect_monotonic(const std::string& program, bool is_right) {
    std::vector<Outcome> outcomes;
    for (unsigned chosen = 0; chosen <= all_tables; ++chosen)
        outcomes.push_back(outcome_of(program, chosen));
    for (unsigned less = 0; less <= all_tables; ++less) {
        EXPECT_NE(outcomes[less].status, 2) << setup_of(less);
        EXPECT_NE(outcomes[less].verdict, "undecided") << setup_of(less) << program;
        if (is_right) {
            EXPECT_EQ(outcomes[less].status, 0) << setup_of(less) << program;
        }
        for (size_t i = 0; i < tables.size(); ++i) {
            const unsigned more = less | 1U << i;
            const bool is_worse = badness(outcomes[more]) > badness(outcomes[less]);
            EXPECT_TRUE(!is_worse || found_more(outcomes[more], outcomes[less]))
                << "added " << tables[i].first << " to:\n"
                << setup_of(less) << program;
        }
    }
}

TEST(Monotonicity, HoldsForARightProgramWithEverySubsetOfASetup) { expect_monotonic(slot, true); }

TEST(Monotonicity, HoldsForAProgramThatGoesHomeAndMovesInMachineCoordinates) {
    expect_monotonic("%\nO1 (T1 END MILL D10)\nG17 G21 G40 G49 G80 G90\nG91 G28 Z0.\nG90\nT1 M6\n"
                     "G54 G0 X-20. Y50. S6000 M3\nG43 H1 Z60.\nZ-5.\nG1 X120. F800.\nG0 Z60.\n"
                     "G53 G0 Z0.\nM5\nM30\n%\n",
                     true);
}

TEST(Monotonicity, HoldsForProgramsWithMistakes) {
    // Into the clamp; and by rapid through the stock.
    expect_monotonic(test_support::program({"G0 X50. Y-20.", "Z-5.", "G1 Y120. F800.", "G0 Z60."}),
                     false);
    expect_monotonic(test_support::program({"G0 X-20. Y50.", "Z-5.", "G0 X120.", "G0 Z60."}),
                     false);
}

TEST(Monotonicity, HoldsWithoutToolsWhereTheSpindleIsStartedByHand) {
    const std::string by_hand = "G17 G21 G90\nG0 Z10\nX-20 Y50\nG1 Z-5 F300\nX120\nG0 Z10\nM2\n";
    EXPECT_EQ(outcome_of(by_hand, 0).status, 0);
    for (const std::string name : {"machine", "offsets", "stock", "fixture", "start"}) {
        unsigned only = all_tables & ~without(name);
        EXPECT_EQ(outcome_of(by_hand, only).status, 0) << name;
    }
}

TEST(FirstMove, IsCheckedFromAnAssumedStartAndReported) {
    const Checked result = [] {
        const test_support::ScopedFolder folder;
        folder.write("p.nc", slot);
        folder.write("s.toml", "[offsets]\nG54 = { X = -350, Y = -200, Z = -420 }\n"
                               "[stock]\nbox = [[0, 0, -30], [100, 100, 0]]\n[[tool]]\n"
                                   + test_support::flat_10);
        return check_files(folder / "p.nc", folder / "s.toml");
    }();
    EXPECT_EQ(result.verdict, "clear");
    EXPECT_EQ(result.finding("first-move").severity, "warning");
    EXPECT_THAT(result.finding("first-move").message,
                HasSubstr("only from the assumed position X0 Y0 Z0"));
}

/// The verdict with a set-up that lacks the start position.
std::string verdict_without_start(const std::string& text) {
    return json_of(text, setup_of(without("start")))["verdict"];
}

TEST(FirstMove, IsNotAssumedToStartSomewhereIfTheWholeProgramRestsOnIt) {
    EXPECT_EQ(verdict_without_start(slot), "clear");
    EXPECT_EQ(verdict_without_start(test_support::program({"G0 X50.", "Z-10.", "Z60."})),
              "undecided")
        << "Y is never positioned";
    EXPECT_EQ(verdict_without_start("G17 G21 G91 G54\nT1 M6\nS6000 M3\nG1 Z-5. F300.\nX50.\nM30\n"),
              "undecided")
        << "every move is incremental";
}

} // namespace
} // namespace app_test
