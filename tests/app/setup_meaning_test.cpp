#include <cmath>

#include <gtest/gtest.h>

#include "tests/app/checked.h"
#include "tests/support/program_writer.h"

namespace app_test {
namespace {

using test_support::flat_10;
using test_support::program;
using test_support::SetupWriter;

const std::string slot = program({"G0 X-20. Y50.", "Z-5.", "G1 X120. F800.", "G0 Z60."});

/// From the flutes to the clamp X40..60 Y104..130 Z-30..12 along the slot: 104 - 55.
constexpr double to_clamp = 49.0;

void expect_clamp_in_place(const SetupWriter& setup) {
    const BlockLine block = check(setup, slot).at_line(8);
    expect_encloses(block.pair("flutes clamp"), to_clamp, 1e-6);
    // Horizontally to Y104 and, from the rim of the shank at Z15, down to Z12.
    expect_encloses(block.pair("shank clamp"), std::hypot(49.0, 3.0), 1e-6);
    expect_encloses(block.pair("holder clamp"), std::hypot(34.0, 28.0), 1e-6);
    // The clamp ends at X60: from its corner to the side of the flutes at X120 Y50, on the way up.
    EXPECT_GT(block.pair("flutes clamp").at.value_or(-1.0), 59.9 / 140.0);
    EXPECT_LT(block.pair("flutes clamp").at.value_or(-1.0), 80.1 / 140.0);
}

TEST(Frame, OfABodyIsTheWorkOffsetUnlessItSaysOtherwise) {
    expect_clamp_in_place(SetupWriter().fixture("clamp", "box = [[40, 104, -30], [60, 130, 12]]"));
    expect_clamp_in_place(
        SetupWriter().fixture("clamp", "box = [[0, 0, 0], [20, 26, 42]]\nat = [40, 104, -30]"));
}

TEST(Frame, MayBeTheMachine) {
    expect_clamp_in_place(SetupWriter().fixture(
        "clamp", "box = [[-310, -96, -450], [-290, -70, -408]]\nframe = \"machine\""));
}

TEST(Frame, MayBeAnotherWorkOffset) {
    expect_clamp_in_place(
        SetupWriter()
            .offsets("G54 = { X = -350, Y = -200, Z = -420 }\n"
                     "G55 = { X = -360, Y = -210, Z = -400 }\n")
            .fixture("clamp", "box = [[50, 114, -50], [70, 140, -8]]\nframe = \"G55\""));
}

TEST(Frame, MayBeARotatedBody) {
    // The plate's X runs along Y, its Y along -X.
    expect_clamp_in_place(
        SetupWriter()
            .fixture("plate", "box = [[0, 0, 0], [1, 1, 1]]\nat = [300, 100, -30]\n"
                              "rotate_deg = [0, 0, 90]")
            .fixture("clamp", "box = [[4, 240, 0], [30, 260, 42]]\nframe = \"plate\""));
}

TEST(Frame, OfTheStockMovesTheStockOnly) {
    // The same slot, half of it in the air: in G55 the stock is 50 farther along X.
    const SetupWriter setup = SetupWriter()
                                  .offsets("G54 = { X = -350, Y = -200, Z = -420 }\n"
                                           "G55 = { X = -300, Y = -200, Z = -420 }\n")
                                  .stock("box = [[0, 0, -30], [100, 100, 0]]\nframe = \"G55\"\n")
                                  .fixture("clamp", "box = [[40, 104, -30], [60, 130, 12]]");
    const BlockLine block = check(setup, slot).at_line(8);
    expect_encloses(block.pair("flutes clamp"), to_clamp, 1e-6);
    // From X50 to the side of the tool at X125: a half circle of the flutes ends the slot.
    EXPECT_NEAR(block.removed, (70.0 * 10.0 + std::acos(-1.0) * 12.5) * 5.0, 8.0);
}

TEST(Placement, TurnsAboutXThenYThenZ) {
    // A bar along Z: rotating it by 90 about X takes it to -Y, then by 90 about Z to +X.
    const SetupWriter setup = SetupWriter().fixture(
        "clamp", "box = [[-13, -10, 0], [13, 10, 20]]\nrotate_deg = [90, 0, 90]\n"
                 "at = [40, 117, 2]");
    const BlockLine block = check(setup, slot).at_line(8);
    expect_encloses(block.pair("flutes clamp"), to_clamp, 1e-6);
}

TEST(Placement, OfACylinderIsTheSameAlongAnyAxis) {
    for (const char* axis : {"Z", "X"}) {
        const SetupWriter setup =
            SetupWriter().fixture("clamp", std::string("cylinder = { radius = 10, height = 20, "
                                                       "axis = \"")
                                               + axis + "\" }\nat = [40, 114, 0]");
        const BlockLine block = check(setup, slot).at_line(8);
        expect_encloses(block.pair("flutes clamp"), to_clamp, 1e-6);
    }
}

TEST(Tolerance, OfTheStockWidensTheDoubtAndNotTheMaterial) {
    const Checked checked =
        check(SetupWriter().stock("box = [[0, 0, -30], [100, 100, 0]]\ntolerance = 2\n"), slot);
    EXPECT_EQ(checked.status, 0);
    const PairLine pair = checked.at_line(7).pair("flutes stock");
    EXPECT_NEAR(pair.lower, 13.0, 0.01);
    EXPECT_NEAR(*pair.upper, 15.0, 0.01);
    EXPECT_NEAR(checked.at_line(8).removed, 5000.0, 1.0);
}

TEST(Tolerance, OfTheStockMakesARapidJustAboveItUndecided) {
    const std::string low = program({"G0 X-20. Y50.", "Z1.", "X120.", "Z60."});
    EXPECT_EQ(check(SetupWriter(), low).status, 0);
    const Checked checked =
        check(SetupWriter().stock("box = [[0, 0, -30], [100, 100, 0]]\ntolerance = 2\n"), low);
    EXPECT_EQ(checked.status, 1);
    EXPECT_EQ(checked.verdict, "undecided");
    EXPECT_EQ(checked.errors(), "undecided 8");
}

TEST(LengthOffset, ShorterThanTheToolPutsItIntoTheStock) {
    const std::string above = program({"G0 X-20. Y50.", "Z5.", "X120.", "Z60."});
    EXPECT_EQ(check(SetupWriter(), above).status, 0);
    const SetupWriter wrong = SetupWriter().lengths("[[length_offset]]\nnumber = 1\nlength = 85\n");
    const Checked checked = check(wrong, above);
    EXPECT_EQ(checked.status, 1);
    EXPECT_EQ(checked.verdict, "collision");
    EXPECT_EQ(checked.errors(), "rapid-in-stock 8");
    EXPECT_NEAR(checked.at_line(8).removed, 5000.0, 1.0); // 5 deep instead of 5 above
}

TEST(LengthOffset, CountsItsWear) {
    const SetupWriter worn =
        SetupWriter().lengths("[[length_offset]]\nnumber = 1\nlength = 95\nwear = -10\n");
    const Checked checked = check(worn, program({"G0 X-20. Y50.", "Z5.", "X120.", "Z60."}));
    EXPECT_EQ(checked.errors(), "rapid-in-stock 8");
}

TEST(LengthOffset, IsTheTrueLengthWhereTheTableSaysNothing) {
    const Checked checked =
        check(SetupWriter().lengths(""), program({"G0 X-20. Y50.", "Z5.", "X120.", "Z60."}));
    EXPECT_EQ(checked.status, 0);
    expect_encloses(checked.at_line(8).pair("flutes stock"), 5.0, 0.5);
}

/// Flutes and shank pass the clamp at 1.5 mm, the holder far above it.
SetupWriter near_clamp() {
    return SetupWriter().fixture("clamp", "box = [[40, 104, -30], [60, 130, 12]]");
}
const std::string past_it = program({"G0 X-20. Y97.5", "Z2.5", "X120.", "Z60."});

std::string allowance(const std::string& between, const std::string& distance) {
    return "[[allowance]]\n" + (between.empty() ? "" : "between = " + between + "\n")
           + "distance = " + distance + "\n";
}

TEST(AllowanceRule, NamesABodyOrAKindInEitherOrder) {
    for (const char* between :
         {"[\"flutes\", \"clamp\"]", "[\"clamp\", \"flutes\"]", "[\"fixture\", \"flutes\"]"}) {
        EXPECT_EQ(check(near_clamp().also(allowance(between, "1.4")), past_it).status, 0)
            << between;
        const Checked more = check(near_clamp().also(allowance(between, "7")), past_it);
        EXPECT_EQ(more.status, 1) << between;
        EXPECT_EQ(more.at_line(8).pair("flutes clamp").allowance, 7.0) << between;
        EXPECT_EQ(more.at_line(8).pair("holder clamp").allowance, 2.0) << between;
    }
}

TEST(AllowanceRule, LeavesOtherPairsAlone) {
    EXPECT_EQ(check(near_clamp().also(allowance("[\"holder\", \"clamp\"]", "1")), past_it).status,
              1);
}

TEST(AllowanceRule, WithoutBetweenIsTheGeneralOne) {
    const Checked checked = check(near_clamp().also(allowance("", "1.4")), past_it);
    EXPECT_EQ(checked.status, 0);
    EXPECT_EQ(checked.at_line(8).pair("holder clamp").allowance, 1.4);
    EXPECT_EQ(checked.at_line(8).pair("holder stock").allowance, 1.4);
    EXPECT_EQ(checked.at_line(8).pair("flutes stock").allowance, 0.0);
}

TEST(AllowanceRule, ComesBeforeTheGeneralOneAndTheOption) {
    const SetupWriter setup =
        near_clamp().also(allowance("", "9") + allowance("[\"flutes\", \"fixture\"]", "1.2"));
    EXPECT_EQ(check(setup, past_it).at_line(8).pair("flutes clamp").allowance, 1.2);
    EXPECT_EQ(check(setup, past_it, {"--allowance", "3"}).at_line(8).pair("flutes clamp").allowance,
              1.2);
}

TEST(Rules, ChangeTheSeverityAndWithItTheExitStatus) {
    const auto with = [](const std::string& severity) {
        return check(near_clamp().also("[rules]\nrapid-near-clamp = \"" + severity + "\"\n"),
                     past_it);
    };
    EXPECT_EQ(with("error").status, 1);
    const Checked warned = with("warning");
    EXPECT_EQ(warned.status, 0);
    EXPECT_EQ(warned.of_severity("warning"), "rapid-near-clamp 8");
    EXPECT_EQ(warned.at_line(8).verdict, "violation");
    const Checked off = with("off");
    EXPECT_EQ(off.status, 0);
    EXPECT_TRUE(off.findings.empty());
    EXPECT_EQ(off.verdict, "violation"); // the rule is off, but the verdict stays
}

TEST(Tools, AreInTheSpindleFromTheStartIfTheProgramCallsNone) {
    const Checked checked = check(
        SetupWriter(), "G21 G90 G54\nS6000 M3\nG0 G43 H1 Z60.\nX-20. Y50.\nZ-5.\nX120.\nM30\n");
    EXPECT_EQ(checked.errors(), "rapid-in-stock 6");
}

} // namespace
} // namespace app_test
