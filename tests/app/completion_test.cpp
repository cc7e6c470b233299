#include <filesystem>
#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/checked.h"
#include "tests/support/terminal.h"

namespace app_test {
namespace {

using testing::HasSubstr;
using testing::Not;

/// The long options in the help of a subcommand.
std::vector<std::string> options_of(const std::string& command) {
    const std::string help = feeler({command, "--help"}).out;
    const std::regex option("\\n  (?:-\\w,)?(--[a-z-]+)");
    std::vector<std::string> names;
    for (std::sregex_iterator at(help.begin(), help.end(), option), end; at != end; ++at)
        names.push_back((*at)[1]);
    EXPECT_GT(names.size(), 2U) << help;
    return names;
}

TEST(Completion, OffersEveryOptionInEveryShell) {
    for (const std::string shell : {"bash", "zsh", "fish"}) {
        const auto ran = feeler({"completion", shell});
        EXPECT_EQ(ran.status, 0) << ran.err;
        for (const std::string command : {"check", "debug", "sheet", "shot"})
            for (const std::string& name : options_of(command))
                EXPECT_THAT(ran.out, HasSubstr(shell == "fish" ? "-l " + name.substr(2) : name))
                    << shell;
        EXPECT_THAT(ran.out, Not(HasSubstr("man-pages"))) << shell;
    }
    EXPECT_EQ(feeler({"completion", "csh"}).status, 2);
}

TEST(Completion, WorksInBash) {
    const test_support::ScopedFolder folder;
    const std::string script = folder.write("feeler.bash", feeler({"completion", "bash"}).out);
    const auto completed = [&](const std::string& words) {
        return test_support::run(
                   {"bash", "-c",
                    "source " + script + "; COMP_WORDS=(" + words
                        + "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _feeler 2>/dev/null; "
                          "printf '%s ' \"${COMPREPLY[@]}\""})
            .out;
    };
    EXPECT_EQ(completed("feeler ch"), "check ");
    EXPECT_EQ(completed("feeler check --tol"), "--tolerances ");
    EXPECT_EQ(completed("feeler check --dialect ha"), "haas ");
    EXPECT_THAT(completed("feeler check --format j"), HasSubstr("junit"));
    EXPECT_EQ(completed("feeler completion f"), "fish ");
    EXPECT_EQ(completed("feeler bench -o p"), " ") << "the name of a file, not the argument";
    EXPECT_EQ(completed("feeler check --dialect = ha"), "haas "); // bash splits --dialect=ha
    EXPECT_THAT(completed("feeler check --format ="), HasSubstr("junit"));
}

TEST(Completion, CompletesNamesOfFilesAtAPromptOfBash) {
    const test_support::ScopedFolder folder;
    const std::string home = folder.path().string();
    folder.write("two words.nc", "");
    folder.write(".inputrc", "set enable-bracketed-paste off\n");
    const std::string script = folder.write("feeler.bash", feeler({"completion", "bash"}).out);
    test_support::Terminal terminal({"/bin/bash", "--norc", "--noprofile"}, home);
    terminal.type("PS1='ready> '; source '" + script + "'; feeler() { printf '<%s>' \"$@\"; }\n");
    terminal.until("\nready> ");
    const auto words = [&](const std::string& keys) {
        terminal.type(keys + "\n");
        terminal.until("<check>");
        return terminal.until("ready> ");
    };
    EXPECT_EQ(words("feeler check ~/tw\t"), "<" + home + "/two words.nc>ready> ");
    EXPECT_EQ(words("feeler check \"" + home + "/tw\t"), "<" + home + "/two words.nc>ready> ");
    EXPECT_EQ(words("feeler check --dialect=ha\t"), "<--dialect=haas>ready> ");
}

TEST(ManualPages, AreThoseOfAllCommandsAndReadable) {
    const test_support::ScopedFolder folder;
    ASSERT_EQ(feeler({"man-pages", folder.path().string()}).status, 0);
    for (const std::string command : {"check", "setup", "view", "merge"}) {
        const std::string page = test_support::bytes_of(folder / ("feeler-" + command + ".1"));
        EXPECT_THAT(page, HasSubstr(".TH feeler-" + command + " 1"));
        for (const std::string& name : options_of(command))
            EXPECT_THAT(page, HasSubstr(std::regex_replace(name, std::regex("-"), "\\-")));
    }
    EXPECT_THAT(test_support::bytes_of(folder / "feeler.1"), HasSubstr("feeler\\-check"));
    const std::string shot = test_support::bytes_of(folder / "feeler-shot.1");
    const std::string heading = ".SH OPTIONS\n";
    EXPECT_NE(shot.find(heading), std::string::npos);
    EXPECT_EQ(shot.find(heading), shot.rfind(heading));
    EXPECT_EQ(feeler({"man-pages", folder / "missing"}).status, 2);
}

} // namespace
} // namespace app_test
