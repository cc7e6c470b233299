#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "tests/app/checked.h"
#include "tests/support/program_writer.h"

namespace app_test {
namespace {

using test_support::Ran;
using test_support::ScopedFolder;
using test_support::SetupWriter;

/// A folder with a program, and the output of `feeler trace` for it.
struct Traced {
    ScopedFolder folder{};
    std::string dialect = "linuxcnc";
    Ran ran{};

    void run(const std::string& program, std::vector<std::string> words) {
        words.insert(words.begin(), {"trace", folder.write("p.ngc", program)});
        if (!dialect.empty()) words.insert(words.end(), {"--dialect", dialect});
        ran = feeler(words);
    }
    bool says(const std::string& text) const { return ran.out.find(text) != std::string::npos; }
    bool warns(const std::string& text) const { return ran.err.find(text) != std::string::npos; }
};

TEST(StartPosition, IsInMachineCoordinates) {
    for (const char* place :
         {"X=-100,Y=20.5,Z=-3,A=90", "X-100Y20.5Z-3A90", "x=-100, y=+20.5 z-3 a90"}) {
        Traced traced;
        traced.run("G21 G91 G0 X10 Y1 Z1 A5\nM2\n", {"--start-position", place});
        EXPECT_TRUE(traced.says("straight_traverse x=-90 y=21.5 z=-2 a=95\n"))
            << place << traced.ran.out << traced.ran.err;
    }
}

TEST(StartPosition, LeavesAxesUnknownThatItDoesNotName) {
    Traced traced;
    traced.run("G21 G0 X10\nM2\n", {"--start-position", "Y=3"});
    EXPECT_TRUE(traced.says("straight_traverse x=10 y=3\n")) << traced.ran.out;
}

TEST(Output, NeverReplacesTheProgram) {
    const std::string program = "G21 G0 X1\nM2\n";
    Traced traced;
    const std::string path = traced.folder.write("p.ngc", program);
    traced.run(program, {"-o", path});
    EXPECT_NE(traced.ran.status, 0);
    EXPECT_TRUE(traced.warns("another file")) << traced.ran.err;
    std::ifstream file(path);
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), program);
}

TEST(BlockDelete, LeavesBlocksWithASlashOut) {
    const std::string program = "G21 G0 X1\n/G0 X2\nM2\n";
    for (const bool on : {true, false}) {
        Traced traced;
        traced.run(program, {"--block-delete", on ? "on" : "off"});
        EXPECT_EQ(traced.says("x=2"), !on);
        EXPECT_TRUE(traced.says("x=1"));
    }
}

TEST(VariablesFile, HoldsParametersAndOffsetsInTheMachinesUnit) {
    for (const bool inch : {false, true}) {
        Traced traced;
        const std::string variables =
            traced.folder.write("v.var", "31\t7.5\n5161 1\n5221 -2.0\n5222 3\n5223 0\n");
        traced.run("G21 G0 X#31 Y0 Z0\nG28\nM2\n",
                   {"--parameters", variables, "--machine-unit", inch ? "inch" : "mm"});
        EXPECT_TRUE(traced.says("x=7.5")) << traced.ran.err;
        EXPECT_TRUE(traced.says(inch ? "x=76.2 y=-76.2" : "x=3 y=-3")) << traced.ran.out;
    }
}

TEST(ToolTable, GivesLengthsInTheMachinesUnit) {
    for (const bool inch : {false, true}) {
        Traced traced;
        const std::string table = traced.folder.write(
            "t.tbl", ";tools\nT3 P3 Z51.0 D5 ;a mill\n\nT4 P1 D+.25 X2 Z-1.5 I10 J20 Q2\n");
        traced.run("G21 G43 H4\nG43 H3\nM2\n",
                   {"--tool-table", table, "--machine-unit", inch ? "inch" : "mm"});
        EXPECT_TRUE(traced.says(inch ? "number=3 length=1295.4" : "number=3 length=51\n"))
            << traced.ran.out << traced.ran.err;
        EXPECT_TRUE(traced.says(inch ? "length=-38.1 x=50.8" : "length=-1.5 x=2\n"));
    }
}

