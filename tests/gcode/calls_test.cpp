#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/programs.h"
#include "tests/support/scoped_folder.h"

namespace gcode {
namespace {

using testing::HasSubstr;

std::string rapids_of(const Ran& ran) {
    std::string found;
    for (const BlockCommands& block : ran.run.blocks)
        for (const CanonicalCommand& command : block.commands)
            if (const auto* rapid = std::get_if<StraightTraverse>(&command))
                found += std::to_string(static_cast<int>(*rapid->end[0])) + " ";
    return ran.run.error ? found + "error: " + ran.run.error->message : found;
}

/// The X of each rapid of a program, in order.
std::string rapids(std::string_view text, DialectId dialect = DialectId::fanuc) {
    return rapids_of(run_text("G21\n" + std::string(text), dialect));
}

/// The X of each rapid of a program with subprograms in files.
std::string rapids_with(const test_support::ScopedFolder& folder, std::string_view text,
                        DialectId dialect = DialectId::fanuc) {
    Environment environment = known_environment(dialect);
    environment.search_path = {folder.path().string()};
    return rapids_of(run_text("G21\n" + std::string(text), environment));
}

TEST(Calls, SubprogramsRunAsOftenAsTheirCallSays) {
    const std::string sub = "O100\nG91 G0 X1\nG90\nM99\n";
    EXPECT_EQ(rapids("M98 P100\nG0 X9\nM30\n" + sub), "1 9 ");
    EXPECT_EQ(rapids("M98 P100 L3\nG0 X9\nM30\n" + sub), "1 2 3 9 ");
    EXPECT_EQ(rapids("M98 P0100 L0\nG0 X9\nM30\n" + sub), "9 ");
    EXPECT_EQ(rapids("M98 P30100\nG0 X9\nM30\n" + sub), "1 2 3 9 ");
    EXPECT_THAT(rapids("M98 P30100\nG0 X9\nM30\n" + sub, DialectId::haas),
                HasSubstr("no program O30100"));
    // A program with exactly that number takes precedence over three repetitions of another.
    EXPECT_EQ(rapids("M98 P30100\nG0 X9\nM30\nO30100\nG0 X7\nM99\n" + sub), "7 9 ");
}

TEST(Calls, TheMotionOfTheBlockComesBeforeTheCall) {
    EXPECT_EQ(rapids("G0 X5 M98 P100\nG0 X9\nM30\nO100\nG0 X6 M99\n"), "5 6 9 ");
}

TEST(Calls, OldProgramNumbersBeginWithAColon) {
    EXPECT_EQ(rapids_of(run_text(":1\nG21\nM98 P100\nG0 X9\nM30\n:100\nG0 X6\nM99\n")), "6 9 ");
}

TEST(Calls, SubprogramsShareTheLocalVariables) {
    EXPECT_EQ(rapids("#1=7\nM98 P100\nG0 X#1\nM30\nO100\nG0 X#1\n#1=5\nM99\n"), "7 5 ");
}

TEST(Calls, BeginAtABlockOrBelongToTheSameProgram) {
    const std::string sub = "O100\nG0 X1\nN5 G0 X2\nM99\n";
    EXPECT_EQ(rapids("M98 P100 Q5\nG0 X9\nM30\n" + sub), "2 9 ");
    EXPECT_EQ(rapids("M98 Q7\nG0 X9\nM30\nN7 G0 X3\nM99\n" + sub), "3 9 ");
    EXPECT_EQ(rapids("M97 P7 L2\nG0 X9\nM30\nN7 G0 X3\nM99\n", DialectId::haas), "3 3 9 ");
    EXPECT_THAT(rapids("M98 P100 Q6\nM30\n" + sub), HasSubstr("no block N6 in O100"));
    EXPECT_THAT(rapids("M97 P8\nM30\n", DialectId::haas), HasSubstr("no block N8"));
    EXPECT_THAT(rapids("M97 P8\nM30\n"), HasSubstr("does not have it"));
}

TEST(Calls, ReturnToABlockOfTheCaller) {
    EXPECT_EQ(rapids("M98 P100 L4\nG0 X8\nN20 G0 X9\nM30\nO100\nG0 X1\nM99 P20\nN20 G0 X2\n"),
              "1 9 ");
    EXPECT_THAT(rapids("M98 P100\nM30\nO100\nM99 P20\nN20 G0 X2\n"),
                HasSubstr("no block N20 in the calling program"));
}

TEST(Calls, M99OfTheMainProgramJumpsOrStartsItAgain) {
    EXPECT_EQ(rapids("M99 P10\nG0 X1\nN10 G0 X2\nM30\n"), "2 ");
    EXPECT_THAT(rapids("N10 G0 X2\nG0 X1\nM99 P10\n"), HasSubstr("never ends"));
    EXPECT_THAT(warnings_of("G21 G0 X1\nM99\nG0 X2\n"), HasSubstr("3 passes were checked"));
    EXPECT_EQ(rapids("G0 X1\nM99\nG0 X2\n"), "1 1 1 ");
}

TEST(Calls, AnInputIsOffUnlessTheProgramWaitsForIt) {
    const std::string jump = "M96 P10 Q5\nG0 X1\nN10 G0 X2\nM30\n";
    EXPECT_EQ(rapids(jump, DialectId::haas), "2 ");
    EXPECT_THAT(warnings_of(jump, DialectId::haas), HasSubstr("input 5 is assumed to be off"));
    const std::string wait = "N5 M96 P5 Q8\nG0 X1\nM30\n";
    EXPECT_EQ(rapids(wait, DialectId::haas), "1 ");
    EXPECT_THAT(warnings_of(wait, DialectId::haas), HasSubstr("waits for input 8"));
}

TEST(Calls, FindFilesOfManyNames) {
    for (const std::string name : {"O1234", "O1234.nc", "O1234.NC", "1234", "1234.nc", "O01234",
                                   "O1234.ngc", "o1234.tap", "00001234.txt"}) {
        for (const std::string text :
             {"%\nO1234 (SUB)\nG0 X4\nM99\n%\n", ":1234\nG0 X4\nM99", "G0 X4\nM99\n",
              "\n%\n\nG0 X4\nM99\n%\nG0 X5\n", "O7\nG0 X4\nM99\n"}) {
            const test_support::ScopedFolder folder;
            folder.write(name, text);
            EXPECT_EQ(rapids_with(folder, "M98 P1234\nG0 X9\nM30\n"), "4 9 ") << name << text;
        }
    }
}

TEST(Calls, ExternalOnesAreLookedForInFilesFirst) {
    const test_support::ScopedFolder folder;
    folder.write("O8.nc", "O8\nG0 X4\nM99\n");
    const std::string rest = "G0 X9\nM30\nO8\nG0 X5\nM99\n";
    EXPECT_EQ(rapids_with(folder, "M98 P8\n" + rest), "5 9 ");
    EXPECT_EQ(rapids_with(folder, "M198 P8\n" + rest), "4 9 ");
}

TEST(Calls, FilesCallTheirOwnProgramsAndThoseOfTheMainOne) {
    const test_support::ScopedFolder folder;
    folder.write("O8.nc", "O8\nM98 P9\nM98 P10\nM99\nO9\nG0 X1\nM99\n");
    EXPECT_EQ(rapids_with(folder, "M98 P8\nM30\nO9\nG0 X2\nM99\nO10\nG0 X3\nM99"), "1 3 ");
}

TEST(Calls, NameWhatIsMissingAndWhatThereIs) {
    const test_support::ScopedFolder folder;
    EXPECT_THAT(rapids_with(folder, "N101 M98 P101\nM30\nO100\nM99\nO2000\nM99\n"),
                testing::AllOf(HasSubstr("P101: there is no program O101"),
                               HasSubstr(folder.path().string()), HasSubstr("O100, O2000"),
                               HasSubstr("it has a block N101, which M98 Q101 calls")));
    EXPECT_EQ(error_of("G21\nM98\nM30"),
              "2:1: M98 needs a P word, the number of the program to call");
    EXPECT_THAT(rapids("M98 P1.5\nM30"), HasSubstr("whole number"));
}

TEST(Calls, RecursionHasAnEnd) {
    EXPECT_THAT(rapids("M98 P100\nM30\nO100\nM98 P100\nM99\n"), HasSubstr("deeper than the 15"));
    const Ran ran = run_text("G21\nM98 P100\nM30\nO100\nM98 P100\nM99\n");
    EXPECT_EQ(ran.run.state.frames.size(), 16u);
}

TEST(Calls, ProgramsEndWhereTheNextOneBegins) {
    EXPECT_THAT(rapids("M98 P100\nM30\nO100\nG0 X1\nO200\nG0 X2\nM99\n"),
                HasSubstr("1 error: subprogram O100 ends here without M99"));
    EXPECT_THAT(rapids("M98 P100\nM30\nO100\nG0 X1\n%\n"), HasSubstr("without M99"));
    EXPECT_THAT(rapids("M98 P100\nM30\nO100\nG0 X1\n"), HasSubstr("without M99"));
    EXPECT_EQ(rapids("G0 X1\nO200\nG0 X2\nM30\n"), "1 ");
    EXPECT_THAT(warnings_of("G21\nG0 X1\nO200\nG0 X2\nM30\n"), HasSubstr("no M2 or M30"));
}

TEST(Calls, TheProgramsEndIsOneInASubprogramToo) {
    for (const std::string end : {"M30", "M2", "M30 M98 P100"})
        EXPECT_EQ(rapids("M98 P100\nG0 X9\nM30\nO100\nG0 X1\n" + end + "\nG0 X2\nM99\n"), "1 ");
}

TEST(Calls, BlocksKnowTheLinesThatCalledThem) {
    const Ran ran = run_text("G21\nM98 P1\nM30\nO1\nG65 P2 A5\nM99\nO2\nG0 X#1\nM99\n");
    const auto moving = std::find_if(ran.run.blocks.begin(), ran.run.blocks.end(),
                                     [](const BlockCommands& block) { return block.line == 8; });
    ASSERT_NE(moving, ran.run.blocks.end());
    EXPECT_EQ(moving->calls, (std::vector<uint32_t>{2, 5}));
}

TEST(Calls, AFailedBlockLeavesTheLevelsAsTheyWere) {
    // The call itself succeeds and is then recognised as part of an endless loop.
    const Ran ran = run_text("G21\nN10 M98 P1\nM30\nO1\nM99 P10\n");
    ASSERT_TRUE(ran.run.error);
    EXPECT_THAT(ran.run.error->message, HasSubstr("never ends"));
    EXPECT_EQ(ran.run.state.next.line, 5u);
    EXPECT_EQ(ran.run.state.frames.size(), 2u);
}

// Expected values: rs274 2.9.
TEST(Calls, AreMadeAsLinuxCncMakesThem) {
    const auto linux = [](std::string_view text) { return rapids(text, DialectId::linuxcnc); };
    EXPECT_EQ(linux("G0 X1\nM98 P100 L2\nG0 X9\nM2\nO100\nG91\nG0 X1\nG90\nM99\n"), "1 2 3 9 ");
    EXPECT_EQ(linux("#1=7\nM98 P100\nG0 X#1\nM2\nO100\nG0 X#1\n#1=5\nM99\n"), "7 5 ");
    EXPECT_EQ(linux("M98 P100\nG0 X1\nM2\nO100\nG0 X2\nO200\nG0 X3\nM99\n"), "2 3 1 ");
    EXPECT_EQ(linux("M98 P100 L0\nG0 X1\nM2\nO100\nG0 X2\nM99\n"), "1 ");
    EXPECT_EQ(linux("O100\nG0 X2\nM99\nM98 P100\nG0 X1\nM2\n"), "2 2 ");
    EXPECT_EQ(linux("#1=100\nM98 P#1 L[1+1]\nG0 X1\nM2\nO100\nG0 X2\nM98 P200\nM99\nO200\n"
                    "G0 X3\nM99\n"),
              "2 3 2 3 1 ");
    EXPECT_THAT(linux("M98 P100\nG0 X1\nM2\nO100\nG0 X2\n"), HasSubstr("2 error: "));
    EXPECT_THAT(linux("M98 P100\nG0 X#<a>\nM2\nO100\n#<a>=3\nM99\n"),
                HasSubstr("before it is set"));
}

TEST(Calls, AreRefusedWhereLinuxCncRefusesThem) {
    for (const std::string program :
         {"M98 P101\nM2\nO100\nM99\n", "M98\nM2\n", "G0 X5 M98 P100\nM2\nO100\nM99\n",
          "M98 P100\nM2\nO100\nM99 P5\n", "M98 P100\nM2\nO100\nG0 X2 M99\n",
          "M98 P100\nM2\no100 sub\no100 endsub\n", "o100 call\nM2\no100\nM99\n",
          "o100 call\nM2\no100 sub\nM99\no100 endsub\n", "M98 P100 Q5\nM2\nO100\nN5 M99\n",
          "M98 P100.5\nM2\nO100\nM99\n", "S100 M98 P100\nM2\nO100\nM99\n",
          "M98 P100 L2.5\nM2\nO100\nM99\n"})
        EXPECT_THAT(rapids(program, DialectId::linuxcnc), HasSubstr("error: ")) << program;
}

TEST(Calls, LinuxCncWantsTheNumberInTheFile) {
    const test_support::ScopedFolder folder;
    folder.write("101.ngc", "O101\nG0 X2\nM99\n");
    folder.write("102.ngc", "G0 X3\nM99\n");
    EXPECT_EQ(rapids_with(folder, "M98 P101\nG0 X1\nM2\n", DialectId::linuxcnc), "2 1 ");
    EXPECT_THAT(rapids_with(folder, "M98 P102\nM2\n", DialectId::linuxcnc), HasSubstr("error: "));
}

TEST(Calls, AreRefusedByGrbl) {
    EXPECT_THAT(rapids("M98 P100\nM2", DialectId::grbl), HasSubstr("other controls"));
}

TEST(Call, WhoseNumberTheProgramDoesNotSetNamesTheVariable) {
    Environment environment = known_environment(DialectId::fanuc);
    environment.control.reports_premises = true;
    for (const char* call : {"M98 P#500", "G65 P#500", "M98 P#500 L2", "M99 P#500"}) {
        const Ran ran = run_text("G21 G90 G0 X1.\n" + std::string(call) + "\nM30\n", environment);
        ASSERT_TRUE(ran.run.error) << call;
        EXPECT_THAT(ran.run.error->message,
                    testing::HasSubstr(": the number depends on #500, which the program does not "
                                       "set; state its value under [program.values]"))
            << call;
    }
    EXPECT_THAT(error_of("G21\n#500=7\nM98 P#500\nM30\n"), testing::HasSubstr("no program O7 in"));
}

} // namespace
} // namespace gcode
