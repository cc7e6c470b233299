#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/checked.h"
#include "tests/support/meshes.h"
#include "tests/support/stl_writer.h"

namespace app_test {
namespace {

using Json = nlohmann::json;
using test_support::Ran;
using test_support::ScopedFolder;

Json measure(std::vector<std::string> words) {
    words.insert(words.begin(), "distance");
    words.insert(words.end(), {"--format", "json"});
    const Ran ran = feeler(words);
    EXPECT_EQ(ran.status, 0) << ran.err;
    EXPECT_EQ(ran.err, "");
    return Json::parse(ran.out, nullptr, false);
}

/// Expects lower <= truth <= upper within 1e-6, and witnesses whose distance is `upper`.
void expect_distance(const Json& found, double truth) {
    ASSERT_TRUE(found.is_object());
    const double lower = found["lower"], upper = found["upper"];
    EXPECT_LE(lower, truth + 1e-12);
    EXPECT_GE(upper, truth - 1e-12);
    EXPECT_NEAR(lower, truth, 1e-6);
    EXPECT_NEAR(upper, truth, 1e-6);
    const auto a = found["witness"][0].get<std::vector<double>>();
    const auto b = found["witness"][1].get<std::vector<double>>();
    EXPECT_NEAR(std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]), truth, 1e-6);
}

TEST(Distance, OfTwoSpheresHasThePointsOfThePaperAndTheTrueLength) {
    const Json found = measure({"sphere:25", "sphere:25", "--move", "55,0,0"});
    expect_distance(found, 5.0);
    EXPECT_EQ(found["points"], Json::array({47160, 47160}));
    EXPECT_GE(found["distance"].get<double>(), 5.0);
    EXPECT_LE(found["distance"].get<double>(), 5.01);
    EXPECT_EQ(found["at"], 0.0);
    for (const char* key : {"sphere_tests", "point_tests"}) EXPECT_GT(found[key], 0) << key;
    for (const char* key : {"model", "build", "query"})
        EXPECT_GE(found["seconds"][key], 0.0) << key; // clock: any time
}

TEST(Distance, CountsThePointsOfASphereAtEveryMeshSize) {
    for (const auto& [mesh_size, points] :
         {std::pair{"1", 11856}, std::pair{"1.5", 5232}, std::pair{"2", 2904}})
        EXPECT_EQ(measure({"sphere:25", "sphere:25", "--move", "55,0,0", "--mesh-size",
                           mesh_size})["points"][0],
                  points);
}

TEST(Distance, TurnsTheSecondBodyBeforeItIsMoved) {
    expect_distance(
        measure({"box:10,10,10", "cylinder:5,20", "--move", "20,0,0", "--rotate", "0,90,0"}),
        20.0 - 5.0 - 10.0);
    expect_distance(measure({"box:10,10,10", "cylinder:5,20", "--move", "20,0,0"}),
                    20.0 - 5.0 - 5.0);
    expect_distance(
        measure({"box:10,10,10", "box:10,10,10", "--move", "20,0,0", "--rotate", "0,0,45"}),
        15.0 - std::sqrt(50.0));
    // A corner of the cube points at the other: rotated about X by 45, then about Y by the angle
    // whose tangent is sqrt(2).
    const double tilt = std::atan(std::numbers::sqrt2) * 180.0 / std::numbers::pi;
    expect_distance(measure({"sphere:5", "box:10,10,10", "--move", "30,0,0", "--rotate",
                             "45," + std::to_string(tilt) + ",0"}),
                    25.0 - std::sqrt(75.0));
}

TEST(Distance, TurnsAboutXThenYThenZ) {
    // The rotation about X takes the long side from Z to -Y; the rotation about Y keeps it there.
    const double along_y =
        measure({"sphere:1", "box:2,4,20", "--move", "0,30,0", "--rotate", "90,90,0"})["upper"];
    EXPECT_NEAR(along_y, 30.0 - 1.0 - 10.0, 1e-6);
}

