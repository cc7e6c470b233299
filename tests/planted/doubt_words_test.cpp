#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/base/text.h"
#include "tests/app/checked.h"
#include "tests/support/program_writer.h"

namespace app_test {
namespace {

using test_support::program;
using test_support::SetupWriter;
using testing::HasSubstr;
using testing::Not;

FindingLine undecided_in(const Checked& checked) { return checked.finding("undecided"); }

TEST(CureOfDoubt, NamesTheCornersThatTheControlRounds) {
    const SetupWriter rounded =
        SetupWriter()
            .machine("rapid = \"straight\"\ncorner_tolerance = 2\n" + SetupWriter::mill())
            .fixture("clamp-1", "box = [[58, 40, -10], [70, 60, 10]]\n");
    const FindingLine shown_assumptions = undecided_in(
        check(rounded, program({"G0 X-20. Y50.", "Z-5.", "G1 X50. F800.", "Y120.", "G0 Z60."})));
    EXPECT_THAT(shown_assumptions.cure, HasSubstr("round corners by 2 mm"));
    EXPECT_THAT(shown_assumptions.cure, Not(HasSubstr("mesh")));
}

TEST(CureOfDoubt, NamesTheToleranceOfTheStock) {
    const std::vector<std::string> over = {"G0 X-20. Y50.", "Z0.5", "X120.", "Z60."};
    const std::string box = "box = [[0, 0, -30], [100, 100, 0]]\n";
    const FindingLine shown_assumptions =
        undecided_in(check(SetupWriter().stock(box + "tolerance = 1.0\n"), program(over)));
    EXPECT_THAT(shown_assumptions.cure, HasSubstr("`tolerance` of [stock], or"));
    EXPECT_THAT(shown_assumptions.cure, Not(HasSubstr("mesh")));
    EXPECT_EQ(check(SetupWriter().stock(box), program(over)).errors(), "");
}

// A plate that is cut out in one pass.

TEST(CutThrough, WithARetractOutOfItIsPlausible) {
    const SetupWriter thin = SetupWriter().stock("box = [[-10, -10, -6], [110, 90, 0]]\n");
    const auto cut_out = [&](const std::string& between) {
        std::vector<std::string> lines = {"G0 X-10. Y-8.", "Z2."};
        if (!between.empty()) lines.push_back(between);
        for (const char* line :
             {"G1 Z-6.5 F300.", "X108. F500.", "Y88.", "X-8.", "Y-8.", "G0 Z60."})
            lines.emplace_back(line);
        return check(thin, program(lines)).of_severity("warning");
    };
    EXPECT_THAT(cut_out(""), Not(HasSubstr("offset-implausible")));
    EXPECT_THAT(cut_out("G0 Z-3."), HasSubstr("offset-implausible"));
}

// Layout.

TEST(Clipped, KeepsCharactersWhole) {
    const std::string text = "\u4e2d\u6587\u4e2d\u6587\u4e2d\u6587"; // 3 bytes each
    EXPECT_EQ(app::clipped(text, 18), text);
    for (const size_t width : {11U, 10U, 9U})
        EXPECT_EQ(app::clipped(text, width), "\u4e2d\u6587...");
    EXPECT_EQ(app::clipped(text, 12), "\u4e2d\u6587\u4e2d...");
    EXPECT_EQ(app::clipped("abcdefgh", 6), "abc...");
}

TEST(TextReport, WrapsTheTightestBlock) {
    const test_support::ScopedFolder folder;
    const SetupWriter setup = SetupWriter().fixture(
        "a very long name of a clamp that somebody thought up on a Friday afternoon before going",
        "box = [[40, 104, -30], [60, 130, 12]]\n");
    const auto file = folder.write("s.toml", setup.text());
    const auto ran = feeler(
        {"check", folder.write("p.nc", program({"G0 X50. Y110.", "Z20."})), "--setup", file});
    ASSERT_THAT(ran.out, HasSubstr("  tightest   line"));
    const std::string behind = ran.out.substr(ran.out.find("  tightest"));
    EXPECT_LE(behind.find('\n'), 80U);
    EXPECT_THAT(behind, HasSubstr("\n             "));
}

TEST(TextReport, NamesTheBlockWithTheWorstVerdictAsTheTightest) {
    // The cut in line 8 is in contact as intended; the rapid in line 11 is not.
    const test_support::ScopedFolder folder;
    const auto ran = feeler({"check",
                             folder.write("p.nc", program({"G0 X50. Y50.", "Z2.", "G1 Z-2. F300.",
                                                           "G0 Z60.", "X20.", "Z-1.", "Z60."})),
                             "--setup", folder.write("s.toml", SetupWriter().text())});
    EXPECT_THAT(ran.out, HasSubstr("  tightest   line 11: flutes / stock, 0.000 mm"));
}

TEST(TextReport, NamesARealClearanceAsTheTightestBeforePermittedContact) {
    // The retract in line 10 leaves its own slot; the slot passes the clamp at 3 mm.
    const test_support::ScopedFolder folder;
    const std::string lines = program({"G0 X50. Y95.", "Z2.", "G1 Z-2. F300.", "G0 Z20.", "Z60."});
    const auto near = feeler({"check", folder.write("p.nc", lines), "--setup",
                              folder.write("s.toml", SetupWriter()
                                                         .fixture("clamp-1", "box = [[40, 103, "
                                                                             "-30], [60, 130, 1]]")
                                                         .text())});
    EXPECT_THAT(near.out, HasSubstr("flutes / clamp-1, 3.000 mm (minimum 2.000 mm)"));
    EXPECT_THAT(near.out, Not(HasSubstr("flutes / stock, 0.000 mm")));
}

} // namespace
} // namespace app_test
