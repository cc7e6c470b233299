#include <cmath>

#include <gtest/gtest.h>

#include "tests/app/checked.h"
#include "tests/support/program_writer.h"

namespace app_test {
namespace {

using test_support::flat_10;
using test_support::program;
using test_support::SetupWriter;

constexpr double exact = 1e-6;
constexpr double mesh_size = 0.5;

/// A slot at Z-5 along Y50, from X-20 to X120 on line 8: the holder passes 40 above the stock.
const std::string slot = program({"G0 X-20. Y50.", "Z-5.", "G1 X120. F800.", "G0 Z60."});

/// A clamp next to the slot, up to Z45, with its near side at this Y.
SetupWriter with_clamp_from(const std::string& y) {
    return SetupWriter().fixture("clamp-1", "box = [[40, " + y + ", -30], [60, 104, 45]]");
}

TEST(HolderNextToAClamp, CollidesWhenTheClampIsInItsPath) {
    const Checked checked = check(with_clamp_from("65"), slot);
    EXPECT_EQ(checked.status, 1);
    EXPECT_EQ(checked.verdict, "collision");
    EXPECT_EQ(checked.errors(), "holder-into-wall 8");
    const PairLine pair = checked.at_line(8).deciding;
    EXPECT_EQ(pair.name, "holder clamp-1");
    expect_encloses(pair, 0.0, 0.0);
    // The holder's circle reaches the corner at X40 Y65 when its centre is sqrt(20^2 - 15^2) away.
    EXPECT_NEAR(*pair.at, (60.0 - std::sqrt(175.0)) / 140.0, 1e-4);
}

TEST(HolderNextToAClamp, IsTooNearBelowTwoMillimetres) {
    const Checked checked = check(with_clamp_from("71.5"), slot);
    EXPECT_EQ(checked.status, 1);
    EXPECT_EQ(checked.verdict, "violation");
    EXPECT_EQ(checked.errors(), "near-miss 8");
    EXPECT_EQ(checked.at_line(8).deciding.name, "holder clamp-1");
    expect_encloses(checked.at_line(8).deciding, 1.5, exact);
}

TEST(HolderNextToAClamp, IsClearWithThreeMillimetres) {
    const Checked checked = check(with_clamp_from("73"), slot);
    EXPECT_EQ(checked.status, 0);
    EXPECT_EQ(checked.errors(), "");
    EXPECT_EQ(checked.at_line(8).deciding.name, "holder clamp-1");
    expect_encloses(checked.at_line(8).deciding, 3.0, exact);
}

/// A rapid along Y97.8 above the stock, past a clamp with its near side at Y104.
const SetupWriter low_clamp =
    SetupWriter().fixture("clamp-1", "box = [[40, 104, -30], [60, 130, 12]]");

TEST(RapidPastAClamp, IsReportedWithItsDistance) {
    const Checked checked = check(low_clamp, program({"G0 X-20. Y97.8", "Z2.5", "X120.", "Z60."}));
    EXPECT_EQ(checked.status, 1);
    EXPECT_EQ(checked.errors(), "rapid-near-clamp 8");
    EXPECT_EQ(checked.at_line(8).verdict, "violation");
    EXPECT_EQ(checked.at_line(8).deciding.name, "flutes clamp-1");
    expect_encloses(checked.at_line(8).deciding, 1.2, exact);
    expect_encloses(checked.at_line(8).pair("flutes stock"), 2.5, mesh_size);
}

TEST(RapidPastAClamp, IsClearFartherAway) {
    const Checked checked = check(low_clamp, program({"G0 X-20. Y96.5", "Z2.5", "X120.", "Z60."}));
    EXPECT_EQ(checked.status, 0);
    EXPECT_EQ(checked.errors(), "");
    expect_encloses(checked.at_line(8).pair("flutes clamp-1"), 2.5, exact);
}

TEST(RapidThroughTheStock, IsOneCollision) {
    const Checked checked =
        check(SetupWriter(), program({"G0 X-20. Y50.", "Z-5.", "X120.", "X-20.", "Z60."}));
    EXPECT_EQ(checked.status, 1);
    EXPECT_EQ(checked.verdict, "collision");
    EXPECT_EQ(checked.errors(), "rapid-in-stock 8"); // the return move is clear
    EXPECT_EQ(checked.at_line(8).deciding.name, "flutes stock");
    expect_encloses(checked.at_line(8).deciding, 0.0, 0.0);
    EXPECT_NEAR(checked.at_line(8).removed, 5000.0, 1.0);
}

TEST(RapidThroughTheStock, IsClearAboveIt) {
    const Checked checked =
        check(SetupWriter(), program({"G0 X-20. Y50.", "Z0.5", "X120.", "Z60."}));
    EXPECT_EQ(checked.status, 0);
    EXPECT_EQ(checked.errors(), "");
    expect_encloses(checked.at_line(8).deciding, 0.5, 1e-3);
}

TEST(RapidThroughTheStock, IsACollisionForAPointAndForATinyTool) {
    const std::pair<std::string, std::string> tools[] = {
        {"shape = \"taper\"\ndiameter = 6\nangle_deg = 5\nflute_length = 20\nshank = [[6, 6, "
         "75]]\n",
         "-0.3"},
        {"shape = \"taper\"\ndiameter = 6\nangle_deg = 15\nflute_length = 10\nshank = [[6, 6, "
         "85]]\n",
         "-0.12"},
        {"shape = \"taper\"\ndiameter = 6\nangle_deg = 30\nflute_length = 5\nshank = [[6, 6, "
         "90]]\n",
         "-0.08"},
        {"shape = \"flat\"\ndiameter = 0.1\nflute_length = 5\nshank = [[6, 6, 90]]\n", "-1."},
        {"shape = \"flat\"\ndiameter = 0.05\nflute_length = 5\nshank = [[6, 6, 90]]\n", "-1."},
    };
    for (const auto& [tool, depth] : tools) {
        const SetupWriter setup = SetupWriter().tool("number = 1\n" + tool);
        const std::string z = "Z" + depth;
        const Checked rapid = check(setup, program({"G0 X-20. Y50.", z, "X120.", "Z60."}));
        EXPECT_EQ(rapid.verdict, "collision") << tool;
        EXPECT_EQ(rapid.errors(), "rapid-in-stock 8") << tool;
        const Checked groove = check(setup, program({"G0 X-20. Y50.", z, "G1 X120. F800.",
                                                     "G0 X-20.", "G1 X40. Y60.", "G0 Z60."}));
        EXPECT_EQ(groove.errors(), "") << tool; // back through its own groove is contact only
        EXPECT_EQ(groove.verdict, "clear") << tool;
    }
}

TEST(FeedIntoTheStock, IsACollisionWithTheSpindleOffOrTurningTheWrongWay) {
    for (const char* spindle : {"M5", "S6000 M4", "S0 M3", "M3"}) {
        const Checked checked =
            check(SetupWriter(),
                  program({"G0 X-20. Y50.", "Z-5.", "G1 X120. F800.", "G0 Z60."}, spindle));
        EXPECT_EQ(checked.status, 1) << spindle;
        EXPECT_EQ(checked.errors(), "spindle-off 8") << spindle;
        EXPECT_EQ(checked.at_line(8).verdict, "collision") << spindle;
        EXPECT_EQ(checked.at_line(8).deciding.name, "flutes stock") << spindle;
    }
}

TEST(FeedIntoTheStock, IsCuttingForALeftHandToolThatTurnsLeft) {
    const Checked checked =
        check(SetupWriter().tool(flat_10 + "spindle = \"counterclockwise\"\n"),
              program({"G0 X-20. Y50.", "Z-5.", "G1 X120. F800.", "G0 Z60."}, "S6000 M4"));
    EXPECT_EQ(checked.status, 0);
    EXPECT_EQ(checked.errors(), "");
}

/// Two passes along one slot; the second one at the given depth. The holder, radius 20, starts 25
/// above the tip and passes over both walls.
Checked deep_slot(const std::string& depth) {
    const std::string short_tool = "number = 1\nshape = \"flat\"\ndiameter = 10\n"
                                   "flute_length = 20\nshank = [[10, 10, 5]]\n"
                                   "holder = [[40, 40, 70]]\n";
    return check(SetupWriter().tool(short_tool),
                 program({"G0 X-40. Y50.", "Z-12.", "G1 X140. F800.", "G0 Z60.", "X-40.",
                          "Z-" + depth, "G1 X140.", "G0 Z60."}));
}

TEST(HolderOverAWall, IsTooNearBelowOneMillimetre) {
    const Checked checked = deep_slot("24.3");
    EXPECT_EQ(checked.status, 1);
    EXPECT_EQ(checked.verdict, "violation");
    EXPECT_EQ(checked.errors(), "near-miss 12, stick-out-short 12");
    const PairLine pair = checked.at_line(12).pair("holder stock");
    EXPECT_EQ(pair.allowance, 1.0);
    expect_encloses(pair, 0.7, mesh_size);
    EXPECT_EQ(checked.at_line(12).pair("shank stock").verdict, "clear");
}

TEST(HolderOverAWall, IsClearFromOneMillimetreOn) {
    const Checked checked = deep_slot("24.");
    EXPECT_EQ(checked.status, 0);
    EXPECT_EQ(checked.errors(), "");
    expect_encloses(checked.at_line(12).pair("holder stock"), 1.0, mesh_size);
}

TEST(HolderOverAWall, CollidesWhereItReachesTheTop) {
    const Checked checked = deep_slot("26.");
    EXPECT_EQ(checked.status, 1);
    EXPECT_EQ(checked.errors(), "holder-into-wall 12, stick-out-short 12");
    EXPECT_EQ(checked.at_line(12).verdict, "collision");
    EXPECT_EQ(checked.at_line(12).deciding.name, "holder stock");
}

TEST(ShankInTheStock, CollidesWhereTheFlutesAreShorterThanTheCut) {
    // Flutes up to Z-5 in one pass: the shank meets the uncut stock when its side is at X0.
    const Checked checked =
        check(SetupWriter(), program({"G0 X-20. Y50.", "Z-25.", "G1 X120. F800.", "G0 Z60."}));
    EXPECT_EQ(checked.status, 1);
    EXPECT_EQ(checked.errors(), "collision 8, stick-out-short 8");
    EXPECT_EQ(checked.of_severity("warning"), "over-engagement 8");
    EXPECT_EQ(checked.at_line(8).deciding.name, "shank stock");
    EXPECT_NEAR(*checked.at_line(8).deciding.at, 15.0 / 140.0, mesh_size / 140.0);
}

TEST(ShankInTheStock, CollidesAboveARoundToolOfShortFlutes) {
    // At Z-8 the flutes end at Z-1 or Z-1.5; above them is a shank that is wider than the slot.
    for (const char* tool :
         {"shape = \"ball\"\ndiameter = 12\nflute_length = 7\nshank = [[24, 24, 88]]\n",
          "shape = \"bull\"\ndiameter = 20\ncorner_radius = 6\nflute_length = 6.5\n"
          "shank = [[24, 24, 88.5]]\n"}) {
        const Checked checked =
            check(SetupWriter().tool("number = 1\n" + std::string(tool)),
                  program({"G0 X-20. Y50.", "Z-8.", "G1 X120. F800.", "G0 Z60."}));
        EXPECT_EQ(checked.verdict, "collision") << tool;
        EXPECT_EQ(checked.errors(), "collision 8, stick-out-short 8") << tool;
        EXPECT_EQ(checked.at_line(8).deciding.name, "shank stock") << tool;
    }
}

TEST(Collision, IsNotSilencedByTheRuleThatNamesIt) {
    for (const char* rule : {"rapid-in-stock", "rapid-near-clamp", "holder-into-wall"}) {
        const Checked checked =
            check(SetupWriter().also("[rules]\n" + std::string(rule) + " = \"off\"\n"),
                  program({"G0 X-20. Y50.", "Z-5.", "X120.", "Z60."}));
        EXPECT_EQ(checked.status, 1) << rule;
        EXPECT_EQ(checked.errors(), "rapid-in-stock 8") << rule;
    }
}

TEST(FromAnUnknownPosition, AProgramOfWhichNoMotionCouldBeJudgedIsNotPassed) {
    const Checked checked = check(SetupWriter().program("dialect = \"fanuc\"\n").without_machine(),
                                  program({"G0 X50.", "Z-10.", "Z60."}));
    EXPECT_EQ(checked.status, 1);
    EXPECT_EQ(checked.verdict, "undecided");
    EXPECT_NE(checked.errors().find("undecided"), std::string::npos);
}

TEST(Fixture, IsNotCutUnlessItIsExpendable) {
    const std::string through = program({"G0 X-20. Y50.", "Z-5.", "G1 X150. F800.", "G0 Z60."});
    const std::string box = "box = [[110, 0, -30], [130, 100, 0]]\n";
    const Checked kept = check(SetupWriter().fixture("soft", box), through);
    EXPECT_EQ(kept.status, 1);
    EXPECT_EQ(kept.errors(), "collision 8");
    EXPECT_EQ(kept.at_line(8).deciding.name, "flutes soft");
    EXPECT_NEAR(*kept.at_line(8).deciding.at, 125.0 / 170.0, 1e-4);

    const Checked cut = check(SetupWriter().fixture("soft", box + "expendable = true"), through);
    EXPECT_EQ(cut.status, 0);
    EXPECT_EQ(cut.errors(), "");
}

TEST(ExpendableFixture, IsAsAnyOtherToARapidAndToTheShank) {
    const SetupWriter setup =
        SetupWriter().fixture("soft", "box = [[110, 0, -30], [130, 100, 0]]\nexpendable = true");
    const Checked rapid = check(setup, program({"G0 X150. Y50.", "Z-5.", "X120.", "Z60."}));
    EXPECT_EQ(rapid.errors().substr(0, 11), "collision 8");
    EXPECT_EQ(rapid.at_line(8).pair("flutes soft").verdict, "collision");
    const Checked deep =
        check(setup, program({"G0 X150. Y50.", "Z-25.", "G1 X120. F800.", "G0 Z60."}));
    EXPECT_EQ(deep.at_line(8).pair("shank soft").verdict, "collision");
}

} // namespace
} // namespace app_test
