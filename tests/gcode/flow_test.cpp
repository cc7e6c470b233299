#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/programs.h"
#include "tests/support/scoped_folder.h"

namespace gcode {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// The X of each rapid of a program, in order.
std::string rapids(std::string_view text, DialectId dialect = DialectId::linuxcnc) {
    const Ran ran = run_text("G21\n" + std::string(text), dialect);
    std::string found;
    for (const BlockCommands& block : ran.run.blocks)
        for (const CanonicalCommand& command : block.commands)
            if (const auto* rapid = std::get_if<StraightTraverse>(&command))
                found += std::to_string(static_cast<int>(*rapid->end[0])) + " ";
    return ran.run.error ? found + "error: " + ran.run.error->message : found;
}

TEST(Flow, BranchesTakeTheFirstThatHolds) {
    for (const auto& [value, truth] : {std::pair{1, "10 99 "}, {2, "20 99 "}, {3, "30 99 "}})
        EXPECT_EQ(rapids("#1=" + std::to_string(value)
                         + "\no1 if [#1 EQ 1]\nG0 X10\no1 elseif [#1 EQ 2]\nG0 X20\no1 else\n"
                           "G0 X30\no1 endif\nG0 X99\nM2"),
                  truth);
}

TEST(Flow, LoopsOfEveryKindTurn) {
    EXPECT_EQ(rapids("#1=0\no1 while [#1 LT 3]\n#1=[#1+1]\nG0 X#1\no1 endwhile\nM2"), "1 2 3 ");
    EXPECT_EQ(rapids("#1=0\no1 do\n#1=[#1+1]\nG0 X#1\no1 while [#1 LT 3]\nM2"), "1 2 3 ");
    EXPECT_EQ(rapids("#1=0\no1 repeat [3]\n#1=[#1+1]\nG0 X#1\no1 endrepeat\nM2"), "1 2 3 ");
    EXPECT_EQ(rapids("o1 repeat [0]\nG0 X1\no1 endrepeat\nG0 X2\nM2"), "2 ");
}

TEST(Flow, BreakAndContinueBelongToTheirLoop) {
    EXPECT_EQ(rapids("#1=0\no1 while [#1 LT 9]\n#1=[#1+1]\no2 if [#1 EQ 2]\no1 continue\n"
                     "o2 endif\no3 if [#1 EQ 4]\no1 break\no3 endif\nG0 X#1\no1 endwhile\nM2"),
              "1 3 ");
    EXPECT_EQ(rapids("#1=0\no1 do\n#1=[#1+1]\no2 if [#1 EQ 2]\no1 continue\no2 endif\nG0 X#1\n"
                     "o1 while [#1 LT 3]\nM2"),
              "1 3 ");
}

TEST(Flow, SubsHaveArgumentsLocalsAndAValue) {
    EXPECT_EQ(rapids("o<fact> sub\no1 if [#1 EQ 0]\no<fact> return [1]\no1 else\n"
                     "o<fact> call [#1-1]\no<fact> return [#<_value> * #1]\no1 endif\n"
                     "o<fact> endsub\n#1=77\no<fact> call [5]\nG0 X#<_value>\nG0 X#1\nM2"),
              "120 77 ");
    EXPECT_EQ(rapids("o1 sub\n#<a>=5\no1 endsub\no1 call\nG0 X#<a>"),
              "error: #<a> is used before it is set");
    // A calculated number may name a subprogram too.
    EXPECT_EQ(rapids("o7 sub\nG0 X#1\no7 endsub\n#5=3\no[#5+4] call [8]\nM2"), "8 ");
}

TEST(Flow, BlocksKnowTheirFileAndTheLinesThatCalledThem) {
    const test_support::ScopedFolder folder;
    std::ofstream(folder.path() / "deep.ngc") << "o<deep> sub\nG0 X#1\no<deep> endsub\nM2\n";
    Environment environment = known_environment(DialectId::linuxcnc);
    environment.search_path = {folder.path().string()};
    const Ran ran = run_text("o1 sub\no<deep> call [3]\no1 endsub\nG21\no1 call\nM2", environment);
    ASSERT_FALSE(ran.run.error) << ran.run.error->message;
    const auto moving =
        std::find_if(ran.run.blocks.begin(), ran.run.blocks.end(), [](const BlockCommands& block) {
            return block.line == 2 && !block.file.empty();
        });
    ASSERT_NE(moving, ran.run.blocks.end());
    EXPECT_EQ(moving->text, "G0 X#1");
    EXPECT_THAT(std::string(moving->file), HasSubstr("deep.ngc"));
    EXPECT_EQ(moving->calls, (std::vector<uint32_t>{5, 2}));
}

TEST(Flow, FilesOutsideOfTheSearchPathAreNotRead) {
    const test_support::ScopedFolder folder;
    std::filesystem::create_directory(folder.path() / "in");
    std::ofstream(folder.path() / "out.ngc") << "o<out> sub\nG0 X1\no<out> endsub\n";
    std::filesystem::create_symlink(folder.path() / "out.ngc", folder.path() / "in" / "link.ngc");
    Environment environment = known_environment(DialectId::linuxcnc);
    environment.search_path = {(folder.path() / "in").string()};
    for (const std::string name : {"out", "../out", "link", "/etc/passwd"})
        EXPECT_THAT(run_text("o<" + name + "> call\nM2", environment).run.error->message,
                    HasSubstr("no subprogram"))
            << name;
}

TEST(Flow, NamesTheEndThatIsMissing) {
    EXPECT_THAT(rapids("o1 while [0]\nG0 X1\nM2"), HasSubstr("'endwhile' of 1 is missing"));
    EXPECT_THAT(rapids("o1 if [0]\nG0 X1\nM2"), HasSubstr("'endif' of 1 is missing"));
    EXPECT_THAT(rapids("o1 sub\nG0 X1\nM2"), HasSubstr("1 has no endsub"));
    EXPECT_THAT(rapids("o1 call\nM2"), HasSubstr("no subprogram 1"));
}

TEST(Flow, EndlessProgramsAreFound) {
    EXPECT_THAT(rapids("o1 while [1]\no1 endwhile\nM2"), HasSubstr("never ends"));
    EXPECT_THAT(rapids("#5=0\no1 while [1]\n#5=[1-#5]\nG0 X#5\no1 endwhile\nM2"),
                HasSubstr("never ends"));
    EXPECT_THAT(rapids("o1 sub\no1 call\no1 endsub\no1 call\nM2"), HasSubstr("deeper than"));
    Environment environment = known_environment(DialectId::linuxcnc);
    environment.limits.blocks = 1000;
    const Ran ran =
        run_text("#1=0\no1 while [#1 LT 9000]\n#1=[#1+1]\nG91 X1 G0\no1 endwhile\nM2", environment);
    ASSERT_TRUE(ran.run.error);
    EXPECT_THAT(ran.run.error->message, HasSubstr("stopped after 1000 blocks"));
}

// The expectations of the next three tests are those of rs274 2.9.

TEST(Flow, CommentsMayStandBetweenArguments) {
    const std::string sub = "o<a> sub\nG0 X[10*#1+#2]\no<a> endsub\n";
    EXPECT_EQ(rapids(sub + "o<a> call [1] (comment) [2] ; more\nM2"), "12 ");
    EXPECT_EQ(rapids(sub + "o<a> call (c)[1] (comment)(d) [2] (e)\nM2"), "12 ");
    EXPECT_THAT(rapids(sub + "o<a> call [1] (comment [2]\nM2"), HasSubstr("is not closed"));
}

TEST(Flow, NumberedParametersExist) {
    EXPECT_EQ(rapids("#1=5\nG0 X EXISTS[#1] Y-ABS[-3] Z SIN[30]\nX[5+EXISTS[#[1+1]]]\n"
                     "X EXISTS[#0]\nX EXISTS[#<x>]\nX[3*EXISTS[#5220]]\nM2"),
              "1 6 0 0 3 ");
    EXPECT_THAT(rapids("G0 X[EXISTS[5]]\nM2"), HasSubstr("EXISTS needs a parameter"));
    EXPECT_THAT(rapids("G0 X[EXISTS[#1.5]]\nM2"), HasSubstr("not whole"));
}

TEST(Flow, ATextEndsAtItsSecondTapeMark) {
    const auto error = [](std::string_view text) { return error_of(text, DialectId::linuxcnc); };
    EXPECT_THAT(error("%\nG21\no<a> call [1]\nM2\n%\no<a> sub\nG0 X#1\no<a> endsub\n"),
                HasSubstr("3:1: there is no subprogram a"));
    EXPECT_THAT(error("%\nG21\nM98 P2\nM2\n%\nO2\nG0 X4\nM99\n"),
                HasSubstr("there is no program O2"));
    // Without one at the start, a mark ends nothing.
    EXPECT_EQ(error("G21\no<a> call [1]\nM2\n%\no<a> sub\nG0 X#1\no<a> endsub\n"), "");
}

TEST(Flow, AProgramMayPassASubOnlyOnceAndUncalled) {
    EXPECT_EQ(rapids("G0 X1\nO2 sub\nG0 X2\nO2 endsub\nG0 X3\nM2"), "1 3 ");
    EXPECT_EQ(rapids("O2 sub\nG0 X2\nO2 endsub\nO2 call\nO2 call\nM2"), "2 2 ");
    EXPECT_THAT(rapids("o2 call\nG0 X3\nO2 sub\nG0 X4\nO2 endsub\nG0 X5\nM2"),
                AllOf(HasSubstr("4 3 error"), HasSubstr("runs into subprogram 2")));
    EXPECT_THAT(rapids("o1 repeat [2]\nO2 sub\nG0 X1\nO2 endsub\no1 endrepeat\nM2"),
                HasSubstr("runs into subprogram 2"));
    EXPECT_EQ(rapids("o2 call\nM2\nO2 sub\nG0 X4\nO2 endsub\n"), "4 ");
}

TEST(Flow, FanucJumpsAndLoops) {
    EXPECT_EQ(rapids("#1=1\nN10 G0 X#1\n#1=#1+1\nIF [#1 LE 3] GOTO 10\nM30", DialectId::fanuc),
              "1 2 3 ");
    EXPECT_EQ(rapids("#1=1\nWHILE [#1 LE 3] DO 1\nG0 X#1\n#1=#1+1\nEND 1\nM30", DialectId::fanuc),
              "1 2 3 ");
    EXPECT_EQ(rapids("#1=1\nGOTO 20\nG0 X1\nN20 G0 X2\nM30", DialectId::fanuc), "2 ");
    EXPECT_EQ(rapids("#1=1\nIF [#1 EQ 1] THEN #2=7\nIF [#1 EQ 2] THEN #2=8\nG0 X#2\nM30",
                     DialectId::fanuc),
              "7 ");
    EXPECT_THAT(rapids("GOTO 99\nM30", DialectId::fanuc), HasSubstr("no block N99"));
}

TEST(Flow, AFailedBlockLeavesParametersAsTheyWere) {
    const Ran ran = run_text("#5=1 #<a>=2\n#5=9 #<a>=3 #<b>=4 G123", DialectId::linuxcnc);
    ASSERT_TRUE(ran.run.error);
    EXPECT_EQ(ran.run.state.frames[0].locals[5], 1.0);
    EXPECT_EQ(ran.run.state.frames[0].named.at("a"), 2.0);
    EXPECT_EQ(ran.run.state.frames[0].named.count("b"), 0u);
}

} // namespace
} // namespace gcode