TEST(SearchPath, IsWhereSubprogramsAreLookedFor) {
    Traced traced;
    std::filesystem::create_directories(traced.folder / "a");
    std::filesystem::create_directories(traced.folder / "b");
    std::filesystem::create_directories(traced.folder / "c");
    traced.folder.write("b/far.ngc", "o<far> sub\ng0 x42\no<far> endsub\n");
    traced.folder.write("c/farther.ngc", "o<farther> sub\ng0 x43\no<farther> endsub\n");
    const std::string program = "g21\no<far> call\no<farther> call\nm2\n";
    traced.run(program, {"--search-path", (traced.folder / "a") + ":" + (traced.folder / "b"),
                         "--search-path", traced.folder / "c"});
    EXPECT_TRUE(traced.says("x=42") && traced.says("x=43")) << traced.ran.err;
    traced.run(program, {"--search-path", traced.folder / "a"});
    EXPECT_EQ(traced.ran.status, 2);
    EXPECT_TRUE(traced.warns("far"));
}

TEST(IniFile, NamesUnitVariablesToolsAndSearchPathFromItsOwnFolder) {
    Traced traced;
    std::filesystem::create_directories(traced.folder / "machine/subs");
    traced.folder.write("machine/v.var", "5221 2\n");
    traced.folder.write("machine/t.tbl", "T1 P1 Z4\n");
    traced.folder.write("machine/subs/far.ngc", "o<far> sub\ng53 g0 x0\no<far> endsub\n");
    const std::string ini = traced.folder.write(
        "machine/mill.ini", "# a mill\n[EMC]\nVERSION = 1.1\n[RS274NGC]\nPARAMETER_FILE = v.var\n"
                            "SUBROUTINE_PATH = nowhere:subs\nRS274NGC_STARTUP_CODE = G17\n"
                            "[EMCIO]\nTOOL_TABLE=t.tbl\n[TRAJ]\nLINEAR_UNITS = inch\n");
    traced.run("g21\ng43 h1\no<far> call\nm2\n", {"--ini", ini});
    EXPECT_TRUE(traced.says("length=101.6")) << traced.ran.out << traced.ran.err;
    EXPECT_TRUE(traced.says("straight_traverse x=-50.8")) << traced.ran.out;
    EXPECT_TRUE(traced.warns("RS274NGC_STARTUP_CODE is executed before the program: G17"));
    traced.run("g21\ng43 h1\nm2\n", {"--ini", ini, "--machine-unit", "mm"});
    EXPECT_TRUE(traced.says("length=4\n")) << traced.ran.out;
}

TEST(IniFile, ShowsItsNumbersToPrograms) {
    Traced traced;
    const std::string ini = traced.folder.write(
        "mill.ini", "[SETUP]\nXPOS = 3.337\nYPOS=-4\nsmall = 5\nTEXT = some\n"
                    "[AXIS_A]\nWRAPPED_ROTARY = 1\n[AXIS_B]\nWRAPPED_ROTARY = 0\n");
    const std::string program =
        "g21 g0 x#<_ini[setup]xpos> y#<_INI[SetUp]YPos>\n"
        "z[exists[#<_ini[setup]xpos>]] a[exists[#<_ini[setup]small>]]\n"
        "z[exists[#<_ini[setup]text>]] a[exists[#<_ini[nothing]xpos>]]\nm2\n";
    traced.run(program, {"--ini", ini});
    EXPECT_EQ(traced.ran.status, 0) << traced.ran.err;
    EXPECT_TRUE(traced.says("x=3.337 y=-4\n")) << traced.ran.out;
    // An axis A at 1 would be in the trace.
    EXPECT_TRUE(traced.says("x=3.337 y=-4 z=1\n")) << traced.ran.out;
    EXPECT_TRUE(traced.says("x=3.337 y=-4 z=0\n")) << traced.ran.out;
    traced.run(program, {});
    EXPECT_EQ(traced.ran.status, 2);
}

TEST(IniFile, MayNameFilesThatAreNotThereYet) {
    Traced traced;
    const std::string ini =
        traced.folder.write("mill.ini", "[RS274NGC]\nPARAMETER_FILE = new.var\nwhat is this\n");
    traced.run("g21 g0 x1\nm2\n", {"--ini", ini});
    EXPECT_EQ(traced.ran.status, 0) << traced.ran.err;
    EXPECT_TRUE(traced.warns("new.var does not exist; treated as empty"));
}

