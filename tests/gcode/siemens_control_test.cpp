#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gcode/language/control.h"
#include "gcode/siemens/siemens_state.h"
#include "tests/gcode/siemens_programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;
using testing::Not;

/// X of each rapid (r), feed (f) and arc (a), in program coordinates.
std::string ways(const Ran& ran) {
    std::string found;
    for (const BlockCommands& block : ran.run.blocks)
        for (const CanonicalCommand& command : block.commands) {
            if (const auto* move = std::get_if<StraightTraverse>(&command))
                found += fmt::format("r{:g} ", *move->end[0]);
            if (const auto* move = std::get_if<StraightFeed>(&command))
                found += fmt::format("f{:g} ", *move->end[0]);
            if (const auto* move = std::get_if<ArcFeed>(&command))
                found += fmt::format("a{:g} ", *move->end[0]);
        }
    return ran.run.error ? found + "error: " + ran.run.error->message : found;
}

std::string ways(std::string_view text) { return ways(run_text(text, DialectId::siemens)); }

const BlockCommands& block_of_line(const Ran& ran, uint32_t line) {
    const auto found = std::find_if(ran.run.blocks.begin(), ran.run.blocks.end(),
                                    [&](const BlockCommands& block) { return block.line == line; });
    EXPECT_NE(found, ran.run.blocks.end()) << "line " << line;
    return found == ran.run.blocks.end() ? ran.run.blocks.front() : *found;
}

/// The machine coordinate in X after a program whose subprogram SUB1 consists of these lines.
Ran around_sub(const std::string& call, const std::string& lines) {
    return run_text("%_N_MAIN_MPF\nG90 F100 TRANS X10\nG0 X0 Y0 Z0\n" + call
                        + "\nX1\nM30\n%_N_SUB1_SPF\nPROC SUB1 SAVE\n" + lines,
                    DialectId::siemens);
}

double machine_x(const Ran& ran) {
    EXPECT_FALSE(ran.run.error) << ran.run.error->message;
    const ModalState& modal = ran.run.state.modal;
    return machine_from_program(modal.offsets, modal.position)[0].value_or(-1.0);
}

// SINUMERIK 840D sl, Programming Manual Job Planning, "Subprograms with SAVE mechanism".
TEST(SiemensSave, RestoresFramesAtEachReturn) {
    const double usual = machine_x(around_sub("", ""));
    for (const std::string_view end : {"M17\n", "RET\n", ""}) {
        const Ran ran = around_sub("SUB1", "TRANS X100\nG0 X0\n" + std::string(end));
        EXPECT_EQ(machine_x(ran), usual) << end;
        EXPECT_EQ(ran.run.state.modal.offsets, around_sub("", "").run.state.modal.offsets);
        EXPECT_EQ(siemens_of(ran.run.state).frame.shift.x, 10.0);
    }
    EXPECT_EQ(machine_x(around_sub("SUB1 P3", "ATRANS X100\nROT RPL=90\nM17\n")), usual);
    EXPECT_EQ(machine_x(around_sub("SUB1", "G55 G91 G19 DIAMON\nM17\n")), usual);
}

TEST(SiemensSave, SaysWhatItRestores) {
    const auto sets_offset = [](const BlockCommands& block) {
        return std::any_of(block.commands.begin(), block.commands.end(), [](const auto& command) {
            return std::holds_alternative<SetOffset>(command);
        });
    };
    EXPECT_TRUE(sets_offset(block_of_line(around_sub("SUB1", "TRANS X100\nM17\n"), 9)));
    EXPECT_TRUE(sets_offset(block_of_line(around_sub("SUB1", "TRANS X100\nRET\n"), 9)));
    EXPECT_TRUE(sets_offset(block_of_line(around_sub("SUB1", "TRANS X100\n"), 5)));
}

TEST(SiemensSave, RestoresTheMotionButNotFeedSpindleAndTool) {
    const Ran ran = around_sub("SUB1", "G1 X-20 F77\nS500 M5\nT3 M6\nM17\n");
    EXPECT_EQ(ways(ran), "r0 f-20 r1 ");
    EXPECT_EQ(ran.run.state.modal.feed, 77.0);
    EXPECT_EQ(ran.run.state.modal.speed, 500.0);
    EXPECT_EQ(ran.run.state.modal.tool, core::ToolNumber(3));
}

