#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/check/run_state.h"
#include "app/debug/prompt/command_table.h"
#include "app/debug/prompt/prompt.h"
#include "core/sim/setup.h"
#include "tests/support/scoped_folder.h"
#include "tests/support/setup_writer.h"

namespace app_test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

/// Cuts along Y10, passes a clamp too closely in line 9, and calls a subprogram twice.
constexpr const char* program =
    "%\nO1000 (TRY)\nG21 G90 G17 G54\nT1 M6\nM3 S2000\n"
    "N60 G43 H1 Z50.\nG0 X10. Y10.\nG1 Z-2. F800.\nX62.\n"
    "#100=5\nG0 Z50.\nM98 P2000\nM98 P2000\n(THE END)\nG0 Z60.\nM30\n%\n";
constexpr const char* subprogram = "%\nO2000\nG0 X20.\nG0 X25.\nM99\n%\n";

/// A prompt for a program with a clamp whose side is at X 68.
struct Talk {
    test_support::ScopedFolder folder;
    std::unique_ptr<app::DebugSession> session;
    std::unique_ptr<app::Prompt> prompt;

    Talk() {
        folder.write("O2000.nc", subprogram);
        test_support::SetupWriter setup;
        setup.fixture("clamp-1", "box = [[0, 0, 0], [10, 20, 30]]\nframe = \"G54\"\n"
                                 "at = [68, 0, -20]\n");
        auto opened = app::DebugSession::open({.program = folder.write("p.nc", program),
                                               .setup = folder.write("s.toml", setup.text()),
                                               .allowance = {},
                                               .mesh_size = 2.0});
        EXPECT_TRUE(opened) << (opened ? "" : opened.error().message);
        session = *std::move(opened);
        prompt = std::make_unique<app::Prompt>(*session);
    }

    /// The reply to the last of several commands, none of which may fail.
    std::string say(std::initializer_list<const char*> lines) const {
        std::string text;
        for (const char* line : lines) {
            const app::PromptAnswer answer = prompt->answer(line);
            EXPECT_FALSE(answer.failed) << line << ": " << answer.text;
            text = answer.text;
        }
        return text;
    }
    std::string say(const char* line) const { return say({line}); }

    std::string fails(const char* line) const {
        const size_t before = session->at();
        const app::PromptAnswer answer = prompt->answer(line);
        EXPECT_TRUE(answer.failed) << line << ": " << answer.text;
        EXPECT_EQ(session->at(), before) << line;
        return answer.text;
    }
    uint32_t line() const { return session->record().blocks[session->at()].line; }
};

TEST(Prompt, StepsForwardsAndBack) {
    const Talk talk;
    EXPECT_THAT(talk.say("step"), HasSubstr("line 3: G21 G90 G17 G54"));
    EXPECT_THAT(talk.say("step 4"), AllOf(HasSubstr("line 7: G0 X10. Y10."), HasSubstr("rapid")));
    EXPECT_THAT(talk.say(""), HasSubstr("line 11: G0 Z50.")); // 4 more
    EXPECT_THAT(talk.say("back"), HasSubstr("line 10"));
    EXPECT_THAT(talk.say("rs 2"), HasSubstr("line 8"));
    EXPECT_THAT(talk.say("back 100"), StartsWith("the beginning of the program\n"));
    EXPECT_EQ(talk.session->at(), 0u);
}

TEST(Prompt, ShowsTheClosestPairAndFindingsOfABlock) {
    const Talk talk;
    EXPECT_THAT(talk.say("next-finding"),
                AllOf(HasSubstr("line 9: X62."), HasSubstr("feed, T1"),
                      HasSubstr("flutes to clamp-1: 1.000 mm, minimum 2 mm"),
                      HasSubstr("VIOLATION"), HasSubstr("error near-miss"), HasSubstr("Cure: ")));
    EXPECT_THAT(talk.say("print clearance + 1"), HasSubstr("= 2"));
    EXPECT_THAT(talk.say("until line = 11"), HasSubstr("line 11"));
    EXPECT_THAT(talk.say("previous-finding"), HasSubstr("line 9"));
    EXPECT_THAT(talk.say("findings"), HasSubstr("-> block"));
}

