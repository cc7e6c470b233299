#include <gtest/gtest.h>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/library/result/program_diff.h"
#include "tests/support/scoped_folder.h"
#include "tests/support/setup_writer.h"

namespace {

using app::CheckRun;
using app::ProgramDiff;
using test_support::ScopedFolder;
using test_support::SetupWriter;

/// A post next to the stock, 20 mm high from Z0, 10 from the edge at X 100.
SetupWriter beside_post(double x = 110.0) {
    const std::string low = std::to_string(x), high = std::to_string(x + 20.0);
    return SetupWriter()
        .also("[control]\n\"5006#6\" = 1\n")
        .fixture("post", "box = [[" + low + ", 0, -30], [" + high + ", 100, 20]]");
}

CheckRun checked(const ScopedFolder& folder, const std::string& program, const SetupWriter& setup) {
    app::CheckJob job;
    job.program = folder.write("a.nc", program);
    job.setup = folder.write("a.toml", setup.text());
    job.mesh_size = 2.0;
    auto run = app::run_check(job);
    if (!run) ADD_FAILURE() << run.error().file << ": " << run.error().message;
    return run ? *std::move(run) : CheckRun{};
}

ProgramDiff diff(const std::string& before, const std::string& after,
                 const SetupWriter& setup_before = beside_post(),
                 const SetupWriter& setup_after = beside_post()) {
    const ScopedFolder folder;
    const CheckRun a = checked(folder, before, setup_before);
    const CheckRun b = checked(folder, after, setup_after);
    return app::diff_of(a, b, "a.toml", "a.toml");
}

std::string program(const std::string& body) {
    return "G21 G90 G54 G17\nT1 M6\nG43 H1\nS3000 M3\nG0 X20 Y50\nG0 Z5\n" + body + "G0 Z50\nM2\n";
}

TEST(ProgramDiff, OfTheSameProgramIsEmpty) {
    const std::string text = program("G1 X80 F500\n");
    const ProgramDiff made = diff(text, text);
    EXPECT_TRUE(made.nearer.empty());
    EXPECT_TRUE(made.farther.empty());
    EXPECT_TRUE(made.added.empty());
    EXPECT_TRUE(made.removed.empty());
    EXPECT_EQ(made.same, 4u);
    EXPECT_EQ(made.change.longer, 0.0);
    EXPECT_FALSE(made.is_worse());
}

TEST(ProgramDiff, IsBlindToNumbersBlanksAndLines) {
    const ProgramDiff made = diff(program("G1 X80 F500\nG1 X60\n"),
                                  "\n\n" + program("N10 g1x80  f500\n\nN20 G1 X60 ; back\n"));
    EXPECT_EQ(made.same, 5u);
    EXPECT_TRUE(made.nearer.empty());
    EXPECT_TRUE(made.added.empty());
}

/// The flutes have a radius of 5 mm: at X 80 they are 25 from the post at 110, at X 95 they are 10.
TEST(ProgramDiff, PairsARewrittenBlockAndSaysHowMuchNearerItComes) {
    const ProgramDiff made = diff(program("G1 X80 F500\n"), program("G1 X95 F500\n"));
    ASSERT_FALSE(made.nearer.empty());
    const app::ChangedBlock& worst = made.nearer[0];
    EXPECT_EQ(worst.before.text, "G1 X80 F500");
    EXPECT_EQ(worst.after.text, "G1 X95 F500");
    EXPECT_NEAR(worst.nearer, 15.0, 1e-6);
    EXPECT_NEAR(*worst.after.upper, 10.0, 1e-6);
    EXPECT_EQ(worst.after.pair[1], "post");
    EXPECT_TRUE(made.farther.empty());
    EXPECT_FALSE(made.is_worse());
}

TEST(ProgramDiff, OfTheTwoTheOtherWayRoundIsTheMirrorImage) {
    const std::string a = program("G1 X80 F500\nG1 X40\n"), b = program("G1 X95 F500\nG1 X30\n");
    const ProgramDiff there = diff(a, b), back = diff(b, a);
    ASSERT_EQ(there.nearer.size(), back.farther.size());
    ASSERT_EQ(there.farther.size(), back.nearer.size());
    for (size_t i = 0; i < there.nearer.size(); ++i) {
        EXPECT_EQ(there.nearer[i].nearer, -back.farther[i].nearer);
        EXPECT_EQ(there.nearer[i].before.text, back.farther[i].after.text);
    }
    EXPECT_EQ(there.change.longer, -back.change.longer);
}

TEST(ProgramDiff, NamesBlocksThatCameAndWent) {
    const std::string with = program("G1 X80 F500\nG1 X60\n"), without = program("G1 X80 F500\n");
    const ProgramDiff grown = diff(without, with);
    ASSERT_EQ(grown.added.size(), 1u);
    EXPECT_EQ(grown.added[0].text, "G1 X60");
    EXPECT_TRUE(grown.removed.empty());
    const ProgramDiff shrunk = diff(with, without);
    ASSERT_EQ(shrunk.removed.size(), 1u);
    EXPECT_EQ(shrunk.removed[0].text, "G1 X60");
}

TEST(ProgramDiff, OfTwoSetupsComparesEveryBlock) {
    const std::string text = program("G1 X80 F500\n");
    const ProgramDiff made = diff(text, text, beside_post(), beside_post(100.0));
    ASSERT_FALSE(made.nearer.empty());
    EXPECT_EQ(made.nearer[0].after.text, "G1 X80 F500");
    EXPECT_NEAR(made.nearer[0].nearer, 10.0, 1e-6);
    EXPECT_EQ(made.nearer.size() + made.farther.size() + made.same, 4u);
}

TEST(ProgramDiff, IsWorseWhenAnErrorIsNew) {
    const ProgramDiff made = diff(program("G1 X80 F500\n"), program("G1 X104 F500\n"));
    EXPECT_TRUE(made.is_worse());
    ASSERT_FALSE(made.change.new_findings.empty());
    EXPECT_EQ(made.after.verdict, core::Verdict::violation);
    EXPECT_EQ(made.nearer[0].after.verdict, core::Verdict::violation);
    const ProgramDiff cured = diff(program("G1 X104 F500\n"), program("G1 X80 F500\n"));
    EXPECT_FALSE(cured.is_worse());
    EXPECT_FALSE(cured.change.gone_findings.empty());
}

/// 3 mm from the post: more than the minimum clearance of 2, but less than twice that.
TEST(ProgramDiff, IsWorseWhenABlockComesNearTheAllowance) {
    const ProgramDiff made = diff(program("G1 X80 F500\n"), program("G1 X102 F500\n"));
    EXPECT_EQ(made.after.verdict, core::Verdict::clear);
    EXPECT_TRUE(made.is_worse());
}

} // namespace
