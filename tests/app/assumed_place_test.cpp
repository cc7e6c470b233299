#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/checked.h"

namespace app_test {
namespace {

using nlohmann::json;
using test_support::ScopedFolder;

const std::string tool = "[[tool]]\nnumber = 1\nshape = \"flat\"\ndiameter = 10\n"
                         "flute_length = 25\nstick_out = 40\n";
const std::string stock = "[stock]\nbox = [[0, 0, -20], [50, 50, 0]]\n";
const std::string stop = "[[fixture]]\nname = \"stop\"\nbox = [[56, 0, -20], [64, 50, 5]]\n";
const std::string linuxcnc = "[program]\ndialect = \"linuxcnc\"\n";

json checked(const std::string& program, const std::string& setup) {
    const ScopedFolder folder;
    const test_support::Ran ran = feeler({"check", folder.write("p.nc", program), "--setup",
                                          folder.write("p.toml", setup), "--format", "json"});
    json report = json::parse(ran.out, nullptr, false);
    EXPECT_FALSE(report.is_discarded()) << ran.err;
    return report;
}

bool assumes(const json& report, const std::string& words) {
    for (const std::string each : report["assumptions"])
        if (each.find(words) != std::string::npos) return true;
    return false;
}

/// Blocks that begin with `select`, a work offset, and feed along X to `end`, next to the stop.
std::string program(const std::string& before, const std::string& select, double end) {
    return "G21 G90 G17\n" + before + "T1 M6\nS3000 M3\n" + select
           + "\nG0 G43 H1 X-20. Y10. Z20.\nZ-5.\n" + fmt::format("G1 X{:.3f} F300\nG0 Z20.\n", end);
}

const std::string end = "M5\nM30\n";

/// Line, rule, and clearance of every block in which the stop is nearest.
std::string at_the_stop(const json& report) {
    std::string lines;
    for (const json& finding : report["findings"])
        if (finding.value("pair", json()) == json({"flutes", "stop"}))
            lines += fmt::format("{} {}\n", finding["line"].get<int>(),
                                 finding["rule"].get<std::string>());
    for (const json& block : report["blocks"])
        if (block.value("pair", json()) == json({"flutes", "stop"}))
            lines += fmt::format("{} {:.5f} {:.5f}\n", block["line"].get<int>(),
                                 block["clearance"]["lower"].get<double>(),
                                 block["clearance"]["upper"].get<double>());
    return lines;
}

TEST(AssumedPlace, OfBodiesIsWhereTheProgramSetsTheirWorkOffset) {
    std::mt19937 rng(5);
    std::uniform_real_distribution<double> place(-400.0, 0.0), turn(-180.0, 180.0), to(40.0, 62.0);
    for (int i = 0; i < 40; ++i) {
        const int number = i % 3 == 2 ? 2 : 1;
        const std::string name = fmt::format("G{}", 53 + number);
        const std::string frame = number == 1 ? "" : "frame = \"" + name + "\"\n";
        const double x = place(rng), y = place(rng), z = place(rng) - 200.0;
        const bool has_stock = i % 5 != 0; // the inferred one is not turned
        const double angle = i % 2 == 0 || !has_stock ? 0.0 : turn(rng), last = to(rng);
        const std::string set =
            fmt::format("G10 L2 P{} X{:.4f} Y{:.4f} Z{:.4f} R{:.4f}\n", number, x, y, z, angle);
        const std::string setup = linuxcnc + tool + (has_stock ? stock + frame : "") + stop + frame;
        const json moved = checked(program(set, name, last) + end, setup);
        const json still = checked(program("G10 L2 P6 X-1.\n", name, last) + end, setup);
        EXPECT_NE(at_the_stop(moved), "") << set;
        EXPECT_EQ(at_the_stop(moved), at_the_stop(still)) << set << setup;
        EXPECT_EQ(moved["verdict"] == "collision", last + 5.0 > 56.0) << set << last;
        EXPECT_EQ(moved["coverage"]["offsets"], "inferred");
        EXPECT_TRUE(assumes(moved, "where the program sets " + name + " itself")) << set;
        EXPECT_FALSE(assumes(still, "where the program sets"));
        if (angle != 0.0) continue;
        const std::string stated = fmt::format(
            "[offsets]\n{} = {{ X = {:.4f}, Y = {:.4f}, Z = {:.4f} }}\n", name, x, y, z);
        EXPECT_EQ(at_the_stop(moved),
                  at_the_stop(checked(program(set, name, last) + end, setup + stated)))
            << set << setup << stated;
    }
}

TEST(AssumedPlace, IsTheFirstIfTheProgramSetsSeveral) {
    const auto at = [](double x) { return fmt::format("G10 L2 P1 X{} Y-200. Z-400.\n", x); };
    const json run =
        checked(program(at(-300.0), "G54", 60.0) + program(at(-100.0), "G54", 60.0) + end,
                linuxcnc + tool + stock + stop);
    EXPECT_EQ(run["verdict"], "collision");
    EXPECT_EQ(run["findings"][0]["line"], 8);
    EXPECT_TRUE(assumes(run, "sets G54 to more than one place"));
    EXPECT_FALSE(assumes(run, "where the program sets G54 itself"));
}

TEST(AssumedPlace, OfBodiesInOneOfTwoWorkOffsetsIsThere) {
    // G55 cuts more, so the inferred stock is there.
    const auto both = [](double g54, double g55) {
        return "G61\n" + program("", "G54", g54) + program("", "G55", g55) + "G1 X0.\nX20.\n" + end;
    };
    const auto with_stop = [](const std::string& frame) { return linuxcnc + tool + stop + frame; };
    const std::string g54 = "frame = \"G54\"\n", g55 = "frame = \"G55\"\n";
    const auto verdict = [&](double to_54, double to_55, const std::string& frame) {
        return checked(both(to_54, to_55), with_stop(frame))["verdict"].get<std::string>();
    };
    EXPECT_EQ(verdict(60.0, 45.0, g54), "collision");
    EXPECT_EQ(verdict(45.0, 60.0, g54), "clear");
    EXPECT_EQ(verdict(45.0, 60.0, g55), "collision");
    EXPECT_EQ(verdict(60.0, 45.0, g55), "clear");
    // Where nothing names the work offset, it is that of the stock.
    EXPECT_EQ(verdict(45.0, 60.0, ""), "collision");
    EXPECT_EQ(verdict(60.0, 45.0, ""), "clear");
    // Nothing is known of a work offset in which the program does not cut.
    EXPECT_EQ(verdict(45.0, 60.0, "frame = \"G57\"\n"), "collision");
}

TEST(AssumedPlace, OfTheOnlyBodyIsWhereTheProgramSetsItsWorkOffset) {
    const std::string setup =
        linuxcnc + "[offsets]\nG55 = { X = -10, Y = -10, Z = -400 }\n" + stock;
    const std::string g54 = "G10 L2 P1 X-300. Y-200. Z-350.\n";
    const json run = checked(program(g54, "G54", 45.0) + end, setup);
    EXPECT_EQ(run["verdict"], "clear") << run["findings"];
    EXPECT_GT(run["blocks"][7].value("removed", 0.0), 1000.0) << run["blocks"];
}

} // namespace
} // namespace app_test