TEST(MaxBlocks, StopsAProgramThatRunsLonger) {
    const std::string program = "G21\nG0 X1\nG0 X2\nG0 X3\nM2\n";
    Traced traced;
    traced.run(program, {"--max-blocks", "5"});
    EXPECT_EQ(traced.ran.status, 0) << traced.ran.err;
    traced.run(program, {"--max-blocks", "3"});
    EXPECT_EQ(traced.ran.status, 2);
    EXPECT_TRUE(traced.says("x=2") && !traced.says("x=3"));
    EXPECT_TRUE(traced.warns("stopped after 3 blocks"));
}

TEST(NoDecimalPoint, MakesALengthUnitsOrSmallestSteps) {
    const std::string program = "G21\nG0 X1000 Y2.\nM30\n";
    Traced traced;
    traced.dialect = "fanuc";
    traced.run(program, {});
    EXPECT_TRUE(traced.says("x=1000 y=2")) << traced.ran.out << traced.ran.err;
    traced.run(program, {"--no-decimal-point", "units"});
    EXPECT_TRUE(traced.says("x=1000 y=2")) << traced.ran.out;
    traced.run(program, {"--no-decimal-point", "steps"});
    EXPECT_TRUE(traced.says("x=1 y=2")) << traced.ran.out;
    const std::string setup = traced.folder.write(
        "s.toml", SetupWriter().program("no_decimal_point = \"steps\"\n").text());
    traced.run(program, {"--setup", setup});
    EXPECT_TRUE(traced.says("x=1 y=2")) << traced.ran.out << traced.ran.err;
    traced.run(program, {"--setup", setup, "--no-decimal-point", "units"});
    EXPECT_TRUE(traced.says("x=1000 y=2")) << traced.ran.out;
}

TEST(Units, HoldUntilTheProgramStatesItsOwn) {
    const std::string program = "G0 X1. Y2.\nG21\nX3.\nM30\n";
    for (const char* dialect : {"linuxcnc", "fanuc", "haas", "grbl"}) {
        Traced traced;
        traced.dialect = dialect;
        traced.run(program, {"--units", "inch"});
        EXPECT_TRUE(traced.says("x=25.4 y=50.8") && traced.says("x=3 ")) << traced.ran.out;
        EXPECT_FALSE(traced.warns("no units")) << traced.ran.err;
        const std::string setup = traced.folder.write(
            "s.toml", SetupWriter().program("units_at_start = \"inch\"\n").text());
        traced.run(program, {"--setup", setup});
        EXPECT_TRUE(traced.says("x=25.4 y=50.8")) << traced.ran.out << traced.ran.err;
        traced.run(program, {"--setup", setup, "--units", "mm"});
        EXPECT_TRUE(traced.says("x=1 y=2")) << traced.ran.out;
    }
    Traced traced;
    traced.dialect = "siemens";
    traced.run("G0 X1 Y2\nG710\nX3\nM30\n", {"--units", "inch"});
    EXPECT_TRUE(traced.says("x=25.4 y=50.8") && traced.says("x=3 ")) << traced.ran.out;
    traced.run("G0 X1\nM30\n", {"--units", "yard"});
    EXPECT_EQ(traced.ran.status, 2);
}

TEST(Units, OfABareProgramAreThoseThatWereStated) {
    const test_support::ScopedFolder folder;
    const std::string program =
        folder.write("p.nc", "(1/2 inch end mill, all dimensions in inches)\nG90 G54\nS4000 M3\n"
                             "G0 Z1.\nX-1. Y0.5\nG1 Z-0.2 F20.\nX5.\nG0 Z1.\nM30\n");
    const Ran silent = feeler({"check", program, "--dialect", "fanuc"});
    EXPECT_EQ(silent.status, 1);
    EXPECT_TRUE(silent.out.find("units-doubtful") != std::string::npos) << silent.out;
    EXPECT_TRUE(silent.out.find("--units") != std::string::npos) << silent.out;
    const Ran stated = feeler({"check", program, "--dialect", "fanuc", "--units", "inch"});
    EXPECT_EQ(stated.status, 0) << stated.out << stated.err;
    EXPECT_TRUE(stated.out.find("units-doubtful") == std::string::npos) << stated.out;
}

