#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "app/setup/program_settings.h"
#include "app/setup/setup_file.h"
#include "tests/app/checked.h"
#include "tests/support/program_writer.h"
#include "tests/support/scoped_folder.h"

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

/// A plate that moves with two posts on it, one of them on the other.
TEST(FixtureMove, TakesAlongWhatStandsInItsFrame) {
    const std::string moves = "[[fixture.move]]\ncode = \"M61\"\nat = [10, 130, -70]\nrotate_deg = "
                              "[0, 0, 90]\n[[fixture.move]]\nline = 11\nat = [0, 0, -70]\n";
    const auto with = [&](const std::string& low, const std::string& high) {
        return SetupWriter()
            .fixture("plate", "box = [[0, 0, 0], [100, 100, 5]]\nat = [0, 0, -70]\n" + moves)
            .fixture("low", "box = [[0, 0, 0], [10, 10, 70]]\n" + low)
            .fixture("high", "box = [[0, 0, 0], [10, 10, 15]]\n" + high);
    };
    const std::string text =
        program({"G0 X-20. Y50.", "Z10.", "M61", "X120.", "M5", "M3 S5000", "X-20.", "Z60."});
    const Checked carried = check(
        with("frame = \"plate\"\nat = [-50, 20, 5]\n", "frame = \"low\"\nat = [0, 0, 70]\n"), text);
    // The same by hand: turned by 90 degrees, [x, y] is at [10 - y, 130 + x].
    const Checked by_hand = check(
        with("at = [-50, 20, -65]\n[[fixture.move]]\ncode = \"M61\"\nat = [-10, 80, "
             "-65]\nrotate_deg "
             "= [0, 0, 90]\n[[fixture.move]]\nline = 11\nat = [-50, 20, -65]\n",
             "at = [-50, 20, 5]\n[[fixture.move]]\ncode = \"M61\"\nat = [-10, 80, 5]\nrotate_deg = "
             "[0, 0, 90]\n[[fixture.move]]\nline = 11\nat = [-50, 20, 5]\n"),
        text);
    ASSERT_EQ(carried.blocks.size(), by_hand.blocks.size());
    EXPECT_EQ(carried.errors(), by_hand.errors());
    for (size_t i = 0; i < carried.blocks.size(); ++i) {
        const BlockLine &a = carried.blocks[i], &b = by_hand.blocks[i];
        ASSERT_EQ(a.pairs.size(), b.pairs.size()) << a.line;
        for (size_t pair = 0; pair < a.pairs.size(); ++pair)
            EXPECT_NEAR(a.pairs[pair].lower, b.pairs[pair].lower, 1e-9) << a.line;
    }
    expect_encloses(carried.at_line(9).pair("flutes high"), 80.0 - 50.0 - 5.0, 1e-6);
}

TEST(FixtureMove, OfAFrameIsNotMixedWithMovesOfAFixtureInIt) {
    const auto error = [&](const std::string& move, const std::string& own) {
        const test_support::ScopedFolder folder;
        const SetupWriter setup =
            SetupWriter()
                .fixture("plate", "box = [[0, 0, -50], [9, 9, -45]]\n" + move)
                .fixture("post", "frame = \"plate\"\nbox = [[40, 45, 0], [60, 55, 20]]\n" + own);
        const auto read = app::read_setup(folder.write("s.toml", setup.text()), {});
        return read ? std::string() : read.error().message;
    };
    const std::string away = "[[fixture.move]]\ncode = \"M61\"\nremove = true\n";
    const std::string aside = "[[fixture.move]]\ncode = \"M61\"\nat = [0, 20, 0]\n";
    const std::string later = "[[fixture.move]]\ncode = \"M62\"\nat = [0, 20, 0]\n";
    EXPECT_NE(error(aside, later).find("takes it along"), std::string::npos);
    EXPECT_NE(error(aside + later, aside).find("takes it along"), std::string::npos);
    EXPECT_EQ(error(aside, aside), "");
    EXPECT_EQ(error(aside, aside + later), "");
    EXPECT_EQ(error(away, ""), "");
    EXPECT_EQ(error("", aside), "");
}

TEST(FixtureMove, RemovesWhatStandsInItsFrame) {
    const std::string away = "[[fixture.move]]\ncode = \"M61\"\nremove = true\n";
    const auto with = [](const std::string& move) {
        return SetupWriter()
            .fixture("plate", "box = [[0, 0, -70], [9, 9, -65]]\n" + move)
            .fixture("post", "frame = \"plate\"\nbox = [[40, 45, 0], [60, 55, 20]]\n");
    };
    EXPECT_EQ(check(with(""), there_and_back).verdict, "collision");
    EXPECT_EQ(check(with(away), there_and_back).errors(), "");
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
