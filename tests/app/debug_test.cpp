#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/checked.h"
#include "tests/support/terminal.h"

namespace app_test {
namespace {

using test_support::Ran;
using test_support::ScopedFolder;
using test_support::Terminal;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

constexpr const char* program = "G21 G90 G17 G54\nT1 M6\nM3 S2000\nG43 H1 Z50.\nG0 X10. Y10.\n"
                                "G1 Z-2. F800.\nX50.\nG0 Z50.\nM30\n";

struct Files {
    ScopedFolder folder;
    std::string program_file = folder.write("p.nc", program);
    std::string setup = folder.write("s.toml", test_support::SetupWriter().text());

    Ran debug(std::vector<std::string> more, const std::string& before = "") const {
        std::vector<std::string> words{"debug", program_file, "--setup", setup, "--mesh-size", "2"};
        words.insert(words.end(), more.begin(), more.end());
        return feeler(words, before);
    }
};

TEST(Debug, CarriesScriptsAndCommandsOutInTheirOrder) {
    const Files files;
    const std::string first = files.folder.write("a", "# begin\nbreak 6\n\nrun\n");
    const std::string second = files.folder.write("b", "print z\n");
    const Ran ran = files.debug({"-x", first, "-ex", "step", "-x", second, "-ex", "quit"});
    EXPECT_EQ(ran.status, 0) << ran.err;
    EXPECT_THAT(ran.out, StartsWith("breakpoint 1: line 6\nbreakpoint 1: line 6\nblock 5, line 6"));
    EXPECT_LT(ran.out.find("line 7: X50."), ran.out.find("z = -2 mm"));
    EXPECT_THAT(ran.err, IsEmpty());
}

TEST(Debug, NamesTheLineOfAScriptThatFails) {
    const Files files;
    const std::string script = files.folder.write("a", "step\n\nstpe\nprint z\n");
    const Ran ran = files.debug({"--batch", "-x", script});
    EXPECT_EQ(ran.status, 2);
    EXPECT_THAT(ran.err, AllOf(HasSubstr(script + ":3: "), HasSubstr("nearest is 'step'")));
    EXPECT_THAT(ran.out, Not(HasSubstr("z =")));
    EXPECT_EQ(files.debug({"--batch", "-ex", "goto line 99"}).status, 2);
    EXPECT_EQ(files.debug({"--batch", "-x", files.folder / "none"}).status, 2);
    EXPECT_EQ(files.debug({"--batch"}).status, 0);
    EXPECT_EQ(feeler({"debug", files.folder / "none.nc"}).status, 2);
}

TEST(Debug, ReadsCommandsFromAPipe) {
    const Files files;
    const auto piped = [&](const std::string& commands) {
        return test_support::run({"sh", "-c",
                                  "printf '" + commands + "' | '" FEELER_BINARY "' debug '"
                                      + files.program_file + "' --setup '" + files.setup
                                      + "' --mesh-size 2"});
    };
    const Ran ran = piped("step 3\\nback\\nquit\\nfoo\\n");
    EXPECT_EQ(ran.status, 0) << ran.err;
    EXPECT_THAT(ran.out, AllOf(HasSubstr("line 4: G43"), HasSubstr("line 3: M3")));
    const Ran failed = piped("step\\nfoo\\nstep\\n");
    EXPECT_EQ(failed.status, 2);
    EXPECT_THAT(failed.err, HasSubstr("standard input:2: there is no command"));
}

TEST(Debug, CompletesRepeatsAndKeepsItsHistoryAtATerminal) {
    const Files files;
    {
        Terminal terminal({FEELER_BINARY, "debug", files.program_file, "--setup", files.setup,
                           "--mesh-size", "2"},
                          files.folder.path());
        EXPECT_THAT(terminal.until("(feeler) "), HasSubstr("block 0, line 1"));
        terminal.type("until clearan\t< 1\n"); // completion adds the rest of the name
        EXPECT_THAT(terminal.until("line 8: G0 Z50."), HasSubstr("until clearance < 1"));
        terminal.until("(feeler) ");
        terminal.type("step\n");
        EXPECT_THAT(terminal.until("(feeler) "), HasSubstr("line 9"));
        terminal.type("\n");
        EXPECT_THAT(terminal.until("(feeler) "), HasSubstr("has ended"));
        terminal.type("quit\n");
        EXPECT_EQ(terminal.status(), 0);
    }
    EXPECT_THAT(test_support::bytes_of(files.folder / ".local/state/feeler/debug_history"),
                HasSubstr("clearance"));
}

/// About 40,000 blocks: seconds of work.
constexpr const char* long_loop = "G21 G90 G17 G54\nT1 M6\nM3 S2000\nG43 H1 Z5.\n#1=0\n"
                                  "WHILE[#1LT9000]DO1\n#1=#1+1\nG1 X10. Y10. F900.\n"
                                  "X60. Z[-#1*0.001]\nEND1\nM30\n";

std::vector<std::string> debug_words(const Files& files, const std::string& text) {
    const std::string file = files.folder.write("loop.nc", text);
    return {FEELER_BINARY, "debug", file, "--setup", files.setup, "--mesh-size", "1"};
}

TEST(Debug, IsNotEndedByControlC) {
    const Files files;
    Terminal terminal(debug_words(files, long_loop), files.folder.path());
    terminal.until("(feeler) ");
    terminal.type("steppp\x03"); // discards the line
    terminal.until("(feeler) ");
    terminal.type("step\n");
    EXPECT_THAT(terminal.until("(feeler) "), HasSubstr("line 2"));
    terminal.type("until line = 11\n");
    terminal.until(" blocks, "); // of the progress display: the run has begun
    terminal.type("\x03");
    EXPECT_THAT(terminal.until("(feeler) "), HasSubstr("interrupted"));
    terminal.type("back\n");
    EXPECT_THAT(terminal.until("(feeler) "), HasSubstr("block "));
    terminal.type("quit\n");
    EXPECT_EQ(terminal.status(), 0);
}

TEST(Debug, EndsWithControlDAtOnceOrAfterAWalk) {
    const Files files;
    {
        Terminal terminal(debug_words(files, program), files.folder.path());
        terminal.until("(feeler) ");
        terminal.type("\x04");
        EXPECT_EQ(terminal.status(), 0);
    }
    Terminal terminal(debug_words(files, long_loop), files.folder.path());
    terminal.until("(feeler) ");
    terminal.type("until line = 11\n");
    terminal.until(" blocks, ");
    terminal.type("\x04"); // while the prompt is not reading
    EXPECT_EQ(terminal.status(), 0);
}

} // namespace
} // namespace app_test