TEST(ProgramTable, SaysTheSameInASetup) {
    Traced traced;
    std::filesystem::create_directories(traced.folder / "subs");
    traced.folder.write("subs/far.ngc", "o<far> sub\ng53 g0 x0\no<far> endsub\n");
    traced.folder.write("v.var", "5241 -7\n");
    traced.folder.write("t.tbl", "T1 Z4\nT2 Z5\n");
    const std::string keys = "dialect = \"linuxcnc\"\nstart = { A = 30 }\nunit = \"inch\"\n"
                             "parameters = \"v.var\"\ntool_table = \"t.tbl\"\n"
                             "search_path = [\"subs\"]\nmax_blocks = 9\nmachine_codes = [331]\n";
    const std::string setup = traced.folder.write("s.toml", SetupWriter().program(keys).text());
    traced.dialect.clear();
    traced.run("g21 m331\ng43 h2\ng55\no<far> call\ng91 g0 a1\nm2\n", {"--setup", setup});
    EXPECT_TRUE(traced.says("number=2 length=127\n")) << traced.ran.out << traced.ran.err;
    EXPECT_TRUE(traced.says("offset=G55 x=-177.8")) << traced.ran.out;
    EXPECT_TRUE(traced.says("straight_traverse x=177.8")) << traced.ran.out;
    EXPECT_TRUE(traced.says("a=31")) << traced.ran.out;
    EXPECT_FALSE(traced.warns("331")) << traced.ran.err;
    traced.run("g21\ng43 h1\nm2\n", {"--setup", setup});
    EXPECT_TRUE(traced.says("number=1 length=95\n")) << "[[length_offset]] counts before the file";
    traced.run("g21\ng43 h2\nm2\n", {"--setup", setup, "--machine-unit", "mm"});
    EXPECT_TRUE(traced.says("number=2 length=5\n")) << "the command line counts before the set-up";
}

TEST(ProgramOptions, OfCheckMoveBodiesInAWorkOffset) {
    const ScopedFolder folder;
    const std::string variables = folder.write("v.var", "5221 -350\n5222 -200\n5223 -420\n");
    const std::string nc =
        folder.write("p.nc", test_support::program({"G0 X-20. Y50.", "Z-5.", "X120.", "Z60."}));
    const std::string toml = folder.write("s.toml", SetupWriter().offsets("").text());
    const auto infers = [](const Checked& checked) {
        return std::any_of(checked.assumptions.begin(), checked.assumptions.end(),
                           [](const std::string& each) {
                               return each.starts_with("the set-up states no work offset");
                           });
    };
    EXPECT_TRUE(infers(check_files(nc, toml)));
    EXPECT_FALSE(infers(check_files(nc, toml, {"--parameters", variables})));
    const std::string stated = folder.write("stated.toml", SetupWriter().text());
    EXPECT_EQ(check_files(nc, toml, {"--parameters", variables}).errors(),
              check_files(nc, stated).errors());
    const std::string other = folder.write("w.var", "5221 -300\n");
    const Checked both = check_files(nc, stated, {"--parameters", other});
    EXPECT_EQ(both.errors(), check_files(nc, stated).errors());
    EXPECT_NE(std::find(both.assumptions.begin(), both.assumptions.end(),
                        "G54 is taken from [offsets]; the variables file has another value"),
              both.assumptions.end());
}

/// Expects exit status 2, no standard output, and these words on standard error.
void expect_refused(const std::vector<std::string>& more, const std::string& shown_assumptions) {
    const ScopedFolder folder;
    const std::string program = folder.write("p.nc", "G21 G0 X1\nM2\n");
    const std::string setup = folder.write("s.toml", SetupWriter().text());
    for (const char* command : {"trace", "check"}) {
        std::vector<std::string> words = {command, program, "--setup", setup};
        words.insert(words.end(), more.begin(), more.end());
        const Ran ran = feeler(words);
        EXPECT_EQ(ran.status, 2) << command << shown_assumptions;
        EXPECT_EQ(ran.out, "") << command << shown_assumptions;
        EXPECT_NE(ran.err.find(shown_assumptions), std::string::npos)
            << shown_assumptions << " in: " << ran.err;
    }
}

