#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/checked.h"

namespace app_test {
namespace {

using test_support::SetupWriter;

const std::vector<std::string> coprocessor = {"--engine", "coprocessor"};

SetupWriter mill() { return SetupWriter().also("[control]\n\"5006#6\" = 1\n"); }

/// A slot along X at a depth, and a rapid back at a height.
std::string slot(const std::string& depth, const std::string& height) {
    return "G21 G90 G54\nT1 M6\nG43 H1\nS8000 M3\nG0 X-20 Y50 Z30\nZ" + depth
           + "\nG1 X120 F800\nG0 Z" + height + "\nX-20\nZ60\nM30\n";
}

TEST(Engine, TheCoprocessorGivesLowerBoundsOfItsOwn) {
    const Checked exact = check(mill(), slot("-5", "10"));
    const Checked device = check(mill(), slot("-5", "10"), coprocessor);
    EXPECT_EQ(device.status, 0) << device.err;
    ASSERT_EQ(device.blocks.size(), exact.blocks.size());
    for (size_t i = 0; i < exact.blocks.size(); ++i) {
        const BlockLine& a = exact.blocks[i];
        const BlockLine& b = device.blocks[i];
        EXPECT_EQ(b.verdict, "clear") << b.text;
        EXPECT_EQ(b.removed, a.removed) << b.text;
        EXPECT_EQ(b.duration, a.duration);
        EXPECT_FALSE(b.deciding.upper) << "a cover gives no upper bound";
        if (a.deciding.upper) {
            EXPECT_LE(b.deciding.lower, *a.deciding.upper) << b.text;
            EXPECT_GE(b.deciding.lower, *a.deciding.upper - 1.0) << b.text;
        }
    }
}

TEST(Engine, TheCoprocessorRefusesARapidThroughTheStockOnceAndTheShankInASlot) {
    const Checked back = check(mill(), slot("-5", "-2"), coprocessor);
    EXPECT_EQ(back.status, 0) << "through its own slot: " << back.errors();
    const Checked across = check(mill(),
                                 "G21 G90 G54\nT1 M6\nG43 H1\nS8000 M3\nG0 X-20 Y50 Z30\nZ-5\n"
                                 "X120\nX-20\nZ60\nM30\n",
                                 coprocessor);
    EXPECT_EQ(across.errors(), "refused 7") << "the material that it hit is removed";
    EXPECT_EQ(across.at_line(7).verdict, "collision");
    EXPECT_GT(across.at_line(7).removed, 4000.0);
    const Checked deep = check(mill(), slot("-25", "10"), coprocessor);
    EXPECT_EQ(deep.status, 1);
    EXPECT_EQ(deep.at_line(7).pair("shank stock").verdict, "collision");
    EXPECT_NE(deep.finding("refused").message.find("its models of the shank and of the stock"),
              std::string::npos)
        << deep.finding("refused").message;
}

TEST(Engine, WhatTheCoprocessorCannotCheckIsNotCalledClear) {
    const Checked far = check(mill(),
                              "G21 G90 G54\nT1 M6\nG43 H1\nG0 X-20 Y50 Z30\nZ60\n"
                              "G0 X3000\nM30\n",
                              coprocessor);
    EXPECT_EQ(far.at_line(6).verdict, "undecided");
    EXPECT_EQ(far.at_line(6).deciding.lower, 0.0);
    EXPECT_NE(far.finding("refused").message.find("24 bits"), std::string::npos)
        << far.finding("refused").message;
}

TEST(Engine, IsNamedInTheReportAndRefusedIfItIsNoEngine) {
    const test_support::ScopedFolder folder;
    const std::string program = folder.write("a.nc", "G21 G90 G54\nG0 X0\nM30\n");
    for (const std::string engine : {"exact", "coprocessor"}) {
        const auto ran = feeler({"check", program, "--engine", engine, "--format", "json"});
        EXPECT_EQ(nlohmann::json::parse(ran.out).at("engine"), engine);
    }
    const auto wrong = feeler({"check", program, "--engine", "gpu"});
    EXPECT_EQ(wrong.status, 2);
    EXPECT_NE(wrong.err.find("gpu not in {exact,coprocessor}"), std::string::npos) << wrong.err;
}

} // namespace
} // namespace app_test
