#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/checked.h"

namespace app_test {
namespace {

using Json = nlohmann::json;
using test_support::Ran;
using test_support::ScopedFolder;
using test_support::SetupWriter;

const std::string small_program = "G21 G90 G17 G54\n"
                                  "T1 M6\n"
                                  "S1000 M3 M8\n"
                                  "G0 X10. Y20.\n"
                                  "G1 Z-5. F200.\n"
                                  "G2 X20. Y10. I0. J-10. F150.\n"
                                  "M30\n";

std::vector<Json> json_lines(const std::string& text) {
    std::vector<Json> lines;
    std::stringstream stream(text);
    for (std::string line; std::getline(stream, line);)
        lines.push_back(Json::parse(line, nullptr, false));
    return lines;
}

/// The first command with that name in the trace of the small program.
Json command(const std::string& name, const std::vector<std::string>& more = {}) {
    const ScopedFolder folder;
    std::vector<std::string> words = {
        "trace", folder.write("p.nc", small_program), "--format", "jsonl", "--dialect", "fanuc"};
    words.insert(words.end(), more.begin(), more.end());
    const Ran ran = feeler(words);
    EXPECT_EQ(ran.status, 0) << ran.err;
    for (const Json& line : json_lines(ran.out))
        if (line.is_object() && line["command"] == name) return line;
    ADD_FAILURE() << "no " << name << " in " << ran.out;
    return {};
}

TEST(Trace, GivesEveryCommandItsBlockItsLineAndItsText) {
    const Json feed = command("straight_feed");
    EXPECT_EQ(feed["block"], 4);
    EXPECT_EQ(feed["line"], 5);
    EXPECT_EQ(feed["text"], "G1 Z-5. F200.");
}

TEST(Trace, GivesNineAxesAndLeavesUncommandedOnesUnknown) {
    EXPECT_EQ(command("straight_traverse")["end"],
              Json::parse("[10.0, 20.0, null, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]"));
    EXPECT_EQ(command("straight_feed")["end"][2], -5.0);
    EXPECT_EQ(command("straight_feed")["feed"], 200.0);
}

TEST(Trace, GoesByTheControlOfTheSetUp) {
    const std::string program = "G21 G90 G17 G54\nT1 M6\nG43 H1 G0 Z100.\nG49\nM30\n";
    const auto last_z = [&](const std::string& number) {
        const ScopedFolder folder;
        SetupWriter setup;
        setup.program("dialect = \"fanuc\"\nstart = { X = -350, Y = -200, Z = 0 }\n");
        setup.also("[control]\n\"5006#6\" = " + number + "\n");
        const Ran ran = feeler({"trace", folder.write("p.nc", program), "--format", "jsonl",
                                "--setup", folder.write("p.toml", setup.text())});
        EXPECT_EQ(ran.status, 0) << ran.err;
        size_t moves = 0;
        for (const Json& line : json_lines(ran.out))
            moves += line.is_object() && line["command"] == "straight_traverse";
        return moves;
    };
    EXPECT_EQ(last_z("1"), 1U);
    EXPECT_EQ(last_z("0"), 2U); // G49 moves Z
}

TEST(Trace, GivesAnArcItsPlaneCentreAndTurns) {
    const Json arc = command("arc_feed");
    EXPECT_EQ(arc["plane"], "XY");
    EXPECT_EQ(arc["centre"], Json::array({10.0, 10.0}));
    EXPECT_EQ(arc["turns"], -1);
    EXPECT_EQ(arc["feed"], 150.0);
}

TEST(Trace, LeavesOutKeysThatMeanNothing) {
    EXPECT_FALSE(command("straight_traverse").contains("feed"));
    EXPECT_FALSE(command("straight_feed").contains("plane"));
    EXPECT_FALSE(command("spindle").contains("end"));
    EXPECT_EQ(command("spindle")["direction"], "clockwise");
    EXPECT_EQ(command("change_tool")["tool"], 1);
    EXPECT_EQ(command("coolant")["flood"], true);
}

TEST(Trace, TakesTheOffsetsOfASetup) {
    const ScopedFolder folder;
    const std::string setup = folder.write("s.toml", SetupWriter().text());
    EXPECT_EQ(command("set_offset")["offset"],
              Json::array({0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}));
    EXPECT_EQ(command("set_offset", {"--setup", setup})["offset"],
              Json::array({-350.0, -200.0, -420.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}));
}

TEST(Trace, IsReadableText) {
    const ScopedFolder folder;
    const Ran ran = feeler({"trace", folder.write("p.nc", small_program), "--dialect", "fanuc"});
    EXPECT_EQ(ran.status, 0);
    // The program has no G43, which the control would accept.
    EXPECT_NE(ran.err.find("tool 1 moves in Z without a length offset"), std::string::npos);
    EXPECT_NE(ran.out.find("6: arc_feed x=20 y=10 z=-5 plane=XY centre=10,10 turns=-1 feed=150\n"),
              std::string::npos)
        << ran.out;
}

TEST(Trace, EndsAtTheFirstErrorWithWhatCameBeforeIt) {
    const ScopedFolder folder;
    const std::string bad = folder.write("bad.nc", "G21 G90\nG0 X1.\nG0 X2. G777\nG0 X3.\n");
    folder.write("old.txt", "old");
    const Ran ran = feeler({"trace", bad, "--dialect", "fanuc", "-o", folder / "old.txt"});
    EXPECT_EQ(ran.status, 2);
    EXPECT_NE(ran.err.find("bad.nc:3:8: G777"), std::string::npos) << ran.err;
    EXPECT_NE(ran.out.find("straight_traverse x=1"), std::string::npos) << ran.out;
    EXPECT_EQ(ran.out.find("x=3"), std::string::npos);
    EXPECT_EQ(test_support::bytes_of(folder / "old.txt"), "old");
    EXPECT_EQ(folder.names().size(), 2u);
}

TEST(Trace, RefusesADialectThatDoesNotExist) {
    const ScopedFolder folder;
    const Ran ran = feeler({"trace", folder.write("p.nc", small_program), "--dialect", "mazak"});
    EXPECT_EQ(ran.status, 2);
    EXPECT_EQ(ran.out, "");
    EXPECT_NE(ran.err.find("mazak"), std::string::npos);
}

} // namespace
} // namespace app_test