TEST(ProgramOptions, RefuseValuesThatMeanNothing) {
    for (const char* place : {"", "X", "X=1,X=2", "Q=1", "X=nan", "X=1;Y=2", "1,2,3", "X=1e999"})
        expect_refused({"--start-position", place}, "--start-position");
    expect_refused({"--start-position", "here"}, "X=-100,Y=-50,Z=0");
    expect_refused({"--block-delete", "yes"}, "--block-delete");
    expect_refused({"--machine-unit", "cm"}, "--machine-unit");
    for (const char* count : {"0", "-1", "1.5", "many", ""})
        expect_refused({"--max-blocks", count}, "--max-blocks");
    expect_refused({"--search-path", "/nowhere/at/all"}, "there is no folder /nowhere/at/all");
    for (const char* option : {"--parameters", "--tool-table", "--ini"}) {
        expect_refused({option, "/nowhere.txt"}, "/nowhere.txt: there is no such file");
        expect_refused({option, "/"}, "is a folder");
    }
}

TEST(ProgramOptions, NameTheLineOfAMistakeInAFile) {
    const ScopedFolder folder;
    const auto refused = [&](const std::string& option, const std::string& text,
                             const std::string& shown_assumptions) {
        expect_refused({option, folder.write("bad.txt", text)}, shown_assumptions);
    };
    refused("--parameters", "5221 1\nfive 1\n", "bad.txt:2: expected a parameter number");
    refused("--parameters", "5221 1 1\n", "bad.txt:1: ");
    refused("--parameters", "0 1\n", "there is no parameter #0");
    refused("--parameters", "99999 1\n", "there is no parameter #99999");
    refused("--parameters", "31 1\n31 2\n", "bad.txt:2: #31 is defined twice");
    refused("--tool-table", "T1 Z1\nT1 Z2\n", "bad.txt:2: T1 is defined twice");
    refused("--tool-table", "P1 Z1\n", "needs a T word");
    refused("--tool-table", "T1 K1\n", "'K1': K is not a letter");
    refused("--tool-table", "T1 Zlong\n", "'Zlong': is not a letter and a number");
    refused("--tool-table", "T1.5 Z1\n", "T must be a whole number");
    refused("--ini", "[TRAJ]\nLINEAR_UNITS = furlong\n", "bad.txt:2: LINEAR_UNITS must be");
    refused("--ini", "[TRAJ]\nANGULAR_UNITS = radian\n", "bad.txt:2: ANGULAR_UNITS must be degree");
    refused("--ini", "#INCLUDE other.ini\n", "#INCLUDE is not supported");
}

/// The set-up of a plate with a clamp behind it, for LinuxCNC.
SetupWriter plate_with_clamp() {
    return SetupWriter()
        .program("dialect = \"linuxcnc\"\nstart = { X = -350, Y = -200, Z = 0 }\n")
        .fixture("clamp", "box = [[40, 100, -30], [60, 130, 20]]\n")
        .also_tool("number = 2\nshape = \"flat\"\ndiameter = 10\nflute_length = 20\n"
                   "shank = [[10, 10, 25]]\nholder = [[40, 40, 50]]\n")
        .lengths("[[length_offset]]\nnumber = 1\nlength = 95.0\n"
                 "[[length_offset]]\nnumber = 2\nlength = 95.0\n");
}

constexpr const char* changes_over_the_clamp = "G21 G90 G17 G40 G49 G80\nG54\nT1 M6\n"
                                               "G43 H1 G0 Z100\nS1000 M3\nG0 X50 Y-40\n"
                                               "G0 Z50\nT2 M6\nG43 H2\nS1000 M3\nG0 Z10\nM2\n";

TEST(ToolChangePosition, OfTheIniFileIsWhereTheNextMoveStarts) {
    const ScopedFolder folder;
    const auto checked = [&](const std::string& position) {
        const auto ini = folder.write("m.ini", "[TRAJ]\nLINEAR_UNITS = mm\n[EMCIO]\n" + position);
        return check(plate_with_clamp(), changes_over_the_clamp, {"--ini", ini});
    };
    EXPECT_EQ(checked("").errors(), "") << "Y-40 is beside the clamp";
    EXPECT_EQ(checked("TOOL_CHANGE_POSITION = -300 -240 -100\n").errors(), "");
    const Checked over = checked("TOOL_CHANGE_POSITION = -300 -85 -100\n");
    EXPECT_EQ(over.status, 1);
    EXPECT_NE(over.errors().find(" 11"), std::string::npos) << over.errors();
    EXPECT_EQ(over.of_severity("warning").find("length"), std::string::npos)
        << "the motion of the tool change needs no length offset";
}

