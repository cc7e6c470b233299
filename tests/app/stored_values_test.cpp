// What a program takes from the memory of the control: offsets, reference points, units.

#include <algorithm>
#include <tuple>

#include <gtest/gtest.h>

#include "tests/app/checked.h"

namespace app_test {
namespace {

using test_support::SetupWriter;

/// A plate of 100 x 100 x 30 with a clamp from Y104 on that is 12 higher.
SetupWriter plate(const std::string& dialect) {
    SetupWriter setup;
    setup.program("dialect = \"" + dialect + "\"\nstart = { X = -350, Y = -200, Z = 0 }\n");
    setup.fixture("clamp", "box = [[40, 104, -30], [60, 130, 12]]\n");
    return setup;
}

std::string errors_of(const std::string& dialect, const std::string& program,
                      const std::string& stated = "") {
    return check(plate(dialect).also(stated), program).errors();
}

constexpr const char* fanuc_head = "G21 G90 G17 G40 G49 G80 G94\nG54\nT1 M6\nS1000 M3\n";

// --- memories of tool offsets ---

/// Writes 1 mm to offset 1, whose length is 95 mm, and moves to 2.1 mm above the clamp.
std::string writes_offset(const std::string& write) {
    return fanuc_head + write + "\nG43 H1 G0 Z100.\nG0 X50. Y117.\nG0 Z14.1\nG0 Z100.\nM30\n";
}

TEST(StoredValues, AMacroVariableOfAnOffsetDependsOnItsMemory) {
    for (const char* write : {"#2001=1.", "#10001=1.", "G10 L11 P1 R1."}) {
        SCOPED_TRACE(write);
        const std::string program = writes_offset(write);
        // In memory C it is a wear of 1 mm, in memory A the whole offset: 80 mm too low.
        EXPECT_EQ(errors_of("fanuc", program), "open-premise 5");
        EXPECT_EQ(errors_of("fanuc", program, "[control]\n\"tool offset memory\" = \"C\"\n"), "");
        EXPECT_EQ(errors_of("fanuc", program, "[control]\n\"tool offset memory\" = \"B\"\n"), "");
        const std::string crash =
            errors_of("fanuc", program, "[control]\n\"tool offset memory\" = \"A\"\n");
        EXPECT_NE(crash.find("collision"), std::string::npos) << crash;
        EXPECT_EQ(crash.find("open-premise"), std::string::npos) << crash;
    }
}

TEST(StoredValues, AnOffsetThatWasNotSetIsUnknown) {
    const std::string program = fanuc_head
                                + std::string("G43 H1 G0 Z100.\nG0 X50. Y50.\n"
                                              "G0 Z[10.+#2001]\nG0 Z100.\nM30\n");
    EXPECT_NE(errors_of("fanuc", program).find("unknown-value 7"), std::string::npos);
    EXPECT_EQ(errors_of("fanuc", program, "[program.values]\n\"#2001\" = 0.5\n"), "");
    const std::string own = fanuc_head
                            + std::string("#2001=0.5\nG43 H1 G0 Z100.\nG0 X50. Y50.\n"
                                          "G0 Z[10.+#2001]\nG0 Z100.\nM30\n");
    EXPECT_EQ(errors_of("fanuc", own, "[control]\n\"tool offset memory\" = \"C\"\n"), "");
}

TEST(StoredValues, TheHOfMemoryBIsItsD) {
    // With memory B, the radius under D1 is the value under H1: the contour is 30 mm farther out.
    const std::string program =
        fanuc_head
        + std::string("G10 L10 P1 R40.\nG43 H1 G0 Z100.\nG0 X-60. Y50.\nG0 Z5.\n"
                      "G1 G41 D1 X-40. Y60. F500.\nG1 Y90.\nG1 X30.\nG1 G40 X30. Y80.\n"
                      "G0 Z100.\nM30\n");
    const std::string stated = "[control]\n\"tool offset memory\" = ";
    const std::string apart = errors_of("fanuc", program, stated + "\"C\"\n");
    const std::string shared = errors_of("fanuc", program, stated + "\"B\"\n");
    EXPECT_NE(apart, shared);
}

TEST(StoredValues, ASizeOfHaasIsADiameterOrARadius) {
    // Left of the contour by the radius: 10 mm from X40, or 20 mm.
    const std::string program =
        fanuc_head
        + std::string("G10 L12 P1 R20.\nG43 H1 G0 Z100.\nG0 X-15. Y150.\nG0 Z5.\n"
                      "G1 G41 D1 X20. F500.\nG1 X20. Y110.\nG1 Y90.\nG1 G40 X0.\nG0 Z100.\nM30\n");
    const std::string open = errors_of("haas", program);
    const std::string diameter =
        errors_of("haas", program, "[control]\n\"setting 40\" = \"DIAMETER\"\n");
    const std::string radius =
        errors_of("haas", program, "[control]\n\"setting 40\" = \"RADIUS\"\n");
    EXPECT_NE(radius.find("collision"), std::string::npos) << radius;
    EXPECT_EQ(diameter.find("collision"), std::string::npos) << diameter;
    EXPECT_NE(open.find("open-premise 5"), std::string::npos) << open;
}

TEST(StoredValues, AValueUnderDOfFanucIsARadiusOrADiameter) {
    // Left of the contour by the radius: 10 mm from X40, or 20 mm.
    const auto program = [](const std::string& writes) {
        return fanuc_head + writes
               + "G43 H1 G0 Z100.\nG0 X-15. Y150.\nG0 Z5.\n"
                 "G1 G41 D1 X20. F500.\nG1 X20. Y110.\nG1 Y90.\nG1 G40 X0.\nG0 Z100.\nM30\n";
    };
    const std::string memory = "[control]\n\"tool offset memory\" = \"C\"\n\"5003#0\" = 0\n";
    for (const std::string writes : {"G10 L12 P1 R20.\n", "#13001=20.\n"}) {
        const std::string open = errors_of("fanuc", program(writes), memory);
        const std::string radius = errors_of("fanuc", program(writes), memory + "\"5004#2\" = 0\n");
        const std::string diameter =
            errors_of("fanuc", program(writes), memory + "\"5004#2\" = 1\n");
        EXPECT_NE(open, diameter) << writes;
        EXPECT_NE(radius, diameter) << writes;
        EXPECT_EQ(radius.find("open-premise"), std::string::npos) << radius;
    }
    // The radius of the tool in the set-up is known.
    const Checked own = check(plate("fanuc").also(memory), program(""));
    for (const std::string& assumption : own.assumptions)
        EXPECT_EQ(assumption.find("5004#2"), std::string::npos) << assumption;
}

TEST(StoredValues, ALengthThatG28CancelsMayComeBack) {
    const std::string program = fanuc_head
                                + std::string("G43 H1 G0 Z100.\nG0 X50. Y50.\nG91 G28 Z0.\nG90\n"
                                              "G0 Z50.\nG0 Z120.\nM30\n");
    const auto is_low = [&](const std::string& stated) {
        return errors_of("fanuc", program, stated).find("rapid-in-stock 9") != std::string::npos;
    };
    EXPECT_TRUE(is_low(""));
    EXPECT_TRUE(is_low("[control]\n\"5001#6\" = 0\n"));
    EXPECT_FALSE(is_low("[control]\n\"5001#6\" = 1\n"));
    // If it comes back, Z350 is above the limit. The parameter also decides on G10, which is not
    // meant here.
    const std::string high = fanuc_head
                             + std::string("G43 H1 G0 Z100.\nG0 X50. Y50.\nG91 G28 Z0.\nG90\n"
                                           "G0 Z350.\nM30\n");
    const std::string message = check(plate("fanuc"), high).finding("open-premise").message;
    EXPECT_NE(message.find("(the length offset that G28, G30 or G53 cancelled counts from the next "
                           "block)"),
              std::string::npos)
        << message;
    EXPECT_EQ(message.find("G10"), std::string::npos) << message;
    // Nothing is asked where the program selects the offset again, or moves no Z.
    const std::string again = fanuc_head
                              + std::string("G43 H1 G0 Z100.\nG91 G28 Z0.\nG90\nG0 X50. Y50.\n"
                                            "G43 H1 Z50.\nG49\nM30\n");
    const Checked result = check(plate("fanuc").also("[control]\n\"5006#6\" = 1\n"), again);
    EXPECT_EQ(result.errors(), "");
    for (const std::string& assumption : result.assumptions)
        EXPECT_EQ(assumption.find("5001#6"), std::string::npos) << assumption;
}

// --- reference points ---

TEST(StoredValues, AStoredReferencePointIsUnknownUntilItIsStated) {
    const std::string program = "G21 G90 G54 G17\nT1 M6\nG43 H1\nG0 Z100\nG0 X50 Y50\nG28\nM2\n";
    SetupWriter setup; // whose machine states no home
    setup.program("dialect = \"linuxcnc\"\nstart = { X = -350, Y = -200, Z = 0 }\n");
    EXPECT_NE(check(setup, program).errors().find("unknown-value 6"), std::string::npos);
    const std::string stores =
        "G21 G90 G54 G17\nG28.1\nT1 M6\nG43 H1\nG0 Z100\nG0 X50 Y50\nG28\nM2\n";
    EXPECT_EQ(check(setup, stores).errors(), "");
}

// --- units ---

std::string without_unit(const std::string& unit) {
    return unit
           + "G90 G17 G40 G49 G80\nG54\nT1 M6\nG43 H1 G0 Z4.\nS1000 M3\nG0 X1.9 Y4.3\n"
             "G0 Z0.3\nG0 Z4.\nM30\n";
}

TEST(StoredValues, AnUnstatedUnitIsFollowedWhereSomethingIsDescribed) {
    // X1.9 Y4.3 Z0.3 is over the plate in mm, and in the clamp in inches.
    for (const auto& [dialect, mm, inch] :
         {std::tuple{"fanuc", "\"0#2\" = 0", "\"0#2\" = 1"},
          {"haas", "\"setting 9\" = \"MM\"", "\"setting 9\" = \"INCH\""},
          {"linuxcnc", "LINEAR_UNITS = \"mm\"", "LINEAR_UNITS = \"inch\""}}) {
        SCOPED_TRACE(dialect);
        const auto errors = [&](const std::string& program, const std::string& stated) {
            return errors_of(dialect, program, stated.empty() ? "" : "[control]\n" + stated + "\n");
        };
        const std::string open = errors(without_unit(""), "");
        EXPECT_NE(open.find("open-premise"), std::string::npos) << open;
        EXPECT_EQ(open.find("collision"), std::string::npos) << open;
        EXPECT_EQ(errors(without_unit(""), mm).find("open-premise"), std::string::npos);
        const std::string in_inches = errors(without_unit(""), inch);
        EXPECT_NE(in_inches.find("collision"), std::string::npos) << in_inches;
        EXPECT_EQ(errors(without_unit("G21 "), "").find("open-premise"), std::string::npos);
    }
}

TEST(StoredValues, TheUnitOfTheMachineIsThatOfTheProgram) {
    SetupWriter setup = plate("linuxcnc");
    setup.program("dialect = \"linuxcnc\"\nunit = \"mm\"\nstart = { X = -350, Y = -200, Z = 0 }\n");
    EXPECT_EQ(check(setup, without_unit("")).errors().find("open-premise"), std::string::npos);
}

// --- offsets that the program measures ---

constexpr const char* touch_off =
    "G21 G90 G54 G17\nT1 M6\nG43 H1\nG0 Z20\nG0 X10 Y10\nG38.2 Z-5 F50\nG10 L20 P1 Z0\n"
    "G0 Z10\nG0 X90 Y50\nG0 Z100\nM2\n";

TEST(StoredValues, AMeasuredOffsetIsUnknownUnlessItIsTheStatedOne) {
    const Checked open = check(plate("linuxcnc"), touch_off);
    EXPECT_NE(open.errors().find("unknown-value 7"), std::string::npos) << open.errors();
    EXPECT_NE(open.finding("unknown-value").cure.find("measured_offsets"), std::string::npos);
    EXPECT_EQ(open.verdict, "undecided");
    SetupWriter setup = plate("linuxcnc");
    const auto stated = [&](const std::string& program) {
        setup.program("dialect = \"linuxcnc\"\nstart = { X = -350, Y = -200, Z = 0 }\n"
                      "measured_offsets = \"as stated\"\n");
        return check(setup, program);
    };
    EXPECT_EQ(stated(touch_off).errors(), "");
    EXPECT_EQ(stated(touch_off).verdict, "clear");
    // It is a statement about offsets that are measured, not about those that are computed.
    std::string lower = touch_off;
    lower.replace(lower.find("G10 L20 P1 Z0"), 13, "G10 L2 P1 Z-450");
    EXPECT_NE(stated(lower).errors(), "");
    std::string crash = touch_off;
    crash.replace(crash.find("X90 Y50"), 7, "X50 Y140");
    EXPECT_NE(stated(crash).errors().find("collision"), std::string::npos);
    std::string shifted = touch_off;
    shifted.replace(shifted.find("G10 L20 P1 Z0"), 13, "G92 Z0");
    EXPECT_EQ(stated(shifted).verdict, "clear");
}

// --- modes at the start ---

/// An arc over the clamp in the XY plane, which dips into it in any other.
std::string arc_without_plane(const std::string& first) {
    return first
           + "G21 G90 G40 G49 G80 G94\nG54\nT1 M6\nS1000 M3\nG43 H1 G0 Z100.\n"
             "G0 X20. Y115.\nG0 Z30.\nG2 X80. Y115. R30. F500.\nG0 Z100.\nM30\n";
}

TEST(StoredValues, ThePlaneAtTheStartIsAPremiseOfArcs) {
    for (const auto& [dialect, first, other] :
         {std::tuple{"fanuc", "\"3402#1\" = 0\n\"3402#2\" = 0\n\"3402#6\" = 1\n",
                     "\"3402#1\" = 1\n\"3402#6\" = 1\n"},
          {"siemens", "\"MD20150[5]\" = 1\n\"MD20150[7]\" = 2\n", "\"MD20150[5]\" = 2\n"}}) {
        SCOPED_TRACE(dialect);
        const bool is_siemens = std::string(dialect) == "siemens";
        std::string program = arc_without_plane("");
        if (is_siemens) // its words for the same path
            program = "G71 G90 G40\nG54\nT1 D1 M6\nS1000 M3\nG0 Z100\nG0 X20 Y115\nG0 Z30\n"
                      "G2 X80 Y115 CR=30 F500\nG0 Z100\nM30\n";
        const auto errors = [&](const std::string& stated) {
            return errors_of(dialect, program, "[control]\n" + stated);
        };
        EXPECT_NE(errors("").find("open-premise"), std::string::npos) << errors("");
        EXPECT_EQ(errors(first), "nothing-cut 8");
        EXPECT_NE(errors(other).find("collision 8"), std::string::npos) << errors(other);
        EXPECT_EQ(errors_of(dialect, "G17\n" + program), "nothing-cut 9");
    }
}

TEST(StoredValues, AnInitialModeCountsOnlyIfAResetRestoresIt) {
    const std::string program = "G21 G17 G40 G49 G80\nG54\nT1 M6\nS1000 M3\nG43 H1 G0 Z100.\n"
                                "X50. Y50.\nZ5.\nM30\n";
    const auto errors = [&](const std::string& stated) {
        return errors_of("fanuc", program, "[control]\n\"5006#6\" = 1\n" + stated);
    };
    EXPECT_EQ(errors("\"3402#3\" = 0\n\"3402#6\" = 1\n"), "");
    const Checked open =
        check(plate("fanuc").also("[control]\n\"5006#6\" = 1\n\"3402#3\" = 0\n"), program);
    EXPECT_NE(open.finding("open-premise").message.find("3402#6"), std::string::npos);
}

// --- variables of the main program ---

TEST(StoredValues, ALocalVariableOfTheMainProgramMayBeLeftOver) {
    const std::string program = fanuc_head
                                + std::string("G43 H1 G0 Z100.\nG0 X50. Y50.\nIF[#1NE#0]GOTO10\n"
                                              "GOTO20\nN10 G0 Z-5.\nN20 G0 Z100.\nM30\n");
    const auto errors = [&](const std::string& stated) {
        return errors_of("fanuc", program, stated);
    };
    EXPECT_EQ(errors("[control]\n\"5006#6\" = 1\n"), "open-premise 7");
    EXPECT_EQ(errors("[control]\n\"5006#6\" = 1\n\"6001#7\" = 0\n"), "");
    EXPECT_NE(errors("[program.values]\n\"#1\" = 3\n").find("rapid-in-stock 9"), std::string::npos);
    // The arguments of a macro, and its vacant ones, are known.
    const std::string macro = fanuc_head
                              + std::string("G43 H1 G0 Z100.\nG0 X50. Y50.\nG65 P9 A1.\nM30\n"
                                            "O9\nIF[#2NE#0]GOTO10\nGOTO20\nN10 G0 Z-5.\n"
                                            "N20 G0 Z100.\nM99\n");
    EXPECT_EQ(errors_of("fanuc", macro, "[control]\n\"5006#6\" = 1\n"), "");
}

TEST(StoredValues, AToolChangeWithoutAnIniFileIsAssumedNotToMove) {
    const std::string program = "G21 G90 G17\nG54\nT1 M6\nG43 H1 G0 Z100\nG0 X50 Y50\nM2\n";
    const auto says = [&](const std::string& stated) {
        for (const std::string& assumption :
             check(plate("linuxcnc").also(stated), program).assumptions)
            if (assumption.find("M6 does not move the machine") != std::string::npos) return true;
        return false;
    };
    EXPECT_TRUE(says(""));
    EXPECT_FALSE(says("[control]\nTOOL_CHANGE_QUILL_UP = true\n"));
}

// --- what an undescribed tool cannot show ---

TEST(StoredValues, TheSpindleIsNotCheckedAboveAToolThatNobodyDescribed) {
    const std::string program = fanuc_head
                                + std::string("G43 H1 G0 Z100.\nG0 X-20. Y50.\nG0 Z-5.\n"
                                              "G1 X120. F800.\nG0 Z100.\nM30\n");
    const test_support::ScopedFolder folder;
    const std::string file = folder.write("p.nc", program);
    const std::string nose =
        "[program]\ndialect = \"fanuc\"\n[[machine.body]]\nname = \"nose\"\n"
        "axis = \"Z\"\ncylinder = { radius = 100, height = 50, axis = \"Z\" }\n"
        "at = [0, 0, -20]\n";
    const Checked bare = check_files(file, folder.write("s.toml", nose));
    EXPECT_EQ(bare.errors(), "");
    bool said = false;
    for (const std::string& assumption : bare.assumptions)
        said = said || assumption.find("how far tool 1 sticks out") != std::string::npos;
    EXPECT_TRUE(said);
    const std::string tool = "[[tool]]\nnumber = 1\nshape = \"flat\"\ndiameter = 10\n"
                             "flute_length = 20\nstick_out = 22\n";
    const Checked described = check_files(file, folder.write("t.toml", nose + tool));
    EXPECT_NE(described.errors(), "");
}

/// Tool 7, which is not described, drills on a Siemens control; the tool table may have its length.
Checked drilled_by_tool_7(const std::string& table) {
    const SetupWriter setup =
        SetupWriter()
            .program("dialect = \"siemens\"\nstart = { X = -350, Y = -200, Z = 0 }\n")
            .lengths(table)
            .also("[[machine.body]]\nname = \"nose\"\naxis = \"Z\"\n"
                  "cylinder = { radius = 40, height = 50, axis = \"Z\" }\n");
    return check(setup, "G17 G71 G90 G94 G40\nT7\nM6\nD1\nS2500 M3\nG54 G0 X50 Y50\nZ30\n"
                        "G1 Z-10 F150\nG0 Z30\nSUPA G0 Z0 D0\nM30\n");
}

bool tells_of_the_nose(const Checked& checked) {
    return std::ranges::any_of(checked.findings, [](const FindingLine& finding) {
        return finding.message.find("nose") != std::string::npos;
    });
}

TEST(StoredValues, TheNoseIsNotCheckedAboveAToolOfUnknownLength) {
    const Checked unknown = drilled_by_tool_7("");
    EXPECT_FALSE(tells_of_the_nose(unknown));
    EXPECT_EQ(unknown.verdict, "undecided");
    // With its length in the tool table, it is known where the nose is.
    EXPECT_TRUE(
        tells_of_the_nose(drilled_by_tool_7("[[length_offset]]\nnumber = 7\nlength = 5\n")));
    EXPECT_FALSE(
        tells_of_the_nose(drilled_by_tool_7("[[length_offset]]\nnumber = 7\nlength = 95\n")));
}

TEST(StoredValues, ATapIsLeftHandIfTheSpindleTurnsSo) {
    const test_support::ScopedFolder folder;
    const auto errors = [&](const std::string& cycle) {
        return check_files(folder.write("p.nc", fanuc_head
                                                    + std::string("G43 H1 G0 Z100.\nG0 X20. Y50.\n")
                                                    + cycle + "\nG80\nG0 Z100.\nM30\n"),
                           "", {"--dialect", "fanuc"})
            .errors();
    };
    EXPECT_EQ(errors("M4\nG74 X20. Y50. Z-5. R2. F625."), "");
    EXPECT_EQ(errors("G84 X20. Y50. Z-5. R2. F625."), "");
    // A drill that turns to the left is a mistake.
    EXPECT_NE(errors("M4\nG81 X20. Y50. Z-5. R2. F100."), "");
}

// --- conditions on what was computed ---

TEST(StoredValues, AConditionNamesTheUnknownValueItWasComputedFrom) {
    const std::string program = fanuc_head
                                + std::string("#1=#1005+1\n#2=#1*2\nG43 H1 G0 Z100.\n"
                                              "G0 X50. Y50.\nIF[#2GT2]GOTO10\nGOTO20\n"
                                              "N10 G0 Z-5.\nN20 G0 Z100.\nM30\n");
    const Checked result = check(plate("fanuc").also("[control]\n\"5006#6\" = 1\n"), program);
    const FindingLine finding = result.finding("open-premise");
    EXPECT_NE(finding.message.find("#1005"), std::string::npos) << finding.message;
    EXPECT_NE(finding.cure.find("#1005"), std::string::npos) << finding.cure;
    EXPECT_EQ(finding.cure.find("#2 "), std::string::npos) << finding.cure;
}

// --- Heidenhain ---

TEST(StoredValues, ADatumAfterAMotionMayBeAnother) {
    const auto program = [](const std::string& before, const std::string& row) {
        return "BEGIN PGM P MM\nTOOL CALL 1 Z S1000\n" + before
               + "CYCL DEF 247 DATUM SETTING ~\nQ339=+" + row
               + " ;DATUM NUMBER\nL X+50 Y+50 R0 FMAX\nL Z+40 R0 FMAX\nL Z+100 R0 FMAX\nM30\n"
                 "END PGM P MM\n";
    };
    const std::string moves = "L Z+100 R0 FMAX\nL X+0 Y+0 R0 FMAX\n";
    EXPECT_EQ(errors_of("heidenhain", program("L Z+0 R0 FMAX M91\n", "2")), "");
    EXPECT_NE(errors_of("heidenhain", program(moves, "2")).find("undecided"), std::string::npos);
    EXPECT_EQ(errors_of("heidenhain", program(moves, "2"), "[control]\ndatum = 2\n"), "");
    EXPECT_NE(
        errors_of("heidenhain", program(moves, "3"), "[control]\ndatum = 2\n").find("undecided"),
        std::string::npos);
}

} // namespace
} // namespace app_test
