#include <gtest/gtest.h>

#include "app/setup/tools/program_tools.h"
#include "gcode/language/modal_state.h"
#include "gcode/text/source.h"

namespace app {
namespace {

using core::ToolNumber;
using core::ToolShape;
using gcode::LengthUnit;

ProgramTools tools_in(const std::string& text) {
    const auto program = gcode::program_from_text(text);
    EXPECT_TRUE(program.has_value());
    return tools_of_program(*program, unit_of_program(*program, LengthUnit::mm));
}

struct Expected {
    const char* program;
    int number;
    ToolShape shape;
    double diameter;
    double corner = 0.0;
    double angle = 0.0;
};

const std::string code = "\nG1 X1. Y2. F100\n";

/// The D of a tapered mill is the diameter at its tip; above it the mill is wider.
TEST(ToolComment, OfATaperedMillGivesTheDiameterAtTheTip) {
    const ProgramTools found =
        tools_in("(T1 D=3. CR=0. TAPER=5DEG - ZMIN=-5. - TAPERED MILL)\nG21\nT1 M6" + code);
    ASSERT_TRUE(found.tools.contains(ToolNumber{1}));
    const core::ToolDescription tool = complete(found.tools.at(ToolNumber{1})).tool;
    EXPECT_EQ(tool.shape, ToolShape::taper);
    EXPECT_EQ(tool.tip_diameter, 3.0);
    EXPECT_NEAR(tool.diameter, 3.0 + 2.0 * 9.0 * 0.08748866, 1e-6); // over 9 mm of flutes
    EXPECT_EQ(tool.angle_deg, 5.0);
}

TEST(ToolComment, IsReadInTheFormsOfCamSystems) {
    using enum ToolShape;
    const Expected cases[] = {
        {"(T1 D=6. CR=0. - ZMIN=-5. - FLAT END MILL)\nG21\nT1 M6", 1, flat, 6},
        {"(T3  D=0.125 CR=0.0625 - ZMIN=-0.54 - ball end mill)\nG20\nT3 M6", 3, ball, 3.175},
        {"(T2 D=10. CR=1.5 - ZMIN=-5. - BULLNOSE END MILL)\nT2 M6", 2, bull, 10, 1.5},
        {"(T4 D=8.5 CR=0. TAPER=118DEG - ZMIN=-20. - DRILL)\nT4 M6", 4, drill, 8.5, 0, 118},
        {"(T5 D=12. CR=0. TAPER=45DEG - ZMIN=-1. - CHAMFER MILL)\nT5 M6", 5, chamfer, 12, 0, 45},
        {"(T1 D=12,5 CR=0,5 - ZMIN=-5. - BULLNOSE END MILL)\nG21\nT1 M6", 1, bull, 12.5, 0.5},
        {"(T1 D=1/2 IN FLAT END MILL)\nG21\nT1 M6", 1, flat, 12.7},
        {"(T1 D=1 1/2 IN FLAT END MILL)\nG21\nT1 M6", 1, flat, 38.1},
        {"(T1 D=12,3 FLUTE END MILL)\nG21\nT1 M6", 1, flat, 12},
        {"(T1 D=.5 IN CR=0. - FLAT END MILL)\nG21\nT1 M6", 1, flat, 12.7},
        {"(T1 D=12 MM - FLAT END MILL)\nG20\nT1 M6", 1, flat, 12},
        {"; T6 D=50 CR=0.8 - ZMIN=0 - face mill\nT6 M6", 6, bull, 50, 0.8},
        {"( T239 |  1/4 FLAT ENDMILL | H239 )\nG20\nT239 M6", 239, flat, 6.35},
        {"(T1 | 10. BULL ENDMILL 1. RAD | H1 | D1 | WEAR COMP)\nG21\nT1 M6", 1, bull, 10, 1},
        {"(T1 | ROUGHER | H1 | D1 | TOOL DIA. - .5)\nG20\nT1 M6", 1, flat, 12.7},
        {"(1/2 FLAT ENDMILL TOOL - 7 DIA. OFF. - 7 LEN. - 7 DIA. - .5)\nG20\nT7 M6", 7, flat, 12.7},
        {"(Tools used in this file: )\n(1 = End Mill {6 mm})\nT1 M6", 1, flat, 6},
        {"(T5 = End Mill {0.2500 inch} UpDown)\nG21\nT5 M6", 5, flat, 6.35},
        {"(2 = V-Bit {60 deg 0.5\"})\nT2 M6", 2, chamfer, 12.7, 0, 30},
        {"(3 = Ball Nose (1/8 inch))\nT3 M6", 3, ball, 3.175},
        {"(Tool 8 = .250 Vee bit)\nG20\nM3", 8, chamfer, 6.35},
        {"( T2 : 3.0 )\nG21\nT2 M6", 2, flat, 3},
        {"; tool#=1 flute=6 len=20 unit=metric\nT1 M6", 1, flat, 6},
        {"(TOOL/MILL,3.175, 0.00, 0.00, 0.00)\nG21\nT9 M6", 9, flat, 3.175},
        {"(TC: 5mm Endmill)\n(Begin toolchange)\nM6 T3", 3, flat, 5},
        {"(TC: 6 mm Ball End001)\nM6 T2", 2, ball, 6},
        {"N5(DRILL)\nN10(D26)\nT1 M6", 1, drill, 26},
        {"(FREZA D10)\nT1 M6", 1, flat, 10},
        {"(*** TOOL DIAMETER = 0.5 ***)\n(*** TOOL NUMBER = 3 ***)\nG20\nT3 M6", 3, flat, 12.7},
        {"(5       5       -1.5042     0.5     1/2 end mill)\nG20\nT5 M6", 5, flat, 12.7},
        {"; 125 mm cutter as tool 59\nTOOL CALL 59 Z S700", 59, flat, 125},
        {"26 ;C40-32ERP412] 6.5mm JOBBER DRILL FLUTE LEN 73.0 FLUTE EXT 80.0\n27 TOOL DEF 116 L+1 "
         "R+0\n"
         "28 TOOL CALL 116 Z S1500",
         116, drill, 6.5},
        {"3 TOOL DEF 4 L+10 R+5.5\n4 TOOL CALL 4 Z S1000", 4, flat, 11},
        {"T2 M6 (#7 DRILL)", 2, drill, 0.2010 * 25.4},
    };
    for (const Expected& each : cases) {
        const ProgramTools found = tools_in(each.program + code);
        const auto tool = found.tools.find(ToolNumber{each.number});
        ASSERT_NE(tool, found.tools.end()) << each.program;
        const core::ToolDescription& d = tool->second.tool;
        EXPECT_EQ(d.shape, each.shape) << each.program;
        EXPECT_NEAR(d.diameter, each.diameter, 1e-9) << each.program;
        if (each.corner > 0.0) {
            EXPECT_NEAR(d.corner_radius.value_or(0.0), each.corner, 1e-9) << each.program;
        }
        if (each.angle > 0.0) {
            EXPECT_EQ(each.shape == drill ? d.point_deg : d.angle_deg, each.angle) << each.program;
        }
        EXPECT_EQ(found.tools.size(), 1U) << each.program;
    }
}

TEST(ToolComment, IsNotRecognisedInASentence) {
    for (const char* text :
         {"(Cutter does not descend more than 0.94\" below top)", "(mill four holes)",
          "(drill a bolt hole circle for 6 bolts at diameter 3 inches)", "(UGT0212 004)",
          "; #8 tool number", "(T1)", "(TOOL CHANGE)", "(make sure tool 3 is a good one)",
          "(TEST-CUT-DIAM-4-0)", "(Probe dia 6 mm)", "(set feed 120 mm for end mill)"}) {
        const ProgramTools found = tools_in(std::string(text) + "\nT3 M6" + code);
        EXPECT_TRUE(found.tools.empty()) << text;
    }
}

TEST(ToolComment, BelongsToTheToolThatIsCalledNext) {
    const ProgramTools found =
        tools_in("(6 mm ball end mill)\nT1 M6\nG1 X1\n(1/4 end mill)\nT2 M6\nG1 X2\n"
                 "T3 M6\nG1 X3\n");
    ASSERT_EQ(found.tools.size(), 2U);
    EXPECT_EQ(found.tools.at(ToolNumber{1}).tool.diameter, 6.0);
    EXPECT_EQ(found.tools.at(ToolNumber{1}).source, "the comment in line 1");
    EXPECT_EQ(found.tools.at(ToolNumber{2}).tool.diameter, 6.35);
}

TEST(ToolComment, DescribesTheToolOfAProgramThatCallsNone) {
    const ProgramTools found = tools_in("(Cutter is assumed to be a 10mm ball nose)\nG21\nG1 X1\n");
    ASSERT_TRUE(found.in_spindle.has_value());
    EXPECT_EQ(found.in_spindle->tool.shape, ToolShape::ball);
    EXPECT_EQ(found.in_spindle->tool.diameter, 10.0);
    EXPECT_FALSE(tools_in("(10mm ball)\nT1 M6\nG1 X1\n").in_spindle.has_value());
}

TEST(FoundTool, IsCompletedAndListsItsAssumptions) {
    const ProgramTools found = tools_in("(T3 D=6. CR=0. - ZMIN=-1. - BALL END MILL)\nT3 M6" + code);
    const CompleteTool whole = complete(found.tools.at(ToolNumber{3}));
    EXPECT_EQ(whole.assumed,
              "tool 3 is a ball end mill of 6 mm, according to the comment in line 1; flutes 18 "
              "mm, shank 6 "
              "mm, 38 mm from the tip to the end of its shank, no holder are assumed");
    EXPECT_EQ(whole.tool.flute_length, 18.0);
}

TEST(UnitOfProgram, IsTheFirstThatItSays) {
    const auto unit = [](const char* text) {
        return unit_of_program(*gcode::program_from_text(text), LengthUnit::mm);
    };
    EXPECT_EQ(unit("(G21)\nG90 G20\nG21\n"), LengthUnit::inch);
    EXPECT_EQ(unit("N10G00G21G17\n"), LengthUnit::mm);
    EXPECT_EQ(unit("G0 X200\n"), LengthUnit::mm);
    EXPECT_EQ(unit("BEGIN PGM A INCH\n"), LengthUnit::inch);
    EXPECT_EQ(unit("N10 G700\n"), LengthUnit::inch);
}

} // namespace
} // namespace app