TEST(Machine, MayHaveAnAxisWBesidesXYAndZ) {
    const ScopedFolder folder;
    std::string setup = "[program]\ndialect = \"linuxcnc\"\n[offsets]\n"
                        "G54 = { X = 0, Y = 0, Z = -200 }\n";
    for (const char* axis : {"X", "Y", "Z"})
        setup += "[[machine.axis]]\nname = \"" + std::string(axis) + "\"\nhome = 0\n";
    const std::string fourth = "[[machine.axis]]\nname = \"W\"\ndirection = [0, 0, 1]\nhome = 0\n"
                               "side = \"tool\"\nparent = \"Z\"\n";
    const std::string rest = "[stock]\nbox = [[-60, -30, -60], [-20, 30, -30]]\n"
                             "[[tool]]\nnumber = 1\nshape = \"flat\"\ndiameter = 10\n"
                             "flute_length = 20\nstick_out = 60\nholder = [[40, 40, 40]]\n";
    const auto printed = [&](const std::string& axis) {
        const auto ran = feeler({"check",
                                 folder.write("w.ngc", "G21 G90 G17 G54 G61\nT1 M6\nG43 H1\n"
                                                       "G0 X0 Y0\nG0 Z10\nG0 W20\nM2\n"),
                                 "--setup", folder.write("w.toml", setup + axis + rest)});
        return ran.out + ran.err;
    };
    EXPECT_NE(printed("").find("moves axis W, which the machine"), std::string::npos);
    EXPECT_EQ(printed(fourth).find("axis W"), std::string::npos) << printed(fourth);
}

TEST(IniFile, WithALongServoPeriodLeavesCornersUnknown) {
    const ScopedFolder folder;
    const auto says_so = [&](const std::string& period) {
        const auto ini = folder.write(
            "m.ini", "[TRAJ]\nLINEAR_UNITS = mm\n[EMCMOT]\nSERVO_PERIOD = " + period + "\n");
        std::string all;
        for (const std::string& assumption :
             check(plate_with_clamp(), changes_over_the_clamp, {"--ini", ini}).assumptions)
            all += assumption + "\n";
        return all.find("SERVO_PERIOD is longer") != std::string::npos;
    };
    EXPECT_TRUE(says_so("2000000"));
    EXPECT_FALSE(says_so("1000000"));
}

TEST(ToolChangePosition, IsApproachedOnACheckedRapid) {
    const ScopedFolder folder;
    const auto checked = [&](const std::string& keys) {
        const auto ini = folder.write("m.ini", "[TRAJ]\nLINEAR_UNITS = mm\n[EMCIO]\n" + keys);
        return check(plate_with_clamp(),
                     "G21 G90 G54\nT1 M6\nG43 H1 G0 Z100\nX50 Y-40\nZ5\nT2 M6\nM2\n",
                     {"--ini", ini});
    };
    const Checked across = checked("TOOL_CHANGE_POSITION = -300 0 -320\n");
    EXPECT_NE(across.errors().find(" 6"), std::string::npos) << across.errors();
    EXPECT_EQ(checked("TOOL_CHANGE_POSITION = -300 0 0\nTOOL_CHANGE_QUILL_UP = 1\n").errors(), "");
}

TEST(Kinematics, ThatMoveLinearAxesWithRotaryOnesAreRefused) {
    const ScopedFolder folder;
    const auto ran = [&](const std::string& name) {
        return feeler({"check", folder.write("p.ngc", "G21 G0 X1\nM2\n"), "--setup",
                       folder.write("s.toml", plate_with_clamp().text()), "--ini",
                       folder.write("m.ini", "[KINS]\nKINEMATICS = " + name + "\n")});
    };
    EXPECT_EQ(ran("genhexkins").status, 2);
    EXPECT_NE(ran("genhexkins").err.find("genhexkins is not supported"), std::string::npos);
    EXPECT_NE(ran("trivkins coordinates=XYZ").status, 2);
}

} // namespace
} // namespace app_test