TEST(SiemensSave, KeepsWhatASubprogramWithoutItChanges) {
    const Ran ran =
        run_text("%_N_MAIN_MPF\nG0 X0\nSUB1\nX1\nM30\n%_N_SUB1_SPF\nTRANS X100\nG1 X2 F9\nM17\n",
                 DialectId::siemens);
    EXPECT_EQ(machine_x(ran), 101.0);
    EXPECT_EQ(ways(ran), "r0 f2 f1 ");
}

std::optional<core::ToolNumber> tool_after(std::string_view text) {
    return run_text(text, DialectId::siemens).run.state.modal.tool;
}

// SINUMERIK 840D sl, Programming Manual Fundamentals, "Tool change".
TEST(SiemensToolChange, TOnlySelectsWhereTheProgramHasM6) {
    EXPECT_EQ(tool_after("T2 D1\nM6\nT1\nG0 X1\n"), core::ToolNumber(2));
    EXPECT_EQ(tool_after("T2 D1\nG0 X1\nT1\nM06\n"), core::ToolNumber(1));
    EXPECT_EQ(tool_after("T2\nG0 X1\nM1=6\nT1\n"), core::ToolNumber(2));
    EXPECT_EQ(tool_after("%_N_A_MPF\nT2\nEXCHANGE\nT1\nM30\n%_N_EXCHANGE_SPF\nM6\nM17\n"),
              core::ToolNumber(2));
}

TEST(SiemensToolChange, TChangesTheToolWhereTheProgramHasNoM6) {
    for (const std::string_view text :
         {"T2 D1\nG0 X1\n", "T1\nT2\nD1\nG0 X1\n", "T2 ; M6 BY HAND\nMSG(\"M6\")\nM60 M66\n",
          "T2\nR6=1 S1=6 M16\n"})
        EXPECT_EQ(tool_after(text), core::ToolNumber(2)) << text;
}

/// The keys of the parameters that a program meets, and their lines.
std::string met(std::string_view text, Environment environment) {
    environment.control.reports_premises = true;
    const Ran ran = run_text(text, environment);
    std::string found;
    for (const OpenPremise& premise : ran.run.state.readings->met)
        if (premise.id.question)
            found += fmt::format("{}:{} ", premise.line,
                                 find_parameter(*premise.id.question, DialectId::siemens)->key);
    return found;
}

std::string met(std::string_view text) { return met(text, known_environment(DialectId::siemens)); }

TEST(SiemensToolChange, IsAPremiseWithoutM6) {
    EXPECT_EQ(met("G17 G71 G90 G54\nT1\nG0 X1\nT2\n"), "2:MD22550 ");
    EXPECT_EQ(met("G17 G71 G90 G54\nT1\nM6\nG0 X1\n"), "");
    Environment environment = known_environment(DialectId::siemens);
    environment.control.answers[ControlQuestion::tool_changes_with_t] = 0.0;
    EXPECT_EQ(met("G17 G71 G90 G54\nT1\nG0 X1\n", environment), "");
    EXPECT_EQ(run_text("T1\nG0 X1\n", environment).run.state.modal.tool, std::nullopt);
    environment.control.answers[ControlQuestion::tool_changes_with_t] = 1.0;
    EXPECT_EQ(run_text("T1\nM6\nT2\n", environment).run.state.modal.tool, core::ToolNumber(2));
}

Environment with_mill() {
    Environment environment = known_environment(DialectId::siemens);
    environment.tool_diameters[core::ToolNumber(1)] = 10.0;
    environment.length_offsets[core::OffsetNumber(1)] = {};
    return environment;
}

/// A contour to the left of which the tool passes the outside corner at X0 Y50, leaving at an
/// angle to +X.
std::string contour(const std::string& codes, double angle_deg = 0.0) {
    const double angle = angle_deg * 3.141592653589793 / 180.0;
    return fmt::format("T1 M6\nG17 G71 G90 G54 D1 F100\nG0 X-20 Y-20\n{}\nG41 G1 X0 Y0\nY50\n"
                       "X{:.9f} Y{:.9f}\nG40 Y80\nM30\n",
                       codes, 60.0 * std::cos(angle), 50.0 + 60.0 * std::sin(angle));
}

/// The ends of the moves from the corner on: "-5,50 arc 0,55".
std::string corner(const std::string& text, const Environment& environment = with_mill()) {
    const Ran ran = run_text(text, environment);
    std::string found;
    for (const uint32_t line : {6u, 7u})
        for (const CanonicalCommand& command : block_of_line(ran, line).commands) {
            if (const auto* move = std::get_if<StraightFeed>(&command))
                found += fmt::format("{:.3f},{:.3f} ", *move->end[0], *move->end[1]);
            if (const auto* move = std::get_if<ArcFeed>(&command))
                found += fmt::format("arc {:.3f},{:.3f} ", *move->end[0], *move->end[1]);
        }
    return found;
}

