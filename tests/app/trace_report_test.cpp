#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/report/text/trace_report.h"

namespace app {
namespace {

using Json = nlohmann::json;

TEST(JsonLine, WritesNumbersToTheLastBit) {
    std::mt19937_64 random(1);
    for (int i = 0; i < 20000; ++i) {
        const uint64_t bits = random();
        double value = 0.0;
        std::memcpy(&value, &bits, sizeof value);
        std::string text;
        JsonLine line(text);
        line.add("value", value);
        line.finish();
        const Json json = Json::parse(text);
        if (std::isfinite(value)) {
            ASSERT_EQ(json["value"].get<double>(), value) << text;
        } else {
            ASSERT_TRUE(json["value"].is_null()) << text;
        }
    }
}

TEST(JsonLine, WritesAnyBytesAsAText) {
    std::mt19937 random(1);
    for (int i = 0; i < 5000; ++i) {
        std::string bytes;
        for (size_t length = random() % 12; length > 0; --length)
            bytes.push_back(static_cast<char>(random() % (i % 2 == 0 ? 128 : 256)));
        std::string text;
        JsonLine line(text);
        line.add("text", std::string_view(bytes));
        line.finish();
        EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
        const Json json = Json::parse(text);
        if (i % 2 == 0) {
            EXPECT_EQ(json["text"], bytes);
        }
    }
}

/// The JSON of one command in its own block.
Json json_of(const gcode::CanonicalCommand& command) {
    gcode::BlockCommands block{core::BlockIndex(4), 7, "the \"text\"", "sub.ngc", {2, 5}};
    block.commands = {command, gcode::ProgramEnd{}};
    block.columns = {3, 4};
    std::string text;
    append_trace_json(block, text);
    EXPECT_EQ(Json::parse(text.substr(text.find('\n') + 1))["command"], "program_end");
    return Json::parse(text.substr(0, text.find('\n')));
}

TEST(TraceJson, SaysWhereACommandComesFrom) {
    const Json json = json_of(gcode::ProgramStop{});
    EXPECT_EQ(json, Json::parse(R"({"block":4,"file":"sub.ngc","line":7,"column":3,"calls":[2,5],
        "command":"program_stop","text":"the \"text\""})"));
}

TEST(TraceJson, HasTheKeysOfEveryCommand) {
    const gcode::Position position = {1.5, std::nullopt, -3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1};
    const Json end = Json::parse("[1.5, null, -3, 0, 0, 0, 0, 0, 0.1]");
    EXPECT_EQ(json_of(gcode::StraightTraverse{position})["end"], end);
    const Json arc = json_of(gcode::ArcFeed{position, gcode::Plane::zx, {1.0, 2.5}, -2, 150.0});
    EXPECT_EQ(arc["end"], end);
    EXPECT_EQ(arc["plane"], "ZX");
    EXPECT_EQ(arc["centre"], Json::parse("[1, 2.5]"));
    EXPECT_EQ(arc["turns"], -2);
    EXPECT_EQ(arc["feed"], 150.0);
    EXPECT_TRUE(json_of(gcode::ChangeTool{})["tool"].is_null());
    EXPECT_EQ(json_of(gcode::ChangeTool{core::ToolNumber{3}})["tool"], 3);
    EXPECT_EQ(json_of(gcode::Message{"a\tb"})["message"], "a\tb");
    EXPECT_EQ(json_of(gcode::Coolant{true, false})["mist"], true);
    gcode::SetOffset set;
    set.offsets.has_frame = true;
    set.offsets.frame.linear[1][0] = 0.5; // first row of the second column
    set.offsets.frame.shift = {7.0, 8.0, 9.0};
    EXPECT_EQ(json_of(set)["frame"], Json::parse("[[1,0.5,0,7],[0,1,0,8],[0,0,1,9]]"));
    EXPECT_EQ(json_of(set)["number"], 1);
}

} // namespace
} // namespace app
