#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/checked.h"

namespace app_test {
namespace {

const std::string assets = std::string(FEELER_SOURCE_DIR) + "/assets/";
const std::string plate = assets + "programs/clamped_plate.nc";
const std::string plate_low = assets + "programs/clamped_plate_low.nc";
const std::string setup = assets + "setups/clamped_plate.toml";

TEST(Diff, ReportsWhatCameNearerAndEndsWithOneIfItIsWorse) {
    const auto ran = feeler({"diff", plate, plate_low, "--setup", setup});
    EXPECT_EQ(ran.status, 1) << ran.err;
    EXPECT_NE(ran.out.find("Nearer:\n  line 44            Y75."), std::string::npos) << ran.out;
    EXPECT_NE(ran.out.find("40.792 -> 4.000 mm, 36.792 nearer, flutes / strap-1"),
              std::string::npos);
    EXPECT_NE(ran.out.find("New findings:\n  warning low-retract, line 44: Y75."),
              std::string::npos);
    EXPECT_NE(ran.out.find("CLEAR -> COLLISION\n"), std::string::npos);
}

TEST(Diff, EndsWithZeroWhenItIsBetterOrTheSame) {
    const auto better = feeler({"diff", plate_low, plate, "--setup", setup});
    EXPECT_EQ(better.status, 0) << better.out;
    EXPECT_NE(better.out.find("Resolved findings:"), std::string::npos);
    const test_support::ScopedFolder folder;
    const std::string copy = folder.write("copy.nc", test_support::bytes_of(plate));
    const auto same = feeler({"diff", plate, copy, "--setup", setup});
    EXPECT_EQ(same.status, 0);
    EXPECT_NE(same.out.find("0 blocks nearer, 0 farther, 37 as before, 0 new, 0 gone"),
              std::string::npos)
        << same.out;
}

TEST(Diff, OfASetupListsEveryBlockInJson) {
    const test_support::ScopedFolder folder;
    const std::string program = folder.write("a.nc", "G21 G90 G54\nT1 M6\nG43 H1\nG0 X20 Y50\n"
                                                     "G0 Z40\nG0 X80\nM2\n");
    const auto with_post = [&](const std::string& name, int x) {
        const std::string from = std::to_string(x), to = std::to_string(x + 20);
        return folder.write(
            name, test_support::SetupWriter()
                      .fixture("post", "box = [[" + from + ", 0, -30], [" + to + ", 100, 90]]")
                      .text());
    };
    const auto ran = feeler({"diff", program, "--setup", with_post("a.toml", 110), "--setup-b",
                             with_post("b.toml", 105), "--format", "json"});
    ASSERT_EQ(ran.status, 0) << ran.out << ran.err;
    const auto json = nlohmann::json::parse(ran.out);
    EXPECT_FALSE(json["worse"]);
    ASSERT_FALSE(json["nearer"].empty());
    EXPECT_EQ(json["nearer"][0]["after"]["text"], "G0 X80");
    EXPECT_NEAR(json["nearer"][0]["nearer"].get<double>(), 5.0, 1e-6);
    EXPECT_NEAR(json["nearer"][0]["after"]["clearance"]["upper"].get<double>(), 5.0, 1e-6);
    EXPECT_EQ(json["before"]["setup"], folder / "a.toml");
}

TEST(Diff, RefusesToCompareNothing) {
    const auto ran = feeler({"diff", plate, "--setup", setup});
    EXPECT_EQ(ran.status, 2);
    EXPECT_NE(ran.err.find("nothing to compare with"), std::string::npos) << ran.err;
    EXPECT_EQ(feeler({"diff", plate, "/nowhere.nc", "--setup", setup}).status, 2);
}

} // namespace
} // namespace app_test