// SINUMERIK 840D sl, Programming Manual Fundamentals, "Compensation at the outside corners".
TEST(SiemensCorners, AreRoundedWithG450AndMetWithG451) {
    EXPECT_EQ(corner(contour("G450")), "-5.000,50.000 arc 0.000,55.000 60.000,55.000 ");
    EXPECT_EQ(corner(contour("G451")), "-5.000,55.000 60.000,55.000 ");
    // 98 degrees: still met. 110 degrees: an arc.
    EXPECT_THAT(corner(contour("G451", -8.0)), Not(HasSubstr("arc")));
    EXPECT_THAT(corner(contour("G451", -20.0)), HasSubstr("arc"));
    Environment environment = with_mill();
    environment.control.answers[ControlQuestion::corner_limit] = 120.0;
    EXPECT_THAT(corner(contour("G451", -20.0), environment), Not(HasSubstr("arc")));
}

TEST(SiemensCorners, WithoutACodeAreAPremise) {
    EXPECT_EQ(met(contour(""), with_mill()), "5:MD20150[17] ");
    EXPECT_EQ(met(contour("G450"), with_mill()), "");
    EXPECT_EQ(corner(contour("")), corner(contour("G450")));
    Environment environment = with_mill();
    environment.control.answers[ControlQuestion::corners_are_met] = 1.0;
    EXPECT_EQ(corner(contour(""), environment), corner(contour("G451")));
}

TEST(SiemensCorners, OfAnotherShapeAreInDoubt) {
    const auto path = [](const std::string& codes, uint32_t line) {
        return block_of_line(run_text(contour(codes), with_mill()), line).path;
    };
    EXPECT_EQ(path("G450 DISC=50", 7), core::PathCertainty::doubtful);
    EXPECT_EQ(path("G450 DISC=50", 8), core::PathCertainty::known);
    EXPECT_EQ(path("G450 DISC=0", 7), core::PathCertainty::known);
    EXPECT_EQ(path("G451 DISC=50", 7), core::PathCertainty::known);
}

TEST(SiemensCorners, OfArcsWithG451AreInDoubt) {
    const std::string text = "T1 M6\nG17 G71 G90 G54 D1 F100\nG0 X-20 Y-20\nG451\nG41 G1 X0 Y0\n"
                             "Y50\nG2 X40 Y50 I20 J-20\nG40 G1 Y80\nM30\n";
    const Ran ran = run_text(text, with_mill());
    EXPECT_EQ(block_of_line(ran, 7).path, core::PathCertainty::doubtful);
}

// Job Planning, "Repeating program sections (REPEAT, ENDLABEL)".
TEST(SiemensRepeat, EndsAtEndlabel) {
    EXPECT_EQ(ways("G0 X1\nAA: X2\nX3\nENDLABEL:\nX4\nREPEAT AA P=2\nX5\n"),
              "r1 r2 r3 r4 r2 r3 r2 r3 r5 ");
    EXPECT_EQ(ways("G0 X1\nAA: X2\nENDLABEL: X3\nX4\nREPEAT AA\nX5\n"), "r1 r2 r3 r4 r2 r3 r5 ");
    EXPECT_EQ(ways("G0 X1\nAA: X2\nX4\nREPEAT AA P=2\nX5\n"), "r1 r2 r4 r2 r4 r2 r4 r5 ");
    EXPECT_EQ(ways("G0\nAA: X1\nENDLABEL:\nX2\nBB: X3\nREPEAT AA P=2\nX4\nREPEAT BB\nX5\n"),
              "r1 r2 r3 r1 r1 r4 r3 r1 r1 r4 r5 ");
}

TEST(SiemensRepeat, EndsWithAJumpOutOfTheLines) {
    EXPECT_EQ(ways("G0\nAA: R1=R1+1\nX=R1\nIF R1==2 GOTOF OUT\nENDLABEL:\nX9\nREPEAT AA P=5\nX8\n"
                   "OUT: X7\nX6\n"),
              "r1 r9 r2 r7 r6 ");
}

TEST(SiemensFrameOfCycle800, ANewPlaneDeletesProgrammedFrames) {
    const auto shift = [](const std::string& cycle) {
        return run_text("TRANS X10\n" + cycle + "\n", DialectId::siemens)
            .run.state.modal.offsets.local[0];
    };
    EXPECT_EQ(shift("CYCLE800()"), 0.0);
    EXPECT_EQ(shift("CYCLE800(0,\"TC1\",100000,57,0,0,0,0,0,0,0,0,0,-1,100,1)"), 0.0);
    EXPECT_EQ(shift("CYCLE800(0,\"TC1\",100001,57,0,0,0,0,0,0,0,0,0,-1,100,1)"), 10.0);
}