TEST(Prompt, StopsAtBreakpointsOfEveryKind) {
    const Talk talk;
    EXPECT_EQ(talk.say("break 11"), "breakpoint 1: line 11\n");
    EXPECT_EQ(talk.say("b N60"), "breakpoint 2: line 6\n");
    EXPECT_EQ(talk.say("tbreak T1"), "temporary breakpoint 3: change to T1\n");
    EXPECT_EQ(talk.say("break near-miss"), "breakpoint 4: finding near-miss\n");
    EXPECT_EQ(talk.say("break if x > 22 and rapid"), "breakpoint 5: if x > 22 and rapid\n");
    EXPECT_EQ(talk.say("break O2000.nc:4 if depth = 1").substr(0, 20), "breakpoint 6: line 4");
    EXPECT_EQ(talk.say("break 14"), "breakpoint 7: line 15\n"); // 14 is a comment
    EXPECT_THAT(talk.say("run"), StartsWith("temporary breakpoint 3\n"));
    EXPECT_EQ(talk.line(), 4u);
    EXPECT_THAT(talk.say("c"), StartsWith("breakpoint 2: line 6\n"));
    EXPECT_THAT(talk.say("c"), StartsWith("breakpoint 4: finding near-miss\n"));
    EXPECT_THAT(talk.say("disable 5"), IsEmpty());
    EXPECT_THAT(talk.say("c"), StartsWith("breakpoint 1: line 11\n"));
    EXPECT_THAT(talk.say("c"), StartsWith("breakpoint 6: "));
    EXPECT_THAT(talk.say("ignore 6 1"), HasSubstr("breakpoint 6: ignore count 1"));
    EXPECT_THAT(talk.say({"enable 5", "c"}), StartsWith("breakpoint 5: if x > 22"));
    EXPECT_THAT(talk.say("info breakpoints"),
                AllOf(HasSubstr("line 11, stopped 1 time"), Not(HasSubstr("change to T1"))));
    EXPECT_THAT(talk.say({"delete", "c"}), HasSubstr("the program has ended"));
    EXPECT_THAT(talk.say("rc"), StartsWith("the beginning"));
}

TEST(Prompt, PassesAndFinishesSubprograms) {
    const Talk talk;
    talk.say("goto line 12");
    const size_t call = talk.session->at();
    EXPECT_THAT(talk.say("next"), HasSubstr("line 13"));
    EXPECT_THAT(talk.say("reverse-next"), HasSubstr("line 12"));
    EXPECT_EQ(talk.session->at(), call);
    EXPECT_THAT(talk.say({"step", "step"}), HasSubstr("of O2000.nc, called from line 12"));
    EXPECT_THAT(talk.say("where"),
                AllOf(StartsWith("#0  line"), HasSubstr("#1  line 12 of the main program")));
    EXPECT_THAT(talk.say("list"), HasSubstr("->     4"));
    EXPECT_THAT(talk.say("finish"), HasSubstr("line 13"));
    EXPECT_THAT(talk.fails("finish"), HasSubstr("main program"));
}

TEST(Prompt, ListsLinesWithTheirClearance) {
    const Talk talk;
    talk.say({"break 11", "goto end", "goto line 9"});
    const std::string list = talk.say("list");
    EXPECT_THAT(list, AllOf(HasSubstr("->     9     1.000 !  X62."), HasSubstr("*      11"),
                            StartsWith("        4"), Not(HasSubstr("O1000"))));
    EXPECT_THAT(talk.say(""), StartsWith("       15"));
    EXPECT_THAT(talk.fails(""), HasSubstr("no more lines"));
    EXPECT_THAT(talk.say("list 1,2"), AllOf(HasSubstr("O1000"), Not(HasSubstr("G21"))));
    EXPECT_THAT(talk.say("l O2000.nc:4"), HasSubstr("G0 X25."));
}

