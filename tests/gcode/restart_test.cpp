#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gcode/exec/restart.h"
#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::string_view text = "O1\n"                        // 1
                                  "G21 G90 G17\n"               // 2
                                  "N10 T3 M6\n"                 // 3
                                  "G55 G0 X10. Y20. S4500 M3\n" // 4
                                  "G43 H3 Z50. M8\n"            // 5
                                  "Z2.\n"                       // 6
                                  "G1 Z-5. F200\n"              // 7
                                  "N20 X60.\n"                  // 8
                                  "G2 X70. Y10. I0 J-10.\n"     // 9
                                  "G0 Z50. M9\n"                // 10
                                  "N30 T4 M6\n"                 // 11
                                  "G54 G0 X0 Y0 S900 M3\n"      // 12
                                  "G43 H4 Z50.\n"               // 13
                                  "G1 Z-1. F100\n"              // 14
                                  "M30\n";                      // 15

core::Result<Restart> restarted(uint32_t line, std::optional<core::ToolNumber> tool = {}) {
    static const Program program = *program_from_text(text);
    static Environment environment = known_environment(DialectId::fanuc);
    environment.tool_lengths = {{core::ToolNumber(3), 90.0}, {core::ToolNumber(4), 80.0}};
    ProgramLibrary library(program, dialect(DialectId::fanuc));
    return restart_at(library, environment, line, tool);
}

TEST(Restart, ListsWhatTheFirstCutNeeds) {
    EXPECT_THAT(restarted(8)->missing, ElementsAre("T3 in the spindle", "G43 H3", "G55", "S4500 M3",
                                                   "M8", "G1", "F200", "the tool at Y20 Z-5"));
}

TEST(Restart, ListsTheMotionCodeThatASkippedBlockUses) {
    EXPECT_THAT(restarted(8)->missing, testing::Contains("G1"));
    // A control that has just been switched on starts with G0.
    EXPECT_THAT(restarted(6)->missing, testing::Not(testing::Contains("G0")));
    EXPECT_THAT(restarted(9)->missing, testing::Not(testing::Contains(testing::StartsWith("G2"))));
    EXPECT_THAT(restarted(7)->missing, testing::Not(testing::Contains("G1")));
}

TEST(Restart, DoesNotListWhatTheBlockItselfSays) {
    EXPECT_THAT(restarted(7)->missing, ElementsAre("T3 in the spindle", "G43 H3", "G55", "S4500 M3",
                                                   "M8", "the tool at X10 Y20"));
}

TEST(Restart, LacksNothingAtAToolChange) {
    EXPECT_THAT(restarted(11)->missing, IsEmpty());
    EXPECT_THAT(restarted(3)->missing, IsEmpty());
    EXPECT_THAT(restarted(1)->missing, IsEmpty());
}

TEST(Restart, KnowsTheToolThatIsInTheSpindle) {
    EXPECT_THAT(restarted(4, core::ToolNumber(3))->missing, IsEmpty());
    EXPECT_THAT(restarted(4)->missing, ElementsAre("T3 in the spindle"));
}

TEST(Restart, BeginsInTheStateAfterSwitchingOn) {
    const Restart restart = *restarted(8);
    EXPECT_EQ(restart.line, 8U);
    EXPECT_EQ(restart.state.next.line, 8U);
    EXPECT_FALSE(restart.state.modal.tool);
    EXPECT_FALSE(restart.state.modal.feed);
}

TEST(Restart, RefusesALineThatTheProgramNeverComesTo) {
    const auto refused = restarted(99);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find("does not reach line 99"), std::string::npos);
}

TEST(LineMeant, IsALineOfTheFileOrTheBlockOfThatNumber) {
    const Program program = *program_from_text(text);
    const DialectId fanuc = DialectId::fanuc;
    EXPECT_EQ(*line_meant(program, fanuc, "9"), 9U);
    EXPECT_EQ(*line_meant(program, fanuc, "N20"), 8U);
    EXPECT_EQ(*line_meant(program, fanuc, "n30"), 11U);
    for (const char* none : {"0", "16", "N25", "N", "", "x", "-3"})
        EXPECT_FALSE(line_meant(program, fanuc, none)) << none;
}

TEST(LineMeant, CountsTheBlocksOfKlartext) {
    const Program program =
        *program_from_text("0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S900\n2 END PGM A MM\n");
    EXPECT_EQ(*line_meant(program, DialectId::heidenhain, "1"), 2U);
}

} // namespace
} // namespace gcode