TEST(SiemensMotionCodes, TheOneBeforeG63IsActiveAfterIt) {
    EXPECT_EQ(ways("F100\nG0 X1\nG63 Z-5\nX2\nG1\nG63 Z5\nX3\n"), "r1 f1 r2 f2 f3 ");
}

TEST(SiemensHoles, RefusesHiddenPositionsAndOtherAxes) {
    const std::string ready = "F100 S100 M3\nG0 X0 Y0 Z10\n";
    const auto error = [&](const std::string& line) { return siemens_error(ready + line + "\n"); };
    EXPECT_THAT(error("HOLES1(0,50,0,20,30,3,0,0,\"2\")"), HasSubstr("leaves out positions"));
    EXPECT_THAT(error("HOLES2(0,0,9,0,0,3,0,0,\"2\")"), HasSubstr("leaves out positions"));
    EXPECT_EQ(error("HOLES1(0,50,0,20,30,3,0,0,\"\")"), "");
    EXPECT_THAT(error("CYCLE83(10,0,2,-20,,-5,,0,0,0,1,1,1)"), HasSubstr("parameter 13 (_AXN)"));
    EXPECT_THAT(error("CYCLE84(10,0,2,-20,,0,5,,1,0,100,100,2)"), HasSubstr("(_AXN) is 2"));
    EXPECT_THAT(error("CYCLE840(10,0,2,-20,,0,0,3,0,,1,1)"), HasSubstr("parameter 12 (_AXN)"));
    EXPECT_EQ(error("CYCLE83(10,0,2,-20,,-5,,0,0,0,1,1,3)"), "");
}

TEST(SiemensHoles, OnlyTheTensDigitMeansTheCircle) {
    const auto warnings = [](const std::string& vari) {
        return warnings_of("F100\nG0 X0 Y0 Z9\nMCALL CYCLE81(10,0,2,-5)\nHOLES2(0,0,9,0,0,3," + vari
                               + ")\nMCALL\n",
                           DialectId::siemens);
    };
    EXPECT_THAT(warnings("1010"), HasSubstr("on the circle"));
    EXPECT_THAT(warnings("1000"), Not(HasSubstr("on the circle")));
}

// Fundamentals, "Reference point travel (G74)" and "Fixed-point approach (G75)".
TEST(SiemensFixedPoint, IsReachedByEachAxisOnItsOwn) {
    const Ran ran = run_text("G0 X5 Y5 Z5\nG75 X1=0 Y1=0\nG74 Z1=0\n", DialectId::siemens);
    for (const uint32_t line : {2u, 3u}) {
        const auto* move = std::get_if<StraightTraverse>(&block_of_line(ran, line).commands.at(0));
        ASSERT_TRUE(move);
        EXPECT_EQ(move->style, core::RapidStyle::independent);
    }
}

TEST(SiemensFixedPoint, IsUnknownUnlessStated) {
    const std::string text = "G71 G90 G54\nG0 X5 Y5 Z5\nG75 Z1=0\nX6\nZ9\nX7\n";
    Environment environment = known_environment(DialectId::siemens);
    environment.control.reports_premises = true;
    const auto path = [&](uint32_t line) {
        return block_of_line(run_text(text, environment), line).path;
    };
    EXPECT_EQ(path(3), core::PathCertainty::known);
    environment.fixed_point.reset();
    EXPECT_EQ(path(2), core::PathCertainty::known);
    EXPECT_EQ(path(3), core::PathCertainty::unknown);
    EXPECT_EQ(path(4), core::PathCertainty::unknown);
    EXPECT_EQ(path(6), core::PathCertainty::known);
}

TEST(SiemensTolerance, IsNamedWhereNothingStatesIt) {
    const auto warnings = [](const std::string& line) {
        return warnings_of(line + "\n", DialectId::siemens);
    };
    EXPECT_THAT(warnings("G64 COMPCAD"), HasSubstr("COMPCAD: the program states no tolerance"));
    EXPECT_THAT(warnings("G642"), HasSubstr("G642: the program states no tolerance"));
    EXPECT_THAT(warnings("G642 CTOL=0.01"), Not(HasSubstr("no tolerance")));
    EXPECT_THAT(warnings("G641 ADIS=1"), Not(HasSubstr("no tolerance")));
}

} // namespace
} // namespace gcode
