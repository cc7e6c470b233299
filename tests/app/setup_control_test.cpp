#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/checked.h"

namespace app_test {
namespace {

using test_support::ScopedFolder;

const std::string drilled =
    "%\nO1\nG21 G90 G54\nT1 M6\nS3000 M3\nG0 X0 Y0\nG43 H1 Z5.\nG1 Z-1. F100.\n"
    "G0 Z50.\nM30\n%\n";
const std::string stated =
    "[program]\ndialect = \"fanuc\"\nunit = \"mm\"\n[offsets]\nG54 = { X = -350, Y "
    "= -200, Z = -420 }\n[stock]\nbox = [[-9, -9, -9], [9, 9, 0]]\n[[tool]]\n"
    "number = 1\nshape = \"drill\"\ndiameter = 6\nflute_length = 30\n"
    "stick_out = 40\nholder = [[40, 40, 80]]\n";
const std::string origins = "G10 L2 P1 X-350. Y-200. Z-420.\n";

struct ComparedJob {
    ScopedFolder folder{};
    std::string program = folder.write("plate.nc", drilled);
    std::string setup = folder.write("plate.toml", stated);

    test_support::Ran compare(const std::vector<std::string>& texts,
                              std::vector<std::string> more = {}) const {
        std::vector<std::string> words = {"setup", program};
        for (size_t i = 0; i < texts.size(); ++i)
            for (const std::string& word :
                 {std::string("--control"),
                  folder.write("c" + std::to_string(i) + ".txt", texts[i])})
                words.push_back(word);
        words.insert(words.end(), more.begin(), more.end());
        return feeler(words);
    }
};

TEST(SetupControl, TheStatusSaysWhetherAllAgree) {
    const ComparedJob job;
    const auto equal = job.compare({origins, "G10 L10 P1 R120.\n"});
    EXPECT_EQ(equal.status, 0) << equal.err;
    EXPECT_NE(equal.out.find("All of the 4 values are equal."), std::string::npos) << equal.out;
    const auto other = job.compare({origins + "G10 L10 P1 R120.5\n"});
    EXPECT_EQ(other.status, 1);
    EXPECT_NE(other.out.find("H1                   120.000     120.500      +0.500   differs"),
              std::string::npos)
        << other.out;
    const auto damaged = job.compare({origins + "G10 L10 P1 R#1\n"});
    EXPECT_EQ(damaged.status, 2);
    EXPECT_NE(damaged.err.find("c0.txt:2:12"), std::string::npos) << damaged.err;
}

TEST(SetupControl, WritesJsonToAFileButNotOverOneThatItRead) {
    const ComparedJob job;
    const std::string output = job.folder / "out.json";
    EXPECT_EQ(job.compare({origins}, {"--format", "json", "-o", output}).status, 0);
    const auto json = nlohmann::json::parse(test_support::bytes_of(output), nullptr, false);
    ASSERT_FALSE(json.is_discarded());
    EXPECT_EQ(json.at("differences"), 0);
    EXPECT_EQ(json.at("values").size(), 3u);
    EXPECT_EQ(job.compare({origins}, {"-o", job.setup}).status, 2);
    EXPECT_EQ(test_support::bytes_of(job.setup), stated);
}

TEST(SetupControl, ALibraryWithHoldersStatesLengths) {
    const ScopedFolder folder;
    const std::string program = folder.write("plate.nc", drilled);
    const std::string tool =
        R"({"type": "drill", "unit": "millimeters", "geometry": {"DC": 6, "LCF":
        30, "LB": 40, "SFDM": 6}, "post-process": {"number": 1})";
    const std::string holder =
        R"(, "holder": {"segments": [{"height": 80, "lower-diameter": 40, "upper-diameter": 40}]})";
    folder.write("plate.toml", "tool_library = \"l.json\"\n[program]\ndialect = \"fanuc\"\nunit = "
                               "\"mm\"\n[stock]\nbox = [[-9, -9, -9], [9, 9, 0]]\n");
    const std::string control = folder.write("c.txt", "G10 L10 P1 R120.\n");
    folder.write("l.json", R"({"data": [)" + tool + holder + "}]}");
    const auto known = feeler({"setup", program, "--control", control});
    EXPECT_EQ(known.status, 0) << known.out << known.err;
    EXPECT_NE(known.out.find("H1                   120.000     120.000"), std::string::npos)
        << known.out;
    folder.write("l.json", R"({"data": [)" + tool + "}]}");
    EXPECT_NE(feeler({"setup", program, "--control", control}).out.find("not in the set-up"),
              std::string::npos);
}

TEST(SetupControl, OfAProgramThatStopsIsNotComplete) {
    const ScopedFolder folder;
    std::string program = drilled;
    program.replace(program.find("\n", program.size() / 2), 1, "\nG999\n");
    const std::string control = folder.write("c.txt", origins);
    const auto ran = feeler({"setup", folder.write("p.nc", program), "--control", control});
    EXPECT_EQ(ran.status, 2);
    EXPECT_NE(ran.out.find("STOPPED"), std::string::npos) << ran.out;
    EXPECT_NE(ran.out.find("G999"), std::string::npos) << ran.out;
    const auto as_json =
        feeler({"setup", folder / "p.nc", "--control", control, "--format", "json"});
    EXPECT_TRUE(nlohmann::json::parse(as_json.out).contains("stopped"));
}

TEST(SetupControl, WithoutASetUpAllThatTheProgramUsesIsMissingThere) {
    const ComparedJob job;
    const ScopedFolder alone;
    const auto ran = feeler(
        {"setup", alone.write("alone.nc", drilled), "--control", alone.write("c.txt", origins)});
    EXPECT_EQ(ran.status, 1);
    EXPECT_NE(ran.out.find("not in the set-up"), std::string::npos) << ran.out;
    EXPECT_NE(ran.out.find("inferred from the program"), std::string::npos) << ran.out;
}

} // namespace
} // namespace app_test
