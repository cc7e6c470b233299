#include <cstdlib>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/checked.h"

namespace app_test {
namespace {

using Json = nlohmann::json;

const std::filesystem::path example =
    std::filesystem::path(FEELER_SOURCE_DIR) / "../shared/example";
constexpr double mesh_size = 0.5;
constexpr double fixture_accuracy = 1e-3;

double accuracy(const std::string& pair) {
    return pair.ends_with(" stock") ? mesh_size : fixture_accuracy;
}

void expect_block(const BlockLine& block, const Json& expected) {
    EXPECT_EQ(block.motion, expected["motion"]);
    EXPECT_EQ(block.verdict, expected["verdict"]);
    if (expected["clearance"].is_string()) {
        EXPECT_NEAR(block.deciding.lower, 50.0, 1e-9);
        EXPECT_FALSE(block.deciding.upper);
        EXPECT_EQ(block.deciding.name, "");
        return;
    }
    const std::string pair =
        expected["pair"][0].get<std::string>() + " " + expected["pair"][1].get<std::string>();
    EXPECT_EQ(block.deciding.name, pair);
    EXPECT_EQ(block.deciding.allowance, expected["allowance"].get<double>());
    // The worked values have three digits.
    expect_encloses(block.deciding, expected["clearance"], accuracy(pair));
    if (expected.contains("at")) {
        EXPECT_NEAR(block.deciding.at.value_or(-1.0), expected["at"].get<double>(), 1e-4);
    }
    EXPECT_NEAR(block.removed, expected.value("removed", 0.0), 1.0);
}

class WorkedExample : public testing::Test {
protected:
    void SetUp() override {
        if (std::filesystem::exists(example / "expected.json")) {
            std::ifstream(example / "expected.json") >> expected;
            checked = check_files(example / "slot.nc", example / "setup.toml");
            return;
        }
        if (std::getenv("FEELER_REQUIRE_SHARED")) FAIL() << example << " is missing";
        GTEST_SKIP() << example << " is not there";
    }

    Json expected;
    Checked checked;
};

TEST_F(WorkedExample, HasTheVerdictWorkedOutByHand) {
    EXPECT_EQ(checked.verdict, expected["verdict"]);
    EXPECT_EQ(checked.status, 1);
    EXPECT_EQ(checked.errors(), "rapid-near-clamp 11, rapid-near-clamp 12");
}

TEST_F(WorkedExample, HasTheClearancesWorkedOutByHand) {
    ASSERT_FALSE(expected["blocks"].empty());
    for (const Json& block : expected["blocks"]) {
        SCOPED_TRACE(block["line"]);
        expect_block(checked.at_line(block["line"]), block);
    }
}

TEST_F(WorkedExample, HasNoMotionInTheBlocksThatAreNotListed) {
    for (const BlockLine& block : checked.blocks) {
        bool listed = false;
        for (const Json& one : expected["blocks"]) listed = listed || one["line"] == block.line;
        if (listed) continue;
        EXPECT_EQ(block.motion, "none") << block.line;
        EXPECT_FALSE(block.deciding.upper) << block.line;
    }
}

TEST_F(WorkedExample, HasEveryPairOfTheSlotWorkedOutByHand) {
    const BlockLine slot = checked.at_line(9);
    for (const auto& [name, clearance] : expected["pairs of line 9"].items()) {
        const PairLine pair = slot.pair(name);
        ASSERT_TRUE(pair.upper) << name;
        EXPECT_LE(pair.lower, *pair.upper) << name;
        EXPECT_NEAR(pair.lower, clearance, accuracy(name)) << name;
        EXPECT_NEAR(*pair.upper, clearance, accuracy(name)) << name;
    }
}

TEST_F(WorkedExample, NamesTheCure) {
    ASSERT_FALSE(checked.findings.empty());
    EXPECT_NE(checked.findings[0].cure.find("at least 0.500 mm towards Y-"), std::string::npos)
        << checked.findings[0].cure;
}

} // namespace
} // namespace app_test
