#include <algorithm>
#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/app/checked.h"
#include "tests/support/program_writer.h"

namespace app_test {
namespace {

using test_support::program;
using test_support::SetupWriter;

int count_of(const Checked& checked, const std::string& rule) {
    return static_cast<int>(std::count_if(checked.findings.begin(), checked.findings.end(),
                                          [&](const auto& f) { return f.rule == rule; }));
}

struct Slot {
    double x0, y0, x1, y1, z;
};

Checked cut(const Slot& slot) {
    return check(SetupWriter(),
                 program({fmt::format("G0 X{:.3f} Y{:.3f}", slot.x0, slot.y0), "Z30.",
                          fmt::format("G1 Z{:.3f} F300.", slot.z),
                          fmt::format("X{:.3f} Y{:.3f} F800.", slot.x1, slot.y1), "G0 Z60."}));
}

/// Distance of the flutes to the stock over the slot, sampled; 0 if they overlap. Flutes: 10 mm
/// across, from the tip up. Stock: 0 to 100, 0 to 100, -30 to 0.
double sampled_gap(const Slot& slot) {
    constexpr int steps = 4000;
    constexpr double radius = 5.0;
    double least = 1e9;
    for (int i = 0; i <= steps; ++i) {
        const double at = static_cast<double>(i) / steps;
        const double x = slot.x0 + at * (slot.x1 - slot.x0);
        const double y = slot.y0 + at * (slot.y1 - slot.y0);
        const double dx = std::max({0.0, -x, x - 100.0}), dy = std::max({0.0, -y, y - 100.0});
        const double beside = std::max(0.0, std::hypot(dx, dy) - radius);
        least = std::min(least, std::hypot(beside, std::max(0.0, slot.z)));
    }
    return least;
}

TEST(NothingCut, IsNeverSaidOfAProgramThatComesNearAndFoundForStraightPathsFarAway) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> across(-90.0, 190.0), height(-8.0, 6.0);
    int cuts = 0, far = 0;
    for (int i = 0; i < 40; ++i) {
        const bool along = i % 2 == 0; // along an axis, the boxes are exact but for corners
        Slot slot{across(random), across(random), across(random), across(random), height(random)};
        if (along) slot.y1 = slot.y0;
        const double gap = sampled_gap(slot);
        const Checked checked = cut(slot);
        SCOPED_TRACE(fmt::format("{} {} {} {} {}", slot.x0, slot.y0, slot.x1, slot.y1, slot.z));
        double removed = 0.0;
        for (const BlockLine& block : checked.blocks)
            if (block.motion != "rapid") removed += block.removed;
        if (removed > 0.0 || gap < 0.5) {
            EXPECT_EQ(count_of(checked, "nothing-cut"), 0);
            ++cuts;
        } else if (along && gap > 3.0) {
            EXPECT_EQ(count_of(checked, "nothing-cut"), 1);
            EXPECT_EQ(checked.status, 1);
            ++far;
        }
    }
    EXPECT_GT(cuts, 5);
    EXPECT_GT(far, 3);
}

TEST(NothingCut, CountsTheBulgeOfAnArc) {
    // Both ends are 20 mm beside the stock; the half circle reaches into it.
    const auto arc = [](const char* code) {
        return check(SetupWriter(),
                     program({"G0 X-30. Y20.", "Z2.", "G1 Z-2. F300.",
                              fmt::format("{} X-30. Y80. R30. F500.", code), "G0 Z60."}));
    };
    EXPECT_EQ(count_of(arc("G3"), "nothing-cut"), 0);
    EXPECT_EQ(count_of(arc("G2"), "nothing-cut"), 1);
}

TEST(NothingCut, NeedsAStatedStockATurningSpindleAndTheWholeProgram) {
    const std::string beside =
        program({"G0 X-50. Y50.", "Z2.", "G1 Z-5. F300.", "Y80. F800.", "G0 Z60."});
    EXPECT_EQ(count_of(check(SetupWriter(), beside), "nothing-cut"), 1);
    EXPECT_EQ(count_of(check(SetupWriter().without_stock(), beside), "nothing-cut"), 0);
    std::string still = beside;
    still.replace(still.find("M3"), 2, "M5");
    EXPECT_EQ(count_of(check(SetupWriter(), still), "nothing-cut"), 0);
}

TEST(OffsetImplausible, IsANoteWhereTheProgramCutsTheStockInAnotherOffset) {
    const SetupWriter setup = SetupWriter().offsets("G54 = { X = -350, Y = -200, Z = -420 }\n"
                                                    "G55 = { X = -350, Y = -400, Z = -420 }\n");
    const Checked both =
        check(setup, program({"G0 X-20. Y50.", "Z2.", "G1 Z-5. F300.", "X20. F800.", "G0 Z60.",
                              "G55 X-20. Y50.", "Z2.", "G1 Z-5.", "X20.", "G0 Z60."}));
    EXPECT_EQ(both.finding("offset-implausible").severity, "note");
    EXPECT_EQ(both.errors(), "");
}

TEST(OffsetImplausible, GivesHeightsOfTheMotionAndNotOfTheBlockReadAhead) {
    const Checked checked = check(
        SetupWriter(),
        program({"G0 X35. Y-40.", "Z10.", "G41 D1 G1 X30. Y0 F500.", "Y140.", "G40 G0 Z50."}));
    const std::string message = checked.finding("offset-implausible").message;
    EXPECT_NE(message.find("between Z10.000 and Z10.000"), std::string::npos) << message;
    EXPECT_NE(message.find("between Z-30.000 and Z0.000"), std::string::npos) << message;
}

/// A slot in the plate, with a tool of 95 mm.
Checked slot(const SetupWriter& setup, const std::string& before = "") {
    return check(
        setup, program({before, "G0 X20. Y50.", "Z2.", "G1 Z-5. F300.", "X80. F800.", "G0 Z60."}));
}

TEST(OffsetImplausible, NamesTheLengthIfThatIsTheCause) {
    const Checked wrong =
        slot(SetupWriter().lengths("[[length_offset]]\nnumber = 1\nlength = 145\n"));
    const FindingLine finding = wrong.finding("offset-implausible");
    EXPECT_EQ(finding.message, "The control counts with a length of 145.000 mm for tool 1, which "
                               "is 95.000 mm long: its tip is 50.000 mm higher than programmed, "
                               "and all cuts are above the stock.");
    EXPECT_EQ(finding.cure, "Correct the length of tool 1 in the control; if it is right there, "
                            "correct the tool in the set-up.");
    EXPECT_EQ(wrong.finding("nothing-cut").cure, finding.cure);
    const SetupWriter two = SetupWriter().lengths("[[length_offset]]\nnumber = 1\nlength = 95\n"
                                                  "[[length_offset]]\nnumber = 3\nlength = 145\n");
    const FindingLine other = slot(two, "G43 H3 Z60.").finding("offset-implausible");
    EXPECT_NE(other.message.find("145.000 mm (H3) for tool 1"), std::string::npos) << other.message;
    EXPECT_EQ(other.cure, "Use H1, or correct its length.");
}

TEST(OffsetImplausible, NamesTheWorkOffsetIfTheLengthIsNotTheCause) {
    // 50 mm too high by the work offset, and 2 mm by the length.
    const Checked wrong = slot(
        SetupWriter().lengths("[[length_offset]]\nnumber = 1\nlength = 97\n"), "G10 L2 P1 Z-370.");
    const FindingLine finding = wrong.finding("offset-implausible");
    EXPECT_NE(finding.message.find("In G54 the program feeds between Z-5.000 and Z2.000, but the "
                                   "stock is between Z-80.000 and Z-50.000"),
              std::string::npos)
        << finding.message;
}

TEST(OffsetImplausible, IsNotReportedWhereTheOffsetIsUnknown) {
    const Checked unknown = slot(SetupWriter(), "G10 L2 P1 Z[-370.+#500]");
    EXPECT_EQ(unknown.errors(), "unknown-value 6");
    EXPECT_EQ(count_of(unknown, "offset-implausible"), 0);
    EXPECT_EQ(count_of(unknown, "nothing-cut"), 0);
    EXPECT_GT(count_of(slot(SetupWriter(), "G10 L2 P1 Z-370."), "nothing-cut"), 0);
}

TEST(ToolMismatch, IsAWarningIfTheToolInTheSetupIsTheLargerOne) {
    const auto with = [](const std::string& comment) {
        return check(SetupWriter(), "(" + comment + ")\n"
                                        + program({"G0 X-20. Y50.", "Z2.", "G1 Z-5. F300.",
                                                   "X20. F800.", "G0 Z60."}));
    };
    EXPECT_EQ(with("T1 END MILL D16").finding("tool-mismatch").severity, "error");
    EXPECT_EQ(with("T1 END MILL D6").finding("tool-mismatch").severity, "warning");
    EXPECT_EQ(with("T1 BALL END MILL D10").finding("tool-mismatch").severity, "warning");
    EXPECT_EQ(count_of(with("T1 END MILL D9.9"), "tool-mismatch"), 0);
    EXPECT_EQ(count_of(with("T1 BULL END MILL D10 R1"), "tool-mismatch"), 0);
    EXPECT_EQ(count_of(with("T3 DRILL D20"), "tool-mismatch"), 0) << "not used";
}

TEST(ToolMismatch, IsAWarningIfTheCommentNamesADrillOrAChamferMillForAMill) {
    const auto with = [](const std::string& comment, const std::string& shape) {
        const SetupWriter setup =
            SetupWriter().tool("number = 1\nshape = \"" + shape
                               + "\"\ndiameter = 10\nflute_length = 40\nshank = [[10, 10, 25]]\n"
                                 "holder = [[40, 40, 50]]\n");
        return check(setup, "(" + comment + ")\n"
                                + program({"G0 X50. Y50.", "G98 G81 Z-5. R2. F300.", "G80"}));
    };
    EXPECT_EQ(with("T1 10MM DRILL", "flat").finding("tool-mismatch").severity, "warning");
    EXPECT_EQ(with("T1 10MM CHAMFER MILL", "flat").finding("tool-mismatch").severity, "warning");
    EXPECT_EQ(with("T1 10MM DRILL", "ball").finding("tool-mismatch").severity, "warning");
    EXPECT_EQ(count_of(with("T1 10MM DRILL", "drill"), "tool-mismatch"), 0);
    EXPECT_EQ(count_of(with("T1 10MM SPOT DRILL", "drill"), "tool-mismatch"), 0);
    EXPECT_EQ(count_of(with("T1 10MM COUNTERSINK", "drill"), "tool-mismatch"), 0);
    EXPECT_EQ(count_of(with("T1 10MM END MILL", "flat"), "tool-mismatch"), 0);
}

TEST(ImplausibleValue, IsAWarningForAFeedAboveTheRapidSpeedOfTheMachine) {
    const auto at = [](const char* feed) {
        return check(SetupWriter(), program({"G0 X-20. Y50.", "Z2.", "G1 Z-5. F300.",
                                             fmt::format("X20. F{}", feed), "G0 Z60."}));
    };
    EXPECT_EQ(count_of(at("20000."), "implausible-value"), 0);
    EXPECT_EQ(at("21000.").finding("implausible-value").severity, "warning");
    EXPECT_EQ(at("2250000.").finding("implausible-value").severity, "error");
    EXPECT_EQ(at("2250000.").status, 1);
}

TEST(NothingMoves, IsAWarningForSubprogramsAndAnErrorForComments) {
    EXPECT_EQ(check(SetupWriter(), "%\nO1 (NOTHING)\n%\n").finding("nothing-moves").severity,
              "error");
    const Checked sub =
        check(SetupWriter(), "O<a> SUB\nG0 X1\nO<a> ENDSUB\nM2\n", {"--dialect", "linuxcnc"});
    EXPECT_EQ(sub.finding("nothing-moves").severity, "warning");
}

} // namespace
} // namespace app_test