TEST(Distance, IsZeroForBodiesThatTouchOverlapOrContainOneAnother) {
    for (const char* move : {"0,0,0", "3,0,0", "20,0,0", "29.999,0,0"}) {
        const Json found = measure({"sphere:25", "sphere:5", "--move", move});
        EXPECT_EQ(found["lower"], 0.0) << move;
        EXPECT_LE(found["upper"].get<double>(), 1e-6) << move;
    }
    expect_distance(measure({"box:10,10,10", "box:10,10,10", "--move", "10,0,0"}), 0.0);
}

TEST(Distance, OfASweepIsTheLeastOnTheWay) {
    const Json found = measure({"sphere:5", "sphere:5", "--move=-20,13,0", "--sweep", "40,0,0"});
    expect_distance(found, 3.0);
    EXPECT_NEAR(found["at"].get<double>(), 0.5, 1e-6);
    const Json end = measure({"sphere:5", "sphere:5", "--move", "50,0,0", "--sweep", "-30,0,0"});
    expect_distance(end, 10.0);
    EXPECT_NEAR(end["at"].get<double>(), 1.0, 1e-6);
    const Json start = measure({"sphere:5", "sphere:5", "--move", "20,0,0", "--sweep", "30,0,0"});
    expect_distance(start, 10.0);
    EXPECT_NEAR(start["at"].get<double>(), 0.0, 1e-6);
}

TEST(Distance, FindsThePassageThroughABodyBetweenTheEndsOfASweep) {
    const Json found = measure({"box:1,50,50", "sphere:1", "--move=-20,0,0", "--sweep", "40,0,0"});
    EXPECT_EQ(found["lower"], 0.0);
    EXPECT_EQ(found["upper"], 0.0);
}

TEST(Distance, OfScanPointsIsTheSameByEitherEngineToTheLastBit) {
    const ScopedFolder folder;
    const core::Mesh ring = test_support::torus_mesh(20.0, 6.0, 48, 24);
    const std::string mesh = folder.write("ring.stl", test_support::binary_stl(ring));
    for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
             {"sphere:25", "sphere:25", "--move", "49,17,10"},
             {"box:30,20,10", "cylinder:5,20", "--move", "25,9,8", "--rotate", "10,20,30"},
             {mesh, "box:9,9,9", "--move", "2,3,1", "--rotate", "40,-25,70", "--sweep", "1,7,3"}}) {
        const auto by = [&](const std::string& engine) {
            std::vector<std::string> all = words;
            all.insert(all.end(), {"--mesh-size", "1", "--engine", engine});
            const Json found = measure(all);
            EXPECT_EQ(found["engine"], engine);
            return found;
        };
        const Json fast = by("fast"), paper = by("paper");
        for (const char* key : {"distance", "lower", "upper", "witness", "at", "points"})
            EXPECT_EQ(fast[key], paper[key]) << key << " of " << words[1];
        EXPECT_GT(fast["distance"], 0.0);
        EXPECT_NE(fast["sphere_tests"], paper["sphere_tests"]); // so the engines differ
    }
    EXPECT_EQ(measure({"sphere:5", "sphere:5"})["engine"], "fast");
}

TEST(Distance, OfScanPointsHoldsForEveryMomentOfASweep) {
    // Poses one mesh size apart would miss the nearest one by 0.3 mm.
    const Json found = measure(
        {"sphere:5", "sphere:5", "--move=-20.3,13,0", "--sweep", "40,0,0", "--mesh-size", "1"});
    const Json nearest = measure({"sphere:5", "sphere:5", "--move", "0,13,0", "--mesh-size", "1"});
    EXPECT_NEAR(found["distance"].get<double>(), nearest["distance"].get<double>(), 1e-9);
}

