#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/checked.h"

namespace app_test {
namespace {

using nlohmann::json;
using test_support::ScopedFolder;
using test_support::SetupWriter;

const std::string pocket = "%\nO1\n(T3 D=6. CR=0. - ZMIN=-5. - FLAT END MILL)\nG21 G90 G17 G54\n"
                           "T3 M6\nS5000 M3\nG0 G43 H3 Z20.\nX10. Y10.\nZ2.\nG1 Z-5. F200\n"
                           "X40. F600\nY30.\nX10.\nY10.\nG0 Z20.\nM5\nM30\n%\n";

struct Inferred {
    int status = -1;
    json report;
    std::string err;

    bool assumes(const std::string& words) const {
        for (const std::string each : report["assumptions"])
            if (each.find(words) != std::string::npos) return true;
        return false;
    }
};

Inferred infer(const std::string& program, const std::vector<std::string>& more = {},
               const std::string& name = "p.nc") {
    const ScopedFolder folder;
    std::vector<std::string> words = {"check", folder.write(name, program), "--format", "json"};
    words.insert(words.end(), more.begin(), more.end());
    const test_support::Ran ran = feeler(words);
    Inferred result{ran.status, json::parse(ran.out, nullptr, false), ran.err};
    EXPECT_FALSE(result.report.is_discarded()) << ran.err;
    return result;
}

TEST(InferredSetup, IsWhatTheProgramReaches) {
    const Inferred run = infer(pocket);
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(run.report["verdict"], "clear");
    EXPECT_TRUE(
        run.assumes("tool 3 is a flat end mill of 6 mm, according to the comment in line 3"));
    EXPECT_TRUE(
        run.assumes("X 7.000 to 43.000, Y 7.000 to 33.000, Z -7.000 (2 mm below the deepest "
                    "cut) to 0.000 (at Z0"));
    EXPECT_TRUE(run.assumes("no fixtures"));
    double removed = 0.0; // ring of 6 mm around a rectangle of 30 x 20, with rounded outer corners
    for (const json& block : run.report["blocks"]) removed += block.value("removed", 0.0);
    const double ring = 6.0 * 100.0 + 3.14159265 * 9.0 - 4.0 * 9.0;
    EXPECT_NEAR(removed, 5.0 * ring, 0.01 * 5.0 * ring);
}

TEST(InferredSetup, StillSeesARapidThroughMaterial) {
    std::string through = pocket;
    through.replace(through.find("G0 Z20.\nM5"), 7, "G0 X25. Y20.\nZ20.");
    const Inferred run = infer(through);
    EXPECT_EQ(run.status, 1);
    EXPECT_EQ(run.report["verdict"], "collision");
}

TEST(InferredSetup, PutsTheTopAtTheHighestCutWhenZeroIsBelow) {
    const Inferred run =
        infer("G21 G90\nM3 S1000\nG0 Z30\nG0 X0 Y0\nG1 Z12 F100\nX50\nZ4\nX0\nG0 Z30\n"
              "X5\nM2\n");
    EXPECT_TRUE(run.assumes("Z 2.000 (2 mm below the deepest cut) to 12.000 (at the highest cut)"));
    EXPECT_EQ(run.status, 0) << run.report.dump();
}

TEST(InferredSetup, TakesAnUnknownToolByItsUse) {
    const std::string head = "G21 G90\nT1 M6\nS1000 M3\nG43 H1 Z20\nG0 X5 Y5\n";
    const Inferred drill = infer(head + "G81 Z-9 R2 F100\nX15\nG80\nG0 Z20\nM2\n");
    EXPECT_TRUE(drill.assumes("tool 1 is a drill of 6 mm, according to its use alone"));
    const Inferred mill = infer(head + "G1 Z-1 F100\nX15\nG0 Z20\nM2\n");
    EXPECT_TRUE(mill.assumes("tool 1 is a flat end mill of 6 mm, according to its use alone"));
}

TEST(InferredSetup, AssumesHandworkWhereTheProgramLeavesIt) {
    const Inferred run = infer("G21 G90\nG0 Z5\nG0 X0 Y0\nG1 Z-1 F100\nX20\nG0 Z5\nX3\nM2\n");
    EXPECT_TRUE(run.assumes("never starts the spindle"));
    EXPECT_TRUE(run.assumes("uses no tool length offset"));
    EXPECT_EQ(run.status, 0) << run.report["findings"].dump();
    const Inferred speed = infer("G21 G90\nM3\nG0 Z5\nG0 X0 Y0\nG1 Z-1 F100\nX20\nG0 Z5\nX3\nM2\n");
    EXPECT_TRUE(speed.assumes("has no spindle speed"));
    EXPECT_EQ(speed.status, 0) << speed.report["findings"].dump();
}

TEST(InferredSetup, ReportsAForgottenLengthOffsetIfOthersArePresent) {
    std::string forgotten = pocket;
    forgotten.replace(forgotten.find("G0 Z20.\nM5"), 7,
                      "G0 Z20.\nT4 M6\nS5000 M3\nG49\nG0 Z10.\nG1 Z-1.\nX12.\nG0 Z20.");
    const Inferred run = infer(forgotten);
    bool shown_assumptions = false;
    for (const json& finding : run.report["findings"])
        shown_assumptions = shown_assumptions || finding["rule"] == "missing-length-offset";
    EXPECT_TRUE(shown_assumptions);
}

TEST(InferredSetup, DoesNotFailOnAProgramThatCutsNothing) {
    const Inferred run = infer("G21 G90\nG0 X1 Y1 Z1\nM2\n");
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_TRUE(run.assumes("the program cuts nothing"));
}

TEST(InferredSetup, DoesNotTakeAProbingMoveForACut) {
    const Inferred run = infer("G21 G90 G17 G54 G64 P0.02\nT10 M6\nG0 X0 Y0\nG43 H10 Z30\n"
                               "G38.2 Z-5 F100\nG0 Z30\nM2\n",
                               {"--dialect", "linuxcnc"}, "p.ngc");
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_TRUE(run.assumes("it cuts nothing"));
    EXPECT_FALSE(run.assumes("switched on by hand"));
}

TEST(InferredSetup, IsWrittenAsAFileThatMeansTheSame) {
    const std::string first_words = "G21 G90\nM3\nG0 Z5\nG0 X0 Y0\nG1 Z-1 F100\nX20\nG0 Z5\n";
    for (const std::string& program :
         {pocket, first_words + "M2\n", first_words + "T1 M6\nG43 H1 Z3\nG1 X5\nM2\n",
          std::string("(T0 : 3.0)\nG21\nT0 M6\nM3 S1000\nG0 Z3\nG1 Z-1 F100\nX9\nG0 Z3\nM2\n"),
          std::string(
              "(60 deg v-bit 1/4\")\nG20 G90\nT2 M6\nM3 S1\nG43 H2 Z1\nG1 Z-.1 F5\nX1\nM2\n")}) {
        const ScopedFolder folder;
        const std::string file = folder.write("p.nc", program);
        const test_support::Ran written = feeler({"setup", file, "-o", folder / "s.toml"});
        ASSERT_EQ(written.status, 0) << written.err;
        const auto run = [&](std::vector<std::string> words) {
            words.insert(words.begin(), {"check", file, "--format", "json"});
            const test_support::Ran ran = feeler(words);
            const json report = json::parse(ran.out, nullptr, false);
            EXPECT_FALSE(report.is_discarded()) << ran.err;
            return std::make_pair(ran.status, report);
        };
        const auto [status, alone] = run({});
        const auto [again, by_file] = run({"--setup", folder / "s.toml"});
        EXPECT_EQ(status, again) << program;
        for (const char* key : {"blocks", "findings", "verdict", "mesh_size"})
            EXPECT_EQ(alone[key], by_file[key]) << key << program;
    }
}

/// A program in a file with this name, and the program file whose set-up is written.
struct WrittenSetUp {
    std::string file, program;
    std::string errors;   // expected without a set-up and with the written one
    std::string expected; // in the written set-up
};

class SetupKeepsTheVerdict : public testing::TestWithParam<WrittenSetUp> {};

TEST_P(SetupKeepsTheVerdict, OfTheBareProgram) {
    const ScopedFolder folder;
    const std::string program = folder.write(GetParam().file, GetParam().program);
    const test_support::Ran written = feeler({"setup", program});
    ASSERT_EQ(written.status, 0) << written.err;
    EXPECT_NE(written.out.find(GetParam().expected), std::string::npos) << written.out;
    const std::string setup = folder.write("s.toml", written.out);
    const Checked bare = check_files(program, ""), stated = check_files(program, setup);
    EXPECT_EQ(bare.errors(), GetParam().errors);
    EXPECT_EQ(stated.errors(), GetParam().errors) << stated.err;
    EXPECT_EQ(stated.verdict, bare.verdict);
    EXPECT_EQ(stated.status, bare.status);
}

constexpr const char* fanuc_head = "%\nO0001\nG21 G90 G17 G40 G49 G80\nT2 M6\n";

INSTANTIATE_TEST_SUITE_P(
    Programs, SetupKeepsTheVerdict,
    testing::Values(
        WrittenSetUp{"lengths.nc",
                     std::string(fanuc_head)
                         + "G54 G0 X0. Y0. S1000 M3\nG43 H2 Z50.\nZ5.\nG1 Z-2. F200.\nX50.\n"
                           "G0 Z50.\nG49\nG65 P9000 A1.\nM30\nO9000\nM99\n%\n",
                     "open-premise 11", "[[tool]]\nnumber = 2\n"},
        WrittenSetUp{"numbered.nc",
                     std::string(fanuc_head)
                         + "G54.1 P3 G0 X0. Y0. S1000 M3\nG43 H2 Z50.\nZ5.\nG1 Z-2. F200.\n"
                           "X50.\nG0 Z50.\nG55 X0. Y0.\nZ5.\nG1 Z-2.\nX60.\nG0 Z50.\nG28 G91 Z0.\n"
                           "M30\n%\n",
                     "", "\"G54.1 P3\" = { X = 560"},
        WrittenSetUp{"names.mpf",
                     "G54 G90 G71 G17\nT=\"MILL 10\" M6\nS1000 M3\nG0 X0 Y0 Z50 D1\nZ5\n"
                     "G1 Z-2 F200\nX50\nG0 Z50\nT=\"DRILL\" M6\nS1000 M3\nG0 X10 Y0 Z50 D1\n"
                     "G1 Z-5 F100\nG0 Z50\nM30\n",
                     "", "name = \"MILL 10\""},
        WrittenSetUp{"turned.ngc",
                     "G21 G90\nT1 M6\nS1000 M3\nG0 Z50\nX0 Y0\nZ5\nG1 Z-2 F200\nX50\nG0 Z50\n"
                     "A90\nX0\nG1 Z-2\nX50\nG0 Z50\nA0\nM2\n",
                     "undecided 10", "other_axes = \"not described\""},
        WrittenSetUp{"turning.ngc",
                     "G21 G90 G8\nT1 M6\nS1000 M3\nG0 X20 Z5\nG1 Z-30 F100\nX25\nG0 Z5\nM2\n",
                     "undecided", "box = "}),
    [](const auto& each) { return each.param.file.substr(0, each.param.file.find('.')); });

TEST(SetupCommand, NeverWritesOverItsProgram) {
    const ScopedFolder folder;
    const std::string file = folder.write("p.nc", pocket);
    EXPECT_EQ(feeler({"setup", file, "-o", file}).status, 2);
    EXPECT_EQ(feeler({"setup", folder / "none.nc"}).status, 2);
}

TEST(StockEnvelope, CountsInASetUpAsWell) {
    const std::string program =
        "G21 G90 G54\nT1 M6\nS1000 M3\nG43 H1 Z60\nG0 X10 Y10\nG1 Z-5 F100\n"
        "X40\nG0 Z60\nX10\nM30\n";
    const auto assumed = [&](const SetupWriter& setup) {
        const Checked checked = check(setup, program);
        EXPECT_EQ(checked.status, 0) << checked.err << checked.errors();
        for (const std::string& each : checked.assumptions)
            if (each.find("the stock is the box that cutting moves reach") == 0) return each;
        return std::string();
    };
    EXPECT_NE(assumed(SetupWriter().without_stock()).find("X 5.000 to 45.000"), std::string::npos);
    EXPECT_NE(assumed(SetupWriter().stock("margin = 3\n"))
                  .find("X 2.000 to 48.000, Y 2.000 to "
                        "18.000, Z -8.000 (3 mm below"),
              std::string::npos);
    const ScopedFolder folder;
    const auto status = [&](const SetupWriter& setup, const std::string& text) {
        return feeler({"check", folder.write("p.nc", text), "--setup",
                       folder.write("s.toml", setup.text())})
            .status;
    };
    const std::string box = "box = [[0, 0, 0], [1, 1, 1]]\n";
    EXPECT_EQ(status(SetupWriter().stock("margin = 3\n" + box), program), 2);
    EXPECT_EQ(status(SetupWriter().stock("margin = -1\n"), program), 2);
    EXPECT_EQ(status(SetupWriter().stock("at = [1, 2, 3]\n"), program), 2);
    const std::string uncut = "G21\nG0 X1\nM30\n";
    EXPECT_EQ(status(SetupWriter().without_stock(), uncut),
              feeler({"check", folder.write("bare.nc", uncut)}).status)
        << "as without a set-up";
}

TEST(ToolLibraryKey, OffersWhatTheSetUpLacks) {
    const ScopedFolder folder;
    folder.write("t.tbl", "T1 P1 D20 Z50\nT2 P2 D8 Z70 ;ball nose\n");
    const std::string setup =
        folder.write("s.toml", SetupWriter().root("tool_library = \"t.tbl\"\n").lengths("").text());
    const std::string program =
        folder.write("p.nc", "G21 G90 G54\nT1 M6\nG43 H1 Z60\nT2 M6\nG43 H2 Z60\nM30\n");
    const Checked checked = check_files(program, setup);
    EXPECT_EQ(checked.status, 0) << checked.err;
    std::string all;
    for (const std::string& each : checked.assumptions) all += each + "\n";
    EXPECT_NE(all.find("tool 2 is a ball end mill of 8 mm, according to"), std::string::npos)
        << all;
    EXPECT_EQ(all.find("tool 1 is a"), std::string::npos) << all; // the set-up defines it
}

} // namespace
} // namespace app_test