TEST(Prompt, WatchesAndDisplaysValues) {
    const Talk talk;
    EXPECT_EQ(talk.say("watch #100"), "watchpoint 1: #100, now not set\n");
    EXPECT_THAT(talk.say("display z"), HasSubstr("1: z = "));
    EXPECT_THAT(talk.say("continue"),
                AllOf(StartsWith("watchpoint 1: #100: not set -> 5\n"), HasSubstr("1: z = -2 mm")));
    EXPECT_EQ(talk.line(), 11u);
    EXPECT_THAT(talk.say({"undisplay 1", "step"}), Not(HasSubstr("z =")));
    EXPECT_EQ(talk.say("print plane"), "plane = G17 (XY)\n");
    EXPECT_EQ(talk.say("p #100 * 2"), "#100 * 2 = 10\n");
    EXPECT_THAT(talk.say("p"), HasSubstr("machine.z"));
    EXPECT_THAT(talk.say("info parameters"), HasSubstr("#100             5"));
}

TEST(Prompt, ChangesSomethingAndTakesItBack) {
    const Talk talk;
    talk.say("goto line 8");
    EXPECT_THAT(talk.say("set fixture clamp-1 by 5,0,0"),
                StartsWith("from here on, clamp-1 is moved by 5 mm along X\n"));
    EXPECT_THAT(talk.say("step"), AllOf(HasSubstr("6.000 mm"), HasSubstr("clear")));
    EXPECT_THAT(talk.say("set allowance 7"), HasSubstr("6.000 mm, minimum 7 mm"));
    EXPECT_THAT(talk.say("info changes"), AllOf(HasSubstr("clamp-1"), HasSubstr("7 mm")));
    EXPECT_THAT(talk.say({"undo", "undo"}), HasSubstr("line 8"));
    EXPECT_THAT(talk.say("step"), HasSubstr("1.000 mm, minimum 2 mm"));
    EXPECT_THAT(talk.say({"set G54.x = -340", "p x"}), HasSubstr("x = 0 mm"));
    EXPECT_THAT(talk.say({"set H1 to 90", "p H1"}), HasSubstr("90 mm"));
    EXPECT_THAT(talk.say({"set tool 1 length 100", "info tools"}), HasSubstr("100 mm long"));
    EXPECT_THAT(talk.say({"set T1 99", "info tools"}), HasSubstr("99 mm long"));
}

TEST(Prompt, GoesToAnyLocation) {
    const Talk talk;
    talk.say("goto end");
    EXPECT_TRUE(talk.session->is_recorded());
    EXPECT_THAT(talk.say("jump N60"), HasSubstr("line 6"));
    EXPECT_THAT(talk.say("goto block 2"), HasSubstr("block 2, "));
    EXPECT_THAT(talk.say("goto O2000.nc:4"), HasSubstr("line 4 of O2000.nc"));
    EXPECT_THAT(talk.say("start"), HasSubstr("block 0, "));
    EXPECT_THAT(talk.say("next-tool"), HasSubstr("T1 M6"));
    EXPECT_THAT(talk.say("until N60"), HasSubstr("line 6"));
}

TEST(Prompt, ChangesNothingOnAnInvalidCommand) {
    const Talk talk;
    talk.say("step 5");
    const uint64_t before = digest_of(talk.session->state());
    EXPECT_THAT(talk.fails("stpe"), HasSubstr("nearest is 'step'"));
    EXPECT_THAT(talk.fails("xyzzyxyzzy"), Not(HasSubstr("nearest")));
    EXPECT_THAT(talk.fails("re"), HasSubstr("may be reverse-next, reverse-continue"));
    EXPECT_THAT(talk.fails("step x"), HasSubstr("not a count"));
    EXPECT_THAT(talk.fails("break 999"), HasSubstr("its last line is"));
    EXPECT_THAT(talk.fails("break N999"), HasSubstr("no block N999"));
    EXPECT_THAT(talk.fails("break somewhere"), HasSubstr("not a location"));
    EXPECT_THAT(talk.fails("break other.nc:3"), HasSubstr("no file other.nc"));
    EXPECT_THAT(talk.fails("until clearence < 1"), HasSubstr("nearest name is 'clearance'"));
    EXPECT_THAT(talk.fails("goto block 9999"), HasSubstr("ends after"));
    EXPECT_THAT(talk.fails("delete 9"), HasSubstr("no breakpoint"));
    EXPECT_THAT(talk.fails("set clamp-1 1"), HasSubstr("cannot be set"));
    EXPECT_THAT(talk.fails("set fixture clamp-1 by 1,2"), HasSubstr("by X,Y,Z"));
    EXPECT_THAT(talk.fails("set H1 long"), HasSubstr("not a number"));
    EXPECT_THAT(talk.fails("undo"), HasSubstr("no change to undo"));
    EXPECT_THAT(talk.fails("info nothing"), HasSubstr("breakpoints"));
    EXPECT_THAT(talk.fails("print nothing at all"), HasSubstr("nearest name"));
    EXPECT_EQ(digest_of(talk.session->state()), before);
}

