#include <cstdlib>
#include <filesystem>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/app/checked.h"
#include "tests/support/scoped_folder.h"

namespace app_test {
namespace {

using test_support::SetupWriter;

const std::filesystem::path assets = std::filesystem::path(FEELER_SOURCE_DIR) / "assets";

/// A job of assets, and its expected results as given in the comment of its set-up.
struct Job {
    std::string program, setup, verdict;
    std::string errors;          // texts of the blocks with errors, in order
    std::vector<double> removed; // by each tool, from tool 1 on, mm3
    double deviation = 0.01;     // of `removed`, relative: larger on bars with few scan lines
};

const std::vector<Job> jobs = {
    {"clamped_plate.nc", "clamped_plate", "clear", "", {57414.6, 6032.0}},
    {"clamped_plate_low.nc", "clamped_plate", "collision", "Y75. Y143. Y75. Y7. ", {}},
    {"TEST_G90.NC", "test_g90_vise6", "clear", "", {13397.8, 0.0, 108379.9}},
    {"PARALLEL.NC", "parallel", "clear", "", {}},
};

/// On four and five axes.
const std::vector<Job> turned_jobs = {
    {"indexed_flats.nc", "indexed_flats", "clear", "", {}},
    {"indexed_flats_g99.nc", "indexed_flats", "collision", "G0 A180. G0 A90. G0 A0 ", {}},
    {"tilted_faces.nc", "tilted_faces", "clear", "", {}},
    {"tilted_faces_lead_in.nc", "tilted_faces", "collision", "Z-4.243 G1 X60. F800. ", {}},
    {"dome.ngc", "dome", "clear", "", {868.0}, 0.02},
    {"flutes.ngc", "flutes", "clear", "", {0.0, 824.0}, 0.02},
};

Checked check_job(const Job& job) {
    return check_files(assets / "programs" / job.program,
                       assets / "setups" / (job.setup + ".toml"));
}

/// The texts of all moving blocks that are not clear.
std::string texts_of_errors(const Checked& checked) {
    std::string texts;
    for (const BlockLine& block : checked.blocks)
        if (block.verdict != "clear" && block.motion != "none") texts += block.text + " ";
    return texts;
}

void expect_verdicts(const std::vector<Job>& checked_jobs) {
    for (const Job& job : checked_jobs) {
        SCOPED_TRACE(job.program);
        const Checked checked = check_job(job);
        EXPECT_EQ(checked.verdict, job.verdict) << checked.errors() << checked.err;
        EXPECT_EQ(checked.status, job.verdict == "clear" ? 0 : 1);
        EXPECT_EQ(texts_of_errors(checked), job.errors);
        for (size_t i = 0; i < job.removed.size(); ++i) {
            double removed = 0.0;
            for (const BlockLine& block : checked.blocks)
                if (block.tool == static_cast<int>(i) + 1) removed += block.removed;
            EXPECT_NEAR(removed, job.removed[i], job.deviation * job.removed[i])
                << "tool " << i + 1;
        }
    }
}

TEST(Assets, EveryJobHasItsVerdict) { expect_verdicts(jobs); }

TEST(Assets, EveryJobThatTurnsTheWorkHasItsVerdict) { expect_verdicts(turned_jobs); }

TEST(Assets, ADomeWithoutM428IsACrash) {
    const test_support::ScopedFolder folder;
    const std::string whole = test_support::bytes_of(assets / "programs" / "dome_m428.ngc");
    const size_t middle = whole.find("\nG1", whole.size() / 20); // enough of it
    const Checked checked = check_files(folder.write("p.ngc", whole.substr(0, middle) + "\nM30\n"),
                                        assets / "setups" / "dome.toml");
    EXPECT_EQ(checked.verdict, "collision");
    EXPECT_EQ(checked.status, 1);
    EXPECT_EQ(checked.at_line(10).pair("flutes collet-block").verdict, "collision");
}

TEST(Assets, TheProgramsForFiveAxesAreAsGenerated) {
    const test_support::ScopedFolder folder;
    const std::filesystem::path script =
        folder.write("generate.py", test_support::bytes_of(assets / "programs" / "generate.py"));
    ASSERT_EQ(std::system(fmt::format("python3 {}", script.string()).c_str()), 0);
    for (const char* name : {"dome.ngc", "dome_m428.ngc", "flutes.ngc"})
        EXPECT_EQ(test_support::bytes_of(script.parent_path() / name),
                  test_support::bytes_of(assets / "programs" / name))
            << name;
}

TEST(Assets, EverySetupIsInAJob) {
    std::set<std::string> known = {"test_g90"}; // a violation, which other tests check
    for (const auto* list : {&jobs, &turned_jobs})
        for (const Job& job : *list) known.insert(job.setup);
    for (const auto& file : std::filesystem::directory_iterator(assets / "setups"))
        EXPECT_TRUE(known.contains(file.path().stem())) << file.path();
}

/// The range of an axis; for a rotary axis, the angles to try.
struct Travel {
    char axis;
    std::vector<double> places;
};

/// Blocks that move to every corner of the travel, with an empty spindle.
std::string corners(const std::vector<Travel>& travels) {
    std::vector<std::string> blocks = {"G53 G0"};
    for (const Travel& travel : travels) {
        std::vector<std::string> longer;
        for (const std::string& block : blocks)
            for (const double place : travel.places)
                longer.push_back(fmt::format("{} {}{:.1f}", block, travel.axis, place));
        blocks = std::move(longer);
    }
    std::string text = "G21 G90 G40 G49 G80 G17\n";
    for (const std::string& block : blocks) text += block + "\n";
    return text + "M30\n";
}

/// Uses a tiny stock on the table, so that no work is in the way.
void expect_free_travel(const std::string& machine, const std::string& origin,
                        const std::vector<Travel>& travels) {
    SetupWriter setup;
    setup.program("dialect = \"fanuc\"\n")
        .machine("file = \"" + (assets / "machines" / (machine + ".toml")).string() + "\"\n")
        .offsets("G54 = " + origin + "\n")
        .stock("box = [[-5, -5, 0], [5, 5, 5]]");
    const Checked checked = check(setup, corners(travels));
    EXPECT_EQ(checked.verdict, "clear") << machine << " " << checked.errors() << checked.err;
    size_t pairs = 0;
    for (const BlockLine& block : checked.blocks) pairs += block.pairs.size();
    EXPECT_GT(pairs, checked.blocks.size()) << machine << " has bodies";
}

TEST(Assets, TheMillMeetsNothingOfItselfInItsTravel) {
    expect_free_travel("mill3", "{ X = -350, Y = -225, Z = -620 }",
                       {{'X', {0, -700}}, {'Y', {0, -450}}, {'Z', {0, -500}}});
}

} // namespace
} // namespace app_test
