#include <gtest/gtest.h>

#include "tests/app/checked.h"
#include "tests/support/program_writer.h"

namespace app_test {
namespace {

using test_support::program;
using test_support::Ran;
using test_support::ScopedFolder;
using test_support::SetupWriter;

/// Expects exit status 2, no standard output, and these words on standard error.
void expect_misuse(const std::vector<std::string>& words, const std::string& shown_assumptions) {
    const Ran ran = feeler(words);
    EXPECT_EQ(ran.status, 2) << shown_assumptions;
    EXPECT_EQ(ran.out, "") << shown_assumptions;
    EXPECT_NE(ran.err.find(shown_assumptions), std::string::npos)
        << shown_assumptions << " in: " << ran.err;
}

TEST(CommandLine, NeedsASubcommand) {
    expect_misuse({}, "subcommand");
    expect_misuse({"frobnicate"}, "there is no command frobnicate\n");
    expect_misuse({"chek"}, "there is no command chek; did you mean check?");
}

TEST(CommandLine, NeedsAProgram) {
    expect_misuse({"check"}, "program");
    expect_misuse({"trace"}, "program");
    expect_misuse({"distance", "sphere:5"}, "b is required");
}

TEST(CommandLine, RefusesUnknownOptionsAndValues) {
    expect_misuse({"check", "x.nc", "--bogus"}, "--bogus");
    expect_misuse({"bench"}, "tables is required");
    expect_misuse({"bench", "rivals"}, "rivals not in {paper}");
    expect_misuse({"bench", "paper", "--format", "json"}, "json not in {text,csv}");
    expect_misuse({"bench", "paper", "twice"}, "twice");
    expect_misuse({"check", "x.nc", "--format", "xml"}, "--format");
    expect_misuse({"check", "x.nc", "--dialect", "latin"}, "--dialect");
    for (const char* value : {"-1", "inf", "two", ""})
        expect_misuse({"check", "x.nc", "--allowance", value}, "--allowance");
    for (const char* value : {"-1", "0", "inf", "two", ""})
        expect_misuse({"check", "x.nc", "--mesh-size", value}, "--mesh-size");
}

TEST(CommandLine, PrintsHelpAndVersionOnStandardOutput) {
    for (const auto& words : std::vector<std::vector<std::string>>{{"--help"},
                                                                   {"--version"},
                                                                   {"check", "--help"},
                                                                   {"distance", "--help"},
                                                                   {"bench", "--help"}}) {
        const Ran ran = feeler(words);
        EXPECT_EQ(ran.status, 0) << words[0];
        EXPECT_NE(ran.out, "") << words[0];
        EXPECT_EQ(ran.err, "") << words[0];
    }
}

/// In a rapid the flutes pass a clamp at 1.5 mm.
const SetupWriter near_clamp =
    SetupWriter().fixture("clamp-1", "box = [[40, 104, -30], [60, 130, 12]]");
const std::string past_it = program({"G0 X-20. Y97.5", "Z2.5", "X120.", "Z60."});

TEST(CommandLine, AllowanceReplacesTheDefaultAndTheSetups) {
    EXPECT_EQ(check(near_clamp, past_it).status, 1);
    EXPECT_EQ(check(near_clamp, past_it, {"--allowance", "1.4"}).status, 0);
    EXPECT_EQ(check(near_clamp, past_it, {"--allowance", "1.6"}).status, 1);
    SetupWriter wide = near_clamp;
    wide.root("mesh_size = 0.5\nallowance = 5\n");
    const Checked checked = check(wide, past_it, {"--allowance", "1"});
    EXPECT_EQ(checked.status, 0);
    EXPECT_EQ(checked.at_line(8).pair("holder clamp-1").allowance, 1.0);
}

TEST(CommandLine, MeshSizeReplacesTheSetups) {
    const Checked fine = check(near_clamp, past_it, {"--mesh-size", "0.5"});
    const Checked coarse = check(near_clamp, past_it, {"--mesh-size", "2"});
    EXPECT_EQ(fine.errors(), coarse.errors());
    const PairLine pair = coarse.at_line(8).pair("flutes stock");
    EXPECT_LE(pair.lower, 2.5);
    EXPECT_GE(*pair.upper, 2.5);
}

TEST(Report, IsTheSameOnTwoRuns) {
    const ScopedFolder folder;
    const std::string nc = folder.write("p.nc", past_it);
    const std::string toml = folder.write("s.toml", near_clamp.text());
    const auto report = [&] {
        std::string text = feeler({"check", nc, "--setup", toml, "--format", "json"}).out;
        return text.substr(0, text.find("\"seconds\""));
    };
    EXPECT_EQ(report(), report());
}

TEST(Report, GoesToTheFileAsItGoesToStandardOutput) {
    const ScopedFolder folder;
    const std::string nc = folder.write("p.nc", past_it);
    const std::string toml = folder.write("s.toml", near_clamp.text());
    const auto before_times = [](const std::string& text) {
        return text.substr(0, text.find("\"seconds\""));
    };
    const Ran out = feeler({"check", nc, "--setup", toml, "--format", "json"});
    const Ran file = feeler(
        {"check", nc, "--setup", toml, "--format", "json", "--output", folder / "report.json"});
    EXPECT_EQ(file.status, 1);
    EXPECT_EQ(file.out, "");
    EXPECT_EQ(before_times(test_support::bytes_of(folder / "report.json")), before_times(out.out));
    EXPECT_EQ(folder.names().size(), 3u);
}

} // namespace
} // namespace app_test
