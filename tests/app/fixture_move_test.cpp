#include <gtest/gtest.h>

#include "app/session/m_codes.h"
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
    // The post now begins at Y65: 15 less the tool's 5 away.
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

TEST(MCodes, AreFoundOutsideOfComments) {
    EXPECT_TRUE(app::has_m_code("N10 G0 X1 M61", 61));
    EXPECT_TRUE(app::has_m_code("m061", 61));
    EXPECT_FALSE(app::has_m_code("M6 (M61)", 61));
    EXPECT_FALSE(app::has_m_code("M6 ; M61", 61));
    EXPECT_FALSE(app::has_m_code("M610", 61));
}

} // namespace
} // namespace app_test
