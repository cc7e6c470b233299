#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/programs.h"
#include "tests/support/same_state.h"

namespace gcode {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// A mill with two tools in its table; G54 is set up, G55 is not.
Environment shop(DialectId dialect) {
    Environment environment = known_environment(dialect);
    environment.work_offsets[0] = {-300.0, -200.0, -150.0};
    environment.tool_lengths = {{core::ToolNumber(1), 80.0}, {core::ToolNumber(2), 95.0}};
    environment.tool_diameters = {{core::ToolNumber(1), 10.0}, {core::ToolNumber(2), 6.0}};
    return environment;
}

/// "rule@line" of each finding.
std::vector<std::string> rules_of(std::string_view text, DialectId dialect = DialectId::fanuc) {
    const Ran ran = run_text(text, shop(dialect));
    EXPECT_FALSE(ran.run.error) << ran.run.error->message;
    std::vector<std::string> rules;
    for (const BlockCommands& block : ran.run.blocks)
        for (const Warning& warning : block.warnings)
            if (warning.rule != "program")
                rules.push_back(std::string(warning.rule) + "@"
                                + std::to_string(warning.where.line));
    return rules;
}

constexpr std::string_view head = "G21 G90 G54 G0\n";

std::string program(std::string_view body) {
    return std::string(head) + std::string(body) + "M30\n";
}

TEST(Rules, RequireALengthOffsetBeforeTheFirstMotionInZ) {
    EXPECT_THAT(rules_of(program("T1 M6\nG0 X0 Y0\nG0 Z5.\nG0 Z2.\n")),
                ElementsAre("missing-length-offset@4"));
    EXPECT_THAT(rules_of(program("T1 M6\nG0 X0 Y0\nG43 H1 Z5.\nG0 Z2.\n")), IsEmpty());
}

TEST(Rules, RequireAnHWithG43) {
    EXPECT_THAT(rules_of(program("T1 M6\nG0 X0 Y0\nG43 Z5.\nG0 Z2.\n")),
                ElementsAre("missing-length-offset@4"));
    EXPECT_THAT(rules_of(program("T1 M6\nG43\nG0 X0 Y0\nG0 Z5.\n")),
                ElementsAre("missing-length-offset@5"));
    EXPECT_THAT(rules_of(program("T1 M6\nG43 H1 Z5.\nG43 Z2.\n")), IsEmpty());
    EXPECT_THAT(rules_of(program("T1 M6\nG43 Z5.\n"), DialectId::linuxcnc), IsEmpty());
}

TEST(Rules, RequireTheLengthOffsetOfTheNewTool) {
    EXPECT_THAT(rules_of(program("T1 M6\nG43 H1 Z5.\nT2 M6\nG0 Z2.\n")),
                ElementsAre("missing-length-offset@5"));
    EXPECT_THAT(rules_of(program("T1 M6\nG43 H1 Z5.\nT2 M6\nG43 H2 Z2.\n")), IsEmpty());
    EXPECT_THAT(rules_of(program("T1 M6\nG43 H1 Z5.\nT1 M6\nG0 Z2.\n")), IsEmpty());
}

TEST(Rules, LetARetreatInMachineCoordinatesGoWithoutALengthOffset) {
    EXPECT_THAT(rules_of(program("T1 M6\nG53 G0 Z0\nG91 G28 Z0\nG90\nG43 H1 Z5.\n")), IsEmpty());
}

TEST(Rules, RequireNoLengthOffsetWhereToolChangesActivateIt) {
    EXPECT_THAT(rules_of("G21 G90 G54\nT1 M6\nG0 Z5.\nM30\n", DialectId::grbl), IsEmpty());
}

TEST(Rules, RequireTheOffsetNumberOfTheToolInTheSpindle) {
    EXPECT_THAT(rules_of(program("T1 M6\nG43 H2 Z5.\n")), ElementsAre("offset-not-tool@3"));
    EXPECT_THAT(rules_of(program("T1 M6\nG43 H1 Z5.\nG41 D2 X1. F100\nX9.\nG40 X20.\n")),
                ElementsAre("offset-not-tool@4"));
    EXPECT_THAT(rules_of(program("T1 M6\nG43 H1 Z5.\nG41 D31 G1 X1. F100\nX9.\nG40 X20.\n")),
                IsEmpty());
}

TEST(Rules, SeeAToolGoDownAfterItsLengthWasCancelled) {
    EXPECT_THAT(rules_of(program("T1 M6\nG43 H1 Z5.\nG49\nG0 Z-20.\n")),
                ElementsAre("length-offset-cancelled@5"));
    EXPECT_THAT(rules_of(program("T1 M6\nG43 H1 Z5.\nG49\nG53 G0 Z0\n")), IsEmpty());
}

TEST(Rules, SeeAWorkOffsetThatWasNeverSet) {
    EXPECT_THAT(rules_of(program("G55\nG0 X0 Y0\nG0 X1.\n")), ElementsAre("work-offset-unset@3"));
    EXPECT_THAT(rules_of(program("G10 L2 P2 X-100.\nG55\nG0 X0 Y0\n")), IsEmpty());
    EXPECT_THAT(rules_of(program("G55\nG54\nG0 X0 Y0\n")), IsEmpty());
}

TEST(Rules, SeeTheWayHomeLeadThroughThePart) {
    EXPECT_THAT(rules_of(program("G0 Z50.\nG28 X0 Y0 Z0\n")), ElementsAre("home-through-part@3"));
    EXPECT_THAT(rules_of(program("G0 Z50.\nG91 G28 Z0\nG90\n")), IsEmpty());
    EXPECT_THAT(rules_of(program("G0 Z50.\nG28 Z60.\n")), IsEmpty());
}

TEST(Rules, SeeWhatIsOnAtAMachineMove) {
    EXPECT_THAT(rules_of(program("G0 Z50.\nG68 X0 Y0 R30.\nG53 G0 Z0\nG69\n")),
                ElementsAre("machine-move-with-state@4"));
    EXPECT_THAT(rules_of(program("G0 Z50.\nG68 X0 Y0 R30.\nG69\nG53 G0 Z0\n")), IsEmpty());
}

TEST(Rules, SeeIncrementsThatSurviveAToolChange) {
    EXPECT_THAT(rules_of(program("G91\nT1 M6\nG43 H1\nG0 X5. Y5.\nX1.\nG90\n")),
                ElementsAre("incremental-left-on@5"));
    EXPECT_THAT(rules_of(program("G91 G28 Z0\nT1 M6\nG90\nG43 H1\nG0 X5. Y5.\n")), IsEmpty());
}

TEST(Rules, SeeWhatIsStillOnAtAToolChangeAndAtTheEnd) {
    EXPECT_THAT(rules_of(program("G68 X0 Y0 R30.\nT1 M6\nG69\n")),
                ElementsAre("state-left-over@3"));
    EXPECT_THAT(rules_of(program("G68 X0 Y0 R30.\n")), ElementsAre("state-left-over@3"));
    EXPECT_THAT(rules_of(program("G68 X0 Y0 R30.\nG69\nT1 M6\n")), IsEmpty());
}

TEST(Rules, TakeAWorkOffsetSetByAProbeForNoAxisOffset) {
    const auto after = [](const std::string& set) {
        return rules_of("G21 G90 G54\nG0 X0 Y0 Z5\nG38.2 Z-5 F100\n" + set + "\nM2\n",
                        DialectId::linuxcnc);
    };
    EXPECT_THAT(after("G10 L20 P1 Z0"), Not(Contains(HasSubstr("state-left-over"))));
    EXPECT_THAT(after("G92 Z0"), Contains("state-left-over@5"));
}

TEST(Rules, SeeUnitsChangeBetweenMotions) {
    EXPECT_THAT(rules_of(program("G0 X5.\nG20\nG0 X5.\nG21\n")),
                ElementsAre("units-jump@3", "units-jump@5"));
    EXPECT_THAT(rules_of(program("G21\nG0 X5.\nG21\n")), IsEmpty());
}

TEST(Rules, SayOnceThatBlocksCanBeDeleted) {
    EXPECT_THAT(rules_of(program("/G0 X5.\n/G0 X6.\n")), ElementsAre("block-delete@2"));
}

TEST(Rules, AreSilentAboutAGoodProgram) {
    EXPECT_THAT(rules_of(program("G17 G40 G49 G80\nG91 G28 Z0\nG90\nT1 M6\nG54 G0 X0 Y0 S1000 M3\n"
                                 "G43 H1 Z50. M8\nZ2.\nG1 Z-1. F200\nX50.\nG0 Z50. M9\nM5\n"
                                 "G91 G28 Z0\nT2 M6\nG90 G54 G0 X0 Y0 S2000 M3\nG43 H2 Z50.\n"
                                 "G99 G81 X10. Y10. Z-5. R2. F100\nX20.\nG80\nG0 Z50.\nM5\nG49\n"
                                 "G91 G28 Z0\nG28 X0 Y0\n")),
                IsEmpty());
}

TEST(Rules, HaveNoPartInWhetherStatesAreTheSame) {
    const Ran said = run_text("/G0 X5.\n", shop(DialectId::fanuc));
    const Ran silent = run_text("G0 X5.\n", shop(DialectId::fanuc));
    EXPECT_TRUE(continue_alike(said.run.state, silent.run.state));
    EXPECT_EQ(digest_of(said.run.state), digest_of(silent.run.state));
}

} // namespace
} // namespace gcode
