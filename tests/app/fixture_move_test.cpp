#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/app/checked.h"
#include "tests/support/program_writer.h"

namespace app_test {
namespace {

using test_support::program;
using test_support::SetupWriter;

/// A post in the way of a rapid along X at Y50, 10 mm above the stock.
SetupWriter with_post(const std::string& moves) {
    return SetupWriter().fixture("post", "box = [[40, 45, 0], [60, 55, 20]]\n" + moves);
}

/// Line 6 is the first of these.
const std::string there_and_back = program({"G0 X-20. Y50.", "Z10.", "M61", "X120.", "Z60."});

TEST(FixtureMove, LeavesTheWayFreeFromTheMCodeOn) {
    EXPECT_EQ(check(with_post(""), there_and_back).verdict, "collision");
    const Checked away =
        check(with_post("[[fixture.move]]\ncode = \"M61\"\nremove = true\n"), there_and_back);
    EXPECT_EQ(away.errors(), "");
    const Checked beside =
        check(with_post("[[fixture.move]]\ncode = \"M61\"\nat = [0, 20, 0]\n"), there_and_back);
    EXPECT_EQ(beside.errors(), "");
    // The post now begins at Y65: 15 minus the tool radius of 5.
    expect_encloses(beside.at_line(9).pair("flutes post"), 10.0, 1e-6);
}

TEST(FixtureMove, CountsBeforeTheLineItNames) {
    const Checked away =
        check(with_post("[[fixture.move]]\nline = 9\nremove = true\n"), there_and_back);
    EXPECT_EQ(away.errors(), "");
    const Checked late =
        check(with_post("[[fixture.move]]\nline = 10\nremove = true\n"), there_and_back);
    EXPECT_EQ(late.verdict, "collision");
}

TEST(FixtureMove, ComesBackAndIsMetThere) {
    const std::string moves = "[[fixture.move]]\ncode = \"M61\"\nat = [0, 20, 0]\n"
                              "[[fixture.move]]\ncode = \"M62\"\nat = [0, 0, 0]\n";
    const Checked checked =
        check(with_post(moves),
              program({"G0 X-20. Y50.", "Z10.", "M61", "X120.", "M62", "X-20.", "Z60."}));
    EXPECT_NE(checked.at_line(9).verdict, "collision");
    EXPECT_EQ(checked.at_line(11).verdict, "collision");
}

TEST(FixtureMove, OntoTheToolIsFoundWhereItIsPut) {
    const Checked checked = check(with_post("[[fixture.move]]\nline = 8\nat = [-60, 0, 0]\n"),
                                  program({"G0 X-20. Y50.", "Z10.", "M61", "Z60."}));
    EXPECT_EQ(checked.at_line(8).pair("flutes post").verdict, "collision");
}

TEST(FixtureMove, ByACodeThatStopsComesAfterTheMotionOfItsBlock) {
    for (const std::string code : {"M0", "M1", "M60", "M61"}) {
        const std::string move = "[[fixture.move]]\ncode = \"" + code + "\"\nremove = true\n";
        const Checked checked =
            check(with_post(move), program({"G0 X-20. Y50.", "Z10.", "X120. " + code, "Z60."}));
        EXPECT_EQ(checked.at_line(8).verdict, "collision") << code;
    }
}

TEST(FixtureMove, IsCheckedAtBothPositionsIfTheBuilderDefinesTheOrder) {
    const std::string away = "[[fixture.move]]\ncode = \"M61\"\nat = [0, 0, 100]\n";
    const Checked checked =
        check(with_post(away), program({"G0 X-20. Y50.", "Z10.", "X120. M61", "Z60."}));
    EXPECT_EQ(checked.at_line(8).verdict, "collision");
}

TEST(FixtureMove, OfALineBeforeARestartHasBeenMade) {
    // Lines 6 to 8 are before the start; the post is moved out of the way, or stays there.
    const std::string text =
        program({"G0 X-20. Y50.", "(A LINE)", "M61", "N10 T1 M6", "G90 G54 G0 X-20. Y50. S6000 M3",
                 "G43 H1 Z10.", "X120.", "Z60."});
    for (const std::string when : {"line = 8", "code = \"M61\""}) {
        const std::string move = "[[fixture.move]]\n" + when + "\n";
        const Checked away =
            check(with_post(move + "remove = true\n"), text, {"--start-line", "N10"});
        EXPECT_EQ(away.at_line(12).verdict, "clear") << when;
        EXPECT_NE(std::find(away.assumptions.begin(), away.assumptions.end(),
                            "post has been moved, as stated in lines before the start"),
                  away.assumptions.end());
        const Checked beside =
            check(with_post(move + "at = [0, 0, 5]\n"), text, {"--start-line", "N10"});
        EXPECT_EQ(beside.at_line(12).verdict, "collision") << when;
    }
    const Checked later = check(with_post("[[fixture.move]]\nline = 12\nat = [0, 20, 0]\n"), text,
                                {"--start-line", "N10"});
    EXPECT_NE(later.at_line(12).verdict, "collision");
}

TEST(FixtureMove, ThatNoBlockMakesIsAnError) {
    // Line 8 is a comment; the program has seven more lines, and no M62.
    const std::string text = program({"G0 X-20. Y50.", "Z10.", "(MOVE THE POST)", "Z60."});
    for (const int line : {8, 99}) {
        const Checked checked = check(
            with_post(fmt::format("[[fixture.move]]\nline = {}\nremove = true\n", line)), text);
        EXPECT_EQ(checked.status, 1);
        EXPECT_EQ(checked.errors(), "fixture-move");
    }
    const Checked coded =
        check(with_post("[[fixture.move]]\ncode = \"M62\"\nremove = true\n"), text);
    EXPECT_EQ(coded.status, 0) << "one set-up may serve several programs";
}

} // namespace
} // namespace app_test
