#include <gtest/gtest.h>

#include "app/check/feed_use.h"
#include "app/check/unit_doubt.h"
#include "core/sim/setup.h"
#include "gcode/language/modal_state.h"
#include "gcode/text/source.h"

namespace app {
namespace {

using gcode::LengthUnit;

gcode::Program program_of(const std::string& text) {
    auto program = gcode::program_from_text(text);
    EXPECT_TRUE(program.has_value());
    return *std::move(program);
}

/// The weight of the clues for inches in the comments, less those for mm.
int for_inches(const std::string& text) {
    int weight = 0;
    for (const UnitClue& clue : unit_clues_of_comments(program_of(text)))
        weight += clue.unit == LengthUnit::inch ? clue.weight : -clue.weight;
    return weight;
}

TEST(UnitClues, AreReadFromStatementsAboutTheUnit) {
    EXPECT_EQ(for_inches("(UNITS: INCH)\nG1 X1."), 2);
    EXPECT_EQ(for_inches("(all dimensions are in inches)\nG1 X1."), 2);
    EXPECT_EQ(for_inches("(mm)\nG1 X1."), -2);
    EXPECT_EQ(for_inches("(Unit in mm)\nG1 X1."), -2);
    EXPECT_EQ(for_inches("; METRIC\nG1 X1."), -2);
    EXPECT_EQ(for_inches("(units: mm)\n(units: inch)\nG1 X1."), 0);
    EXPECT_EQ(for_inches("(move in until it touches)\nG1 X1."), 0);
}

TEST(UnitClues, AreReadFromSizesOfTools) {
    EXPECT_EQ(for_inches("(T4 1/2 FLAT ENDMILL)\nT4 M6"), 1);
    EXPECT_EQ(for_inches("(T4 .5\" FLAT ENDMILL)\nT4 M6"), 1);
    EXPECT_EQ(for_inches("(T4 12MM FLAT ENDMILL)\nT4 M6"), -1);
    EXPECT_EQ(for_inches("(T1 D=0.375 CR=0. - FLAT END MILL)\nT1 M6"), 2);
    EXPECT_EQ(for_inches("(T1 D=.0625 CR=0. - FLAT END MILL)\nT1 M6"), 2);
    EXPECT_EQ(for_inches("(T1 D=0.5 CR=0. - FLAT END MILL)\nT1 M6"), 1);
    EXPECT_EQ(for_inches("(T1 D=10. CR=0. - FLAT END MILL)\nT1 M6"), -2);
    EXPECT_EQ(for_inches("(T1 D=3. CR=0. - FLAT END MILL)\nT1 M6"), 0);
    EXPECT_EQ(for_inches("(T1 D=4. CR=0. - FACE MILL)\nT1 M6"), 0) << "mm, or a 4 inch face mill";
    EXPECT_EQ(for_inches("(T1 1/4 END MILL)\n(T2 6MM DRILL)\nT1 M6"), 0) << "both units";
}

TEST(UnitClues, AreNotReadFromOtherNumbers) {
    EXPECT_EQ(for_inches("( 11/20/2011 19:50:48 )\nG1 X1."), 0);
    EXPECT_EQ(for_inches("(TOTAL MACHINING TIME: 24.79 MIN.)\nG1 X1."), 0);
    EXPECT_EQ(for_inches("(MSG \"TOOL 5\")\nG1 X1."), 0);
    EXPECT_EQ(for_inches("(OP 10)\n(N1 VERSION 0.5)\nG1 X1."), 0);
}

FeedFacts slow_feeds() {
    FeedFacts facts;
    facts.box = {{0.0, 0.0, -0.2}, {5.0, 2.0, 0.1}};
    facts.first = core::BlockIndex{7};
    facts.in_mm = true;
    facts.sideways = 30.0;
    facts.cut_way = 30.0;
    facts.revolutions = 6000.0; // 0.005 mm per revolution
    return facts;
}

TEST(UnitsDoubtful, TakesMoreIfTheProgramStatesItsUnit) {
    const gcode::Program program = program_of("G1 X1.\n");
    const core::Setup setup;
    const auto unsaid = units_doubtful(program, slow_feeds(), setup, {}, false);
    ASSERT_TRUE(unsaid);
    EXPECT_EQ(unsaid->severity, core::Severity::error);
    EXPECT_EQ(unsaid->block, core::BlockIndex{7});
    EXPECT_FALSE(units_doubtful(program, slow_feeds(), setup, {}, true));
    const gcode::Program inch = program_of("(T1 1/2 FLAT ENDMILL)\nG1 X1.\n");
    EXPECT_TRUE(units_doubtful(inch, slow_feeds(), setup, {}, true));
}

TEST(UnitsDoubtful, IsAWarningForASingleClue) {
    FeedFacts facts = slow_feeds();
    facts.sideways = 900.0;
    facts.revolutions = 100.0;
    const core::Setup setup;
    const gcode::Program inch = program_of("(T1 1/2 FLAT ENDMILL)\nG1 X1.\n");
    const auto doubt = units_doubtful(inch, facts, setup, {}, false);
    ASSERT_TRUE(doubt);
    EXPECT_EQ(doubt->severity, core::Severity::warning);
    EXPECT_FALSE(units_doubtful(program_of("G1 X1.\n"), facts, setup, {}, false));
}

TEST(UnitsDoubtful, SaysNothingOfAProgramWithBothUnits) {
    FeedFacts facts = slow_feeds();
    facts.in_inches = true;
    EXPECT_FALSE(
        units_doubtful(program_of("(UNITS: INCH)\nG1 X1.\n"), facts, core::Setup(), {}, false));
}

TEST(UnitsDoubtful, ComparesTheFeedsWithAStatedStock) {
    FeedFacts facts = slow_feeds();
    facts.sideways = facts.revolutions = 0.0;
    const core::Aabb stock{{0.0, 0.0, -10.0}, {130.0, 60.0, 0.0}};
    EXPECT_TRUE(units_doubtful(program_of("G1 X1.\n"), facts, core::Setup(), stock, false));
    facts.in_mm = false;
    facts.in_inches = true;
    EXPECT_FALSE(units_doubtful(program_of("G1 X1.\n"), facts, core::Setup(), stock, true));
}

} // namespace
} // namespace app