TEST(Distance, ReadsMeshFiles) {
    const ScopedFolder folder;
    const core::Mesh box = test_support::box_mesh({0, 0, 0}, {20, 26, 42});
    const std::string binary = folder.write("clamp.stl", test_support::binary_stl(box));
    const std::string text = folder.write("text.stl", test_support::ascii_stl(box));
    expect_distance(measure({binary, "sphere:5", "--move", "-20,13,21"}), 15.0);
    expect_distance(measure({text, "sphere:5", "--move", "-3,-4,-12"}), 8.0);
    expect_distance(measure({binary, text, "--move", "30,36,0"}), std::hypot(10.0, 10.0));
}

TEST(Distance, IsSymmetric) {
    const Json ab = measure({"box:10,20,30", "cylinder:5,20", "--move", "30,20,10"});
    const Json ba = measure({"cylinder:5,20", "box:10,20,30", "--move", "-30,-20,-10"});
    EXPECT_NEAR(ab["upper"].get<double>(), ba["upper"].get<double>(), 1e-7);
}

TEST(Distance, IsReportedInWords) {
    const Ran ran = feeler({"distance", "sphere:5", "sphere:5", "--move", "20,0,0"});
    EXPECT_EQ(ran.status, 0);
    EXPECT_NE(ran.out.find("10.000000 mm"), std::string::npos) << ran.out;
    EXPECT_NE(ran.out.find("1896 and 1896 points"), std::string::npos) << ran.out;
    EXPECT_NE(ran.out.find("fast: "), std::string::npos) << ran.out;
    for (const char* not_told : {"sphere tests", "sweep"})
        EXPECT_EQ(ran.out.find(not_told), std::string::npos) << ran.out;
    const Ran paper = feeler({"distance", "sphere:5", "sphere:5", "--move", "20,0,0", "--sweep",
                              "1,1,0", "--engine", "paper"});
    EXPECT_NE(paper.out.find(" sphere tests"), std::string::npos) << paper.out;
    EXPECT_NE(paper.out.find(" at 0.0 % of the sweep"), std::string::npos) << paper.out;
}

TEST(Distance, RefusesInvalidBodies) {
    for (const char* body :
         {"sphere:0", "sphere:-1", "sphere:nan", "sphere:", "sphere:1,2", "sphere:5mm", "box:1,2",
          "box:1,2,0", "cylinder:5", "cone:3", "nope.stl", "", "sphere:1e9"}) {
        const Ran ran = feeler({"distance", body, "sphere:5"});
        EXPECT_EQ(ran.status, 2) << body;
        EXPECT_EQ(ran.out, "") << body;
        EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << body << ": " << ran.err;
    }
}

TEST(Distance, NamesTheFileAndTheLineOfAMistakeOnce) {
    const ScopedFolder folder;
    const std::string path = folder.write("box.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    const Ran ran = feeler({"distance", path, "sphere:5"});
    EXPECT_EQ(ran.status, 2);
    EXPECT_EQ(
        ran.err,
        fmt::format("feeler: {}: line 4: a face refers to vertex 9, but there are 3 vertices\n",
                    path));
}

TEST(Distance, RefusesAnUnknownEngine) {
    for (const char* engine : {"coproc", "Fast", ""}) {
        const Ran ran = feeler({"distance", "sphere:5", "sphere:5", "--engine", engine});
        EXPECT_EQ(ran.status, 2) << engine;
        EXPECT_NE(ran.err.find("--engine"), std::string::npos) << ran.err;
        EXPECT_NE(ran.err.find("{fast,paper}"), std::string::npos) << ran.err;
    }
}

TEST(Distance, RefusesInvalidVectors) {
    for (const char* option : {"--move", "--rotate", "--sweep"})
        for (const char* value : {"1,2", "1,2,3,4", "1,2,nan", "1,2,inf", "1,2,x", ""}) {
            const Ran ran = feeler({"distance", "sphere:5", "sphere:5", option, value});
            EXPECT_EQ(ran.status, 2) << option << " " << value;
            EXPECT_EQ(ran.out, "") << option << " " << value;
        }
}

} // namespace
} // namespace app_test