TEST(Prompt, AnswersEveryCommandAndTopicThatItNames) {
    for (const app::PromptCommand& command : app::command_table()) {
        const Talk talk;
        talk.say("step 3");
        const app::PromptAnswer plain = talk.prompt->answer(command.name);
        EXPECT_TRUE(plain.text.empty() || plain.text.back() == '\n') << command.name;
        EXPECT_THAT(talk.say((std::string("help ") + std::string(command.name)).c_str()),
                    StartsWith(std::string(command.name)));
    }
    const Talk talk;
    for (const std::string& topic : app::info_topics())
        EXPECT_THAT(talk.say(("info " + topic).c_str()), Not(IsEmpty())) << topic;
    EXPECT_THAT(talk.say("help"), HasSubstr("next-finding"));
}

TEST(Prompt, CompletesCommandsNamesAndTopics) {
    const Talk talk;
    EXPECT_THAT(talk.prompt->completions("ne"), ElementsAre("next", "next-finding", "next-tool"));
    EXPECT_THAT(talk.prompt->completions("info wa"), ElementsAre("watchpoints"));
    EXPECT_THAT(talk.prompt->completions("until clear"), ElementsAre("clear", "clearance"));
    EXPECT_THAT(talk.prompt->completions("b 23 if near"), ElementsAre("near", "near-miss"));
    EXPECT_THAT(talk.prompt->completions("break "), AllOf(Contains("T1"), Contains("finding")));
    EXPECT_THAT(talk.prompt->completions("set fixture "), ElementsAre("clamp-1"));
    EXPECT_THAT(talk.prompt->completions("p machine.x"), ElementsAre("machine.x"));
    talk.say({"break 11", "watch z"});
    EXPECT_THAT(talk.prompt->completions("delete "), ElementsAre("1", "2"));
}

TEST(Prompt, EndsAnInterruptedWalkWhereItIs) {
    const test_support::ScopedFolder folder;
    const std::string loop = "O1\n#1=0\nWHILE[#1LT500]DO1\n#1=#1+1\nEND1\nM30\n";
    auto session = app::DebugSession::open(
        {.program = folder.write("p.nc", loop), .setup = {}, .allowance = {}, .mesh_size = {}});
    ASSERT_TRUE(session) << session.error().message;
    app::Prompt prompt(**session);
    int asked = 0;
    (*session)->is_interrupted = [&] { return ++asked == 100; };
    EXPECT_THAT(prompt.answer("continue").text, StartsWith("interrupted\nblock "));
    const size_t there = (*session)->at();
    EXPECT_GT(there, 10u);
    EXPECT_LT(there, 400u);
    (*session)->is_interrupted = nullptr;
    EXPECT_THAT(prompt.answer("continue").text, HasSubstr("the program has ended"));
}

TEST(Prompt, ReadsScriptsWithoutRepeating) {
    const Talk talk;
    EXPECT_THAT(talk.prompt->answer_script("step").text, HasSubstr("line 3"));
    EXPECT_TRUE(talk.prompt->answer_script("").text.empty());
    EXPECT_TRUE(talk.prompt->answer_script("  # a comment").text.empty());
    EXPECT_TRUE(talk.prompt->answer("quit").ends);
}

} // namespace
} // namespace app_test
