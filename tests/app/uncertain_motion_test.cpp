#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/app/checked.h"

namespace app_test {
namespace {

using test_support::SetupWriter;

/// A cube of 40 with its centre where the axes A and C intersect; G54 is the centre of its top. The
/// tool is 10 mm wide and 95 mm long.
SetupWriter cube() {
    return SetupWriter()
        .machine(SetupWriter::mill()
                 + SetupWriter::axis("A", "side = \"table\"\npoint = [-350, -200, -440]\n")
                 + SetupWriter::axis("C", "side = \"table\"\npoint = [-350, -200, -440]\n"))
        .stock("box = [[-20, -20, -40], [20, 20, 0]]");
}

std::string text(const std::string& blocks) {
    return "G21 G90 G40 G49 G17\nT1 M6\nG54\nS6000 M3\n" + blocks + "\nM2\n";
}

Checked check_siemens(const SetupWriter& setup, const std::string& blocks) {
    return check(setup, "G710 G90 G17 G54\nT1\nM6\nD1 S6000 M3\n" + blocks + "\nM30\n",
                 {"--dialect", "siemens"});
}

TEST(FollowingAxes, ABlockWithTheWorkTurnedIsUndecidedUnderTraori) {
    const Checked checked = check_siemens(
        cube(), "G0 X-40 Y0 Z50\nTRAORI(2)\nZ40\nA30\nX-30\nA0\nX-40\nTRAFOOF\nX-30\nA30\nA0");
    EXPECT_EQ(checked.errors(), "undecided 8");
    EXPECT_EQ(checked.status, 1);
    EXPECT_EQ(checked.verdict, "undecided");
    EXPECT_NE(checked.finding("undecided").message.find("TRAORI in line 6"), std::string::npos);
    for (const int line : {8, 9, 10}) EXPECT_EQ(checked.at_line(line).verdict, "undecided") << line;
    for (const int line : {7, 11, 13, 14, 15})
        EXPECT_EQ(checked.at_line(line).verdict, "clear") << line;
}

TEST(FollowingAxes, APositionIsUnknownAfterAChangeWithTheWorkTurned) {
    const Checked checked = check_siemens(
        cube(), "G0 X-40 Y0 Z50\nA30\nTRAORI(2)\nTRAFOOF\nA0\nX-30\nG91 Y1 Z1\nG90 Y1\nZ50\n"
                "X-40");
    EXPECT_EQ(checked.errors(), "undecided 9");
    for (const int line : {9, 10, 11, 12, 13})
        EXPECT_EQ(checked.at_line(line).verdict, "undecided") << line;
    EXPECT_EQ(checked.at_line(14).verdict, "clear");
}

TEST(FollowingAxes, NothingIsUndecidedWhileTheRotaryAxesAreAtZero) {
    const Checked turned = check_siemens(cube(), "TRAORI(2)\nG0 X-40 Y0 Z50\nC360\nZ40");
    EXPECT_EQ(turned.errors(), "undecided 7"); // C turns once
    EXPECT_EQ(turned.at_line(8).verdict, "clear");
    const Checked still = check_siemens(cube(), "TRAORI(2)\nM77\nG0 X-40 Y0 Z50\nZ40");
    EXPECT_EQ(still.errors(), "");
    EXPECT_EQ(still.verdict, "clear");
    const Checked three_axes =
        check_siemens(SetupWriter().stock("box = [[-20, -20, -40], [20, 20, 0]]"),
                      "TRAORI(2)\nM77\nG0 X-40 Y0 Z50\nZ40");
    EXPECT_EQ(three_axes.errors(), "");
}

TEST(FollowingAxes, AnUnknownMCodeMayDoItTooUnlessTheSetupKnowsIt) {
    const std::string program = text("G0 G43 H1 Z50.\nM477\nX-40. Y0\nA30.\nX-30.\nA0\nX-20.");
    const Checked unknown = check(cube(), program, {"--dialect", "linuxcnc"});
    EXPECT_EQ(unknown.errors(), "undecided 8");
    EXPECT_NE(unknown.finding("undecided").message.find("M477 in line 6"), std::string::npos);
    EXPECT_EQ(unknown.at_line(11).verdict, "clear");
    const Checked known = check(cube().program("machine_codes = [477]\n"
                                               "start = { X = -350, Y = -200, Z = 0 }\n"),
                                program, {"--dialect", "linuxcnc"});
    EXPECT_EQ(known.errors(), "");
}

/// A machine of LinuxCNC with its ini file, whose remap of M428 selects kinematics `m428`: 1
/// follows the tip, 0 does not. The work tilts about X with its top at Z0.
Checked check_with_ini(int m428) {
    const test_support::ScopedFolder folder;
    std::ofstream(folder / "mill.ini")
        << "[RS274NGC]\nHAL_PIN_VARS = 1\nSUBROUTINE_PATH = subs\n"
           "REMAP = M428 modalgroup=10 ngc=428remap\nREMAP = M429 modalgroup=10 ngc=429remap\n"
           "[KINS]\nKINEMATICS = xyzac-trt-kins sparm=identityfirst\n[TRAJ]\nCOORDINATES = XYZAC\n"
           "LINEAR_UNITS = mm\n[HAL]\n"
           "HALCMD = net sel <= motion.analog-out-03 => motion.switchkins-type\n"
           "HALCMD = net tool motion.tooloffset.z xyzac-trt-kins.tool-offset\n"
           "HALCMD = setp xyzac-trt-kins.y-offset 20\nHALCMD = setp xyzac-trt-kins.z-offset 10\n";
    std::filesystem::create_directory(folder.path() / "subs");
    const auto write_sub = [&](int code, int type) {
        std::ofstream(folder.path() / "subs" / (std::to_string(code) + "remap.ngc"))
            << "o<" << code << "remap>sub\n#<kinstype> = " << type
            << "\no1 if [exists [#<_hal[motion.switchkins-type]>]]\no1 else\nM2\no1 endif\n"
               "M68 E3 Q#<kinstype>\nM66 E0 L0\n"
               "o2 if [[#<_task> EQ 1] AND [#<_hal[motion.switchkins-type]> NE #<kinstype>]]\n"
               "M2\no2 endif\no<"
            << code << "remap>endsub\n";
    };
    write_sub(428, m428);
    write_sub(429, 0);
    return check(SetupWriter()
                     .without_machine()
                     .offsets("G54 = { X = 0, Y = 0, Z = 0 }")
                     .program("start = { X = 0, Y = 0, Z = 400 }\n")
                     .stock("box = [[-20, -20, -40], [20, 20, 0]]"),
                 text("M428\nG0 G43 H1 Z200\nX0 Y-15\nZ5\nA-30\nA0\nM429\nZ50"),
                 {"--ini", folder / "mill.ini"});
}

TEST(FollowingAxes, TheIniFileOfLinuxcncSaysWhatM428Does) {
    const Checked followed = check_with_ini(1);
    EXPECT_EQ(followed.errors(), "");
    EXPECT_EQ(followed.verdict, "clear");
    // The tip stays 5 mm above the top while the work tilts by 30 degrees: the edge comes nearer.
    for (const BlockLine& block : followed.blocks) // the subprograms have a line 9, too
        if (block.text == "A-30") {
            EXPECT_NEAR(block.pair("flutes stock").lower, 2.5, 0.1);
        }
    EXPECT_EQ(check_with_ini(0).verdict, "collision");
}

/// LinuxCNC's bridge mill: W moves the tip along the tool only where the set-up says so.
Checked check_bridge_mill(const std::string& stated, const std::string& blocks) {
    const test_support::ScopedFolder folder;
    std::ofstream(folder / "mill.ini")
        << "[KINS]\nKINEMATICS = 5axiskins\n[TRAJ]\nCOORDINATES = XYZBCW\nLINEAR_UNITS = mm\n"
           "[AXIS_W]\nMIN_LIMIT = -100\n[HAL]\n"
           "HALCMD = loadusr -W 5axisgui pivot_len=200\nHALCMD = loadrt sum2 names=pivotsum\n"
           "HALCMD = net a <= 5axisgui.pivot_len\nHALCMD = net a => pivotsum.in0\n"
           "HALCMD = net b <= motion.tooloffset.z\nHALCMD = net b => pivotsum.in1\n"
           "HALCMD = net c <= pivotsum.out\nHALCMD = net c => 5axiskins.pivot-length\n";
    return check(SetupWriter()
                     .without_machine()
                     .offsets("G54 = { X = 0, Y = 0, Z = 0 }")
                     .program("start = { X = 0, Y = 0, Z = 400 }\n" + stated)
                     .stock("box = [[-20, -20, -40], [20, 20, 0]]"),
                 text("G0 G43 H1 Z200\nX0 Y0\nZ5\n" + blocks), {"--ini", folder / "mill.ini"});
}

TEST(FollowingAxes, WMovesTheTipAlongTheToolAsStated) {
    const std::string stated = "[control]\n\"5axiskins W\" = \"no motor\"\n";
    const Checked up = check_bridge_mill(stated, "W3\nW0\nZ200");
    EXPECT_EQ(up.errors(), "");
    for (const BlockLine& block : up.blocks)
        if (block.text == "W3") {
            EXPECT_NEAR(block.pair("flutes stock").lower, 5.0, 0.1);
        }
    EXPECT_EQ(check_bridge_mill(stated, "W-9\nW0\nZ200").verdict, "collision") << "4 mm deep";
    // A quill would keep the tip where it is.
    const Checked open = check_bridge_mill("", "W3\nW0\nZ200");
    EXPECT_EQ(open.status, 2);
    EXPECT_NE(open.err.find("axis W"), std::string::npos) << open.err;
}

/// The axes of a bridge mill whose W is a quill if it moves the spindle towards the tip.
std::string with_quill(const std::string& direction) {
    return "[[machine.axis]]\nname = \"C\"\nside = \"tool\"\ndirection = [0, 0, 1]\npoint = [0, 0, "
           "0]\n"
           "[[machine.axis]]\nname = \"B\"\nside = \"tool\"\ndirection = [0, -1, 0]\npoint = [0, "
           "0, 200]\n"
           "[[machine.axis]]\nname = \"W\"\nside = \"tool\"\nparent = \"B\"\ndirection = "
           + direction + "\n";
}

TEST(FollowingAxes, AQuillKeepsTheTipWhereItIs) {
    const std::string quill = with_quill("[0, 0, -1]");
    const Checked down = check_bridge_mill(quill, "W-9\nW0\nZ200");
    EXPECT_EQ(down.errors(), "") << down.err;
    for (const BlockLine& block : down.blocks)
        if (block.text == "W-9") {
            EXPECT_NEAR(block.pair("flutes stock").lower, 5.0, 0.1);
        }
    EXPECT_EQ(check_bridge_mill(quill, "B10\nB0\nZ200").verdict, "undecided")
        << "an axis that changes its direction";
    // One that does not move the tip as the control takes it to is not believed.
    const Checked other = check_bridge_mill(with_quill("[0, 0, 1]"), "W-9\nW0\nZ200");
    EXPECT_EQ(other.status, 2);
    EXPECT_NE(other.err.find("axis W"), std::string::npos) << other.err;
}

TEST(FollowingAxes, WhatAnUndecidedBlockCutsStaysInTheStock) {
    const Checked checked = check_siemens(
        cube(),
        "G0 X-40 Y0 Z50\nTRAORI(2)\nC1\nZ-3\nG1 X40 F600\nG0 Z50\nC0\nTRAFOOF\nG0 X-40\nZ-3\n"
        "G1 X40 F600");
    EXPECT_EQ(checked.at_line(9).removed, 0.0);
    EXPECT_NEAR(checked.at_line(15).removed, 40.0 * 10.0 * 3.0, 30.0);
}

TEST(FollowingAxes, ATurnTheOtherWayRoundIsUndecided) {
    const Checked checked = check_siemens(cube(), "G0 X-40 Y0 Z50\nC=DC(350)\nC=DC(10)\nC=DC(170)");
    EXPECT_EQ(checked.errors(), "undecided 6");
    EXPECT_EQ(checked.at_line(7).verdict, "undecided");
    EXPECT_EQ(checked.at_line(8).verdict, "clear");
}

TEST(UndescribedAxes, AreFollowedAndBlocksAwayFromZeroAreUndecided) {
    const test_support::ScopedFolder folder;
    const std::string program = folder.write(
        "p.nc", "G21 G90 G54\nT1 M6 (T1 D=10 END MILL)\nS6000 M3\nG43 H1 Z50.\nG0 X-40. Y0\nZ-3.\n"
                "G1 X40. F600.\nG0 Z50.\nA90.\nX-40.\nZ-3.\nG1 X40.\nG0 Z50.\nA360.\nX-40.\nM30\n");
    const Checked checked = check_files(program, "", {"--dialect", "fanuc"});
    EXPECT_EQ(checked.status, 1) << checked.err;
    EXPECT_EQ(checked.errors(), "undecided 9");
    EXPECT_EQ(checked.verdict, "undecided");
    EXPECT_EQ(checked.at_line(7).verdict, "clear");
    EXPECT_EQ(checked.at_line(12).verdict, "undecided");
    EXPECT_EQ(checked.at_line(12).removed, 0.0);
    EXPECT_EQ(checked.at_line(15).verdict, "clear");
    bool assumed = false;
    for (const std::string& each : checked.assumptions)
        assumed = assumed || each.find("axis A turns the table") != std::string::npos;
    EXPECT_TRUE(assumed);
}

/// Two tools of the same diameter; the holder of the short one meets the clamp at Z-5.
SetupWriter two_tools(const std::string& first_name, const std::string& second_name) {
    const std::string shape = "shape = \"flat\"\ndiameter = 10\nflute_length = 20\n";
    return SetupWriter()
        .lengths("")
        .tool("number = 4\nname = \"" + first_name + "\"\n" + shape
              + "shank = [[10, 10, 60]]\nholder = [[40, 40, 50]]\n")
        .also_tool("number = 5\nname = \"" + second_name + "\"\n" + shape
                   + "shank = [[10, 10, 2]]\nholder = [[40, 40, 50]]\n")
        .fixture("clamp", "box = [[40, 116, -30], [60, 130, 20]]\n");
}

const std::string past_the_clamp = "D1 S6000 M3\nG0 X-20 Y106 Z50\nZ-5\nX120\nZ50";

std::string called(const std::string& name) {
    return "G710 G90 G17 G54\nT=\"" + name + "\"\nM6\n" + past_the_clamp + "\nM30\n";
}

Checked check_called(const SetupWriter& setup, const std::string& name) {
    return check(setup, called(name), {"--dialect", "siemens"});
}

TEST(NamedTool, IsThatOfTheSetup) {
    const SetupWriter setup = two_tools("LONG", "SHORT");
    EXPECT_EQ(check_called(setup, "LONG").at_line(7).verdict, "clear");
    EXPECT_EQ(check_called(setup, "SHORT").at_line(7).verdict, "collision");
    EXPECT_EQ(check_called(setup, "short").at_line(7).tool, 5);
    EXPECT_EQ(check_called(setup, "5").at_line(7).tool, 5);
}

TEST(Restart, AtABlockThatCannotRunEndsWithAMessage) {
    // A premise is open in the block, as X10 has no decimal point.
    const Checked checked =
        check(SetupWriter(), "G21 G90 G54\nT1 M6\nG68.2 P2 Q1 X0\nG68.2 P2 Q2 X10\nM30\n",
              {"--start-line", "4"});
    EXPECT_EQ(checked.status, 2);
    EXPECT_NE(checked.err.find("G68.2: P2 begins with Q1"), std::string::npos) << checked.err;
}

TEST(NamedTool, IsUndecidedIfSeveralHaveTheName) {
    const Checked checked = check_called(two_tools("MILL", "MILL"), "MILL");
    EXPECT_EQ(checked.errors(), "undecided 2");
    EXPECT_EQ(checked.at_line(7).tool, 4);
    EXPECT_EQ(checked.at_line(7).verdict, "undecided");
    EXPECT_EQ(checked.verdict, "undecided");
}

TEST(NamedTool, WithAnUnknownNameGetsANumberThatNoToolHas) {
    const Checked checked =
        check_called(two_tools("LONG", "SHORT").also_tool(test_support::flat_10), "OTHER");
    EXPECT_EQ(checked.at_line(7).tool, 2);
    EXPECT_EQ(checked.status, 1);
    EXPECT_NE(checked.of_severity("warning").find("tool-not-in-table"), std::string::npos);
}

TEST(NamedTool, IsCalledByHeidenhainToo) {
    const auto line_of = [](const std::string& name) {
        return check(two_tools("LONG", "SHORT"),
                     "BEGIN PGM T MM\nTOOL CALL \"" + name
                         + "\" Z S6000\nL X-20 Y+106 Z+50 FMAX M3\nL Z-5 FMAX\nL X+120 FMAX\n"
                           "L Z+50 FMAX\nM30\nEND PGM T MM\n",
                     {"--dialect", "heidenhain"})
            .at_line(5);
    };
    EXPECT_EQ(line_of("LONG").tool, 4);
    EXPECT_EQ(line_of("LONG").verdict, "clear");
    EXPECT_EQ(line_of("SHORT").verdict, "collision");
}

TEST(CuttingEdge, OtherThanTheFirstIsUndecided) {
    const std::string blocks = "G0 X-20 Y50 Z50\nZ20\nD2\nZ10\nD1\nZ20";
    const Checked checked = check_siemens(SetupWriter(), blocks);
    EXPECT_EQ(checked.errors(), "undecided 7");
    EXPECT_EQ(checked.at_line(6).verdict, "clear");
    EXPECT_EQ(checked.at_line(8).verdict, "undecided");
    EXPECT_EQ(checked.at_line(10).verdict, "clear");
}

TEST(CuttingEdge, ZeroCancelsTheLength) {
    // The gauge line goes to Z20, so the tip, 95 mm below, goes through the stock.
    const Checked checked = check_siemens(SetupWriter(), "G0 X50 Y50 Z120\nZ100 D0\nZ20");
    EXPECT_EQ(checked.at_line(7).verdict, "collision");
}

/// The cube of above with a tolerance of the axis of A, two pins and a second tool.
SetupWriter cube_with(const std::string& tolerance, const std::string& allowance) {
    const std::string place = "side = \"table\"\npoint = [-350, -200, -440]\n";
    return cube()
        .root("mesh_size = 0.5\nallowance = " + allowance + "\n")
        .machine(SetupWriter::mill() + SetupWriter::axis("A", place + tolerance)
                 + SetupWriter::axis("C", place))
        .fixture("pin", "box = [[-2, -30, -22], [2, -20, -18]]")
        .fixture("other", "box = [[-2, 20, -22], [2, 30, -18]]")
        .also("[[length_offset]]\nnumber = 2\nlength = 95.0")
        .also_tool("number = 2\n"
                   + test_support::flat_10.substr(test_support::flat_10.find("shape")));
}

TEST(AxisTolerances, AreInEveryClearanceWhileTheAxisIsTurned) {
    const std::string blocks = "G0 X0 Y0 Z50\nA90\nT2\nM6\nA0";
    const Checked exact = check_siemens(cube_with("", "1"), blocks);
    const Checked about = check_siemens(cube_with("point_tolerance = 0.1\n", "1"), blocks);
    const auto lower = [](const Checked& checked, int line) {
        return std::min(checked.at_line(line).pair("flutes pin").lower,
                        checked.at_line(line).pair("flutes other").lower);
    };
    EXPECT_EQ(exact.verdict, "clear");
    EXPECT_EQ(about.verdict, "clear");
    EXPECT_EQ(lower(exact, 5), lower(about, 5)) << "A is at 0";
    // Turned by 90 degrees, the work may be off by 0.1 times the square root of 2.
    EXPECT_NEAR(lower(exact, 6) - lower(about, 6), 0.1414, 0.001);
    // At 90 degrees, a pin is 40 mm below the tip. Only the exact machine keeps a little less, also
    // where a tool is changed.
    const std::string between = "39.9";
    EXPECT_EQ(check_siemens(cube_with("", between), blocks).errors(), "");
    const Checked near = check_siemens(cube_with("point_tolerance = 0.1\n", between), blocks);
    EXPECT_EQ(near.status, 1);
    EXPECT_NE(near.at_line(6).verdict, "clear");
    EXPECT_NE(near.errors().find("tool-change-unsafe"), std::string::npos) << near.errors();
}

TEST(AxisTolerances, CountInTheCoprocessor) {
    const std::string program = "G710 G90 G17 G54\nT1\nM6\nD1 S6000 M3\nG0 X0 Y0 Z80\nA90\nZ50\n"
                                "M30\n";
    const auto at_pin = [&](const std::string& tolerance) {
        return check(cube_with(tolerance, "39.9"), program,
                     {"--dialect", "siemens", "--engine", "coprocessor"})
            .at_line(7)
            .verdict;
    };
    EXPECT_EQ(at_pin(""), "clear") << "40 mm above the pin";
    EXPECT_NE(at_pin("point_tolerance = 0.1\n"), "clear");
}

TEST(AxisTolerances, CountForWhatMayTouch) {
    // The shank passes raw stock by less than the tolerance.
    const auto beside = [](const std::string& tolerance, const std::string& blocks) {
        return check(SetupWriter()
                         .machine(SetupWriter::axis("A", "point = [0, 0, 0]\n" + tolerance))
                         .program("dialect = \"fanuc\"\nstart = { X = 0, Y = 0, Z = 400, A = 0 }\n"
                                  "no_decimal_point = \"units\"\n")
                         .offsets("G54 = { X = 0, Y = 0, Z = 0 }")
                         .lengths("[[length_offset]]\nnumber = 1\nlength = 60.0\n")
                         .stock("box = [[-50, -50, -20], [50, 50, 20]]")
                         .tool("number = 1\nshape = \"flat\"\ndiameter = 10\nflute_length = 10\n"
                               "shank_diameter = 16\nstick_out = 60\n"),
                     text("G43 H1 G0 X70 Y28.3 Z200\n" + blocks));
    };
    const std::string feed = "A90\nZ0\nG1 X-70 F500\nG0 Z200";
    const std::string rise = "A90\nX0 Y70\nZ-130\nY28.3\nG0 Z200";
    for (const std::string& blocks : {feed, rise}) {
        EXPECT_EQ(beside("", blocks).verdict, "clear");
        EXPECT_NE(beside("point_tolerance = 0.5\n", blocks).verdict, "clear") << blocks;
    }
    // Raw stock is not displaced with what the tool has cut elsewhere.
    const std::string cut_first = "A90\nG0 X70 Y0\nZ45\nG1 X45 F500\nG0 Z200\nX70 Y28.3\n";
    EXPECT_EQ(beside("", cut_first + feed).verdict, "clear");
    EXPECT_NE(beside("point_tolerance = 0.5\n", cut_first + feed).verdict, "clear");
    // A slot deeper than the flutes: the shank touches what the flutes have cut. That is contact as
    // long as the tolerances are below its depth.
    const auto slot = [](const std::string& tolerance) {
        return check_siemens(cube_with(tolerance, "0.5"),
                             "G0 X-40 Y12 Z50\nA90\nZ-12\nG1 X40 F500\nZ-24\nX-40\nG0 Z50\n");
    };
    EXPECT_EQ(slot("").errors(), "");
    EXPECT_EQ(slot("point_tolerance = 0.001\n").errors(), "");
    EXPECT_EQ(slot("point_tolerance = 0.1\n").verdict, "undecided");
}

} // namespace
} // namespace app_test
