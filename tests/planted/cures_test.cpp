#include <algorithm>
#include <cstdio>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/app/checked.h"
#include "tests/support/program_writer.h"

namespace app_test {
namespace {

using test_support::program;
using test_support::SetupWriter;

/// The first number in a text after the given words.
double number_after(const std::string& text, const std::string& words) {
    const size_t at = text.find(words);
    double number = -1.0;
    if (at == std::string::npos
        || std::sscanf(text.c_str() + at + words.size(), "%lf", &number) != 1)
        ADD_FAILURE() << "no number after '" << words << "' in: " << text;
    return number;
}

/// Three passes along one slot; the holder, radius 20, overhangs both walls.
Checked deep_slot(double stick_out) {
    const SetupWriter setup = SetupWriter().lengths("").tool(
        fmt::format("number = 1\nshape = \"flat\"\ndiameter = 10\nflute_length = 20\n"
                    "stick_out = {}\nholder = [[40, 40, 50]]\n",
                    stick_out));
    return check(setup,
                 program({"G0 X-40. Y50.", "Z-12.", "G1 X140. F800.", "G0 Z60.", "X-40.", "Z-24.",
                          "G1 X140.", "G0 Z60.", "X-40.", "Z-28.", "G1 X140.", "G0 Z60."}));
}

TEST(Cure, OfAShortStickOutIsTheLeastThatKeepsEveryMinimumClearance) {
    // Minimum clearance above the walls is 1 mm: depth 24 needs 25, depth 28 needs 29.
    const FindingLine shown_assumptions = deep_slot(24.0).finding("stick-out-short");
    EXPECT_EQ(shown_assumptions.line, 12);
    const double enough = number_after(shown_assumptions.cure, "A stick-out of ");
    EXPECT_NEAR(enough, 29.0, 0.11);
    EXPECT_EQ(deep_slot(enough).errors(), "");
    EXPECT_NE(deep_slot(enough - 0.2).errors(), "");
}

/// A slot 24 deep in one pass.
Checked slot_at_once(double flutes) {
    const SetupWriter setup = SetupWriter().lengths("").tool(
        fmt::format("number = 1\nshape = \"flat\"\ndiameter = 10\nflute_length = {}\n"
                    "stick_out = 60\nholder = [[40, 40, 50]]\n",
                    flutes));
    return check(setup, program({"G0 X-40. Y50.", "Z-24.", "G1 X140. F800.", "G0 Z60."}));
}

TEST(Cure, OfFlutesThatAreTooShortIsTheDepth) {
    const FindingLine shown_assumptions = slot_at_once(18.0).finding("over-engagement");
    EXPECT_EQ(shown_assumptions.severity, "warning");
    const double enough = number_after(shown_assumptions.cure, "Flutes of ");
    EXPECT_NEAR(enough, 24.0, 0.2);
    EXPECT_EQ(slot_at_once(enough).errors(), "");
    EXPECT_NE(slot_at_once(enough - 0.3).errors(), "");
}

/// Two pockets with a stud 8 high between them.
Checked two_pockets(double retract) {
    const SetupWriter setup = SetupWriter().fixture("stud", "box = [[48, 46, 0], [56, 54, 8]]");
    return check(setup, program({"G0 X20. Y50.", "Z2.", "G1 Z-5. F200.", "X30. F800.",
                                 fmt::format("G0 Z{:.3f}", retract), "X75.", "Z2.", "G1 Z-5. F200.",
                                 "X85. F800.", "G0 Z60."}));
}

TEST(Cure, OfALowRetractClearsTheObstacle) {
    const FindingLine shown_assumptions = two_pockets(4.0).finding("low-retract");
    EXPECT_EQ(shown_assumptions.line, 11);
    const double higher = number_after(shown_assumptions.cure, "Retract ");
    EXPECT_NEAR(higher, 6.0, 0.11); // 8 plus the minimum clearance of 2, minus 4
    EXPECT_EQ(two_pockets(4.0 + higher).of_severity("warning"), "");
    EXPECT_EQ(two_pockets(4.0 + higher).errors(), "");
    EXPECT_NE(two_pockets(4.0 + higher - 0.2).errors(), "");
}

/// A rapid along X at a height of 2.5 mm, past or through a clamp 30 mm high; it starts and ends
/// away from the clamp.
Checked rapid_at(double y, double z = 2.5) {
    const SetupWriter setup =
        SetupWriter().fixture("clamp-1", "box = [[40, 104, -30], [60, 130, 30]]");
    return check(setup, program({fmt::format("G0 X-20. Y{:.3f}", y), fmt::format("Z{:.3f}", z),
                                 "X120.", "Z60."}));
}

TEST(Cure, OfARapidNearAClampWasTried) {
    const FindingLine finding = rapid_at(98.0).finding("rapid-near-clamp");
    EXPECT_EQ(finding.line, 8);
    EXPECT_NEAR(number_after(finding.cure, "at least "), 1.0, 0.002); // Y97: 2 mm from Y104
    EXPECT_NE(finding.cure.find("towards Y- (tried: this block then keeps 2.0"), std::string::npos)
        << finding.cure;
    EXPECT_EQ(rapid_at(98.0 - number_after(finding.cure, "at least ")).errors(), "");
    EXPECT_NE(rapid_at(98.0 - number_after(finding.cure, "at least ") + 0.01).errors(), "");
}

TEST(Cure, OfARapidThroughAClampIsTheSmallestShiftThatClearsTheBlock) {
    const FindingLine finding = rapid_at(110.0).finding("collision");
    EXPECT_EQ(finding.line, 8);
    // The tool must get 2 mm away from the clamp: to Y97 or to Z32.
    EXPECT_NEAR(number_after(finding.cure, "at least "), 13.0, 0.02);
    EXPECT_NE(finding.cure.find("towards Y-"), std::string::npos) << finding.cure;
    EXPECT_EQ(rapid_at(110.0 - number_after(finding.cure, "at least ")).errors(), "");
    // The overlap itself: 11 mm sideways.
    EXPECT_NE(finding.message.find("The overlap is 11.0"), std::string::npos) << finding.message;
    EXPECT_NE(finding.message.find("towards Y-."), std::string::npos) << finding.message;
}

/// A plunge next to a jaw that stands 10 above the stock: only a tool that cuts nothing clears it.
TEST(Cure, OfAFeedDoesNotLiftItOutOfItsCut) {
    const SetupWriter setup =
        SetupWriter().fixture("jaw", "box = [[-40, 97, -60], [140, 130, 10]]");
    const FindingLine finding =
        check(setup, program({"G0 X50. Y97.", "Z20.", "G1 Z-15. F200.", "G0 Z60."}))
            .finding("collision");
    EXPECT_EQ(finding.cure.find("towards Z+"), std::string::npos) << finding.cure;
    // Beside the stock there is nothing to cut, so the shift away is offered there.
    const FindingLine in_air =
        check(setup, program({"G0 X-20. Y91.", "Z20.", "G1 Z5. F200.", "X-15.", "G0 Z60."}))
            .finding("near-miss");
    EXPECT_NE(in_air.cure.find("tried"), std::string::npos) << in_air.cure;
}

TEST(Cure, OfACycleThatBeginsInTheStockTellsHowDeepItsRapidIs) {
    const SetupWriter setup =
        SetupWriter().also_tool("number = 2\nshape = \"drill\"\ndiameter = 8\nflute_length = 40\n"
                                "shank = [[8, 8, 20]]\nholder = [[32, 32, 60]]\n");
    const FindingLine finding =
        check(setup, "O1\nG21 G17 G90 G40 G80 G54\nT2 M6\nS3000 M3\nG0 X50. Y50.\nG43 H2 Z60.\n"
                     "G98 G83 Z-20. R-3. Q4. F150.\nG80\nM30\n")
            .finding("rapid-in-stock");
    EXPECT_EQ(finding.line, 7);
    EXPECT_NEAR(number_after(finding.message, " to "), 3.0, 0.4) << finding.message;
    EXPECT_EQ(finding.cure, "Raise the plane from which the cycle feeds and to which it retracts.");
}

TEST(Cure, OfAShiftIntoTheWallNamesTheShift) {
    const FindingLine finding =
        check(SetupWriter(), program({"G0 X50. Y50.", "G98 G76 Z-10. R2. Q3. F100.", "G80"}))
            .finding("rapid-in-stock");
    EXPECT_NE(finding.cure.find("the amount and the direction of the shift"), std::string::npos)
        << finding.cure;
}

TEST(Cure, OfARapidThroughTheStockIsAHeightThatWasTried) {
    const auto across = [](double z) {
        return check(SetupWriter(),
                     program({"G0 X-20. Y50.", fmt::format("Z{:.3f}", z), "X120.", "Z60."}));
    };
    const FindingLine finding = across(-3.0).finding("rapid-in-stock");
    const double higher = number_after(finding.cure, "Rapid at least ");
    EXPECT_NEAR(higher, 3.5, 0.02);
    EXPECT_EQ(across(-3.0 + higher).errors(), "");
}

/// A deep pocket, then a rapid out of it and sideways. The holder is in the wall at its end.
TEST(Cure, OfARapidThatBeginsInTheWallNamesTheBlockBefore) {
    const Checked checked =
        check(SetupWriter(),
              program({"G0 X50. Y50.", "Z2.", "G1 Z-50. F200.", "G0 Z4.", "X90.", "Z60."}));
    const FindingLine finding = checked.finding("rapid-in-stock");
    EXPECT_EQ(finding.line, 9);
    EXPECT_EQ(finding.cure, "Correct the block before it: the holder is in the stock already where "
                            "this rapid begins.");
}

TEST(LowRetract, IsOneThatPassesOverTheStockByLessThanHalfAMillimetre) {
    const auto across_the_face = [](const std::string& z) {
        return check(SetupWriter(), program({"G0 X-20. Y50.", "Z-3.", "G1 X10. F800.", "X-20.",
                                             "G0 Z" + z, "X120.", "Z60."}));
    };
    EXPECT_EQ(across_the_face("0.3").of_severity("warning"), "low-retract 11");
    EXPECT_EQ(across_the_face("0.3").errors(), "");
    EXPECT_EQ(across_the_face("0.6").of_severity("warning"), "");
}

/// The subjects of the air-cut notes of a program.
std::string air_cuts(const std::vector<std::string>& lines) {
    const Checked checked = check(SetupWriter(), program(lines));
    std::string found;
    for (const FindingLine& finding : checked.findings)
        if (finding.rule == "air-cut")
            found += (found.empty() ? "" : ", ") + std::to_string(finding.line.value_or(0));
    return found;
}

TEST(AirCut, IsOneNoteForASeries) {
    EXPECT_EQ(air_cuts({"G0 X-20. Y50.", "Z5.", "G1 X120. F800.", "Y60.", "X-20.", "G0 Z60."}),
              "8");
}

TEST(AirCut, IsNoSpringPassAndNoLeadIn) {
    EXPECT_EQ(air_cuts({"G0 X-20. Y50.", "Z-5.", "G1 X120. F800.", "X-20.", "X120.", "G0 Z60."}),
              "");
    EXPECT_EQ(air_cuts({"G0 X-60. Y50.", "Z-5.", "G1 X-20. F800.", "X120.", "G0 Z60."}), "");
}

} // namespace
} // namespace app_test
