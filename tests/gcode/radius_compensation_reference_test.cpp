#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "gcode/contour/radius_compensation.h"
#include "tests/support/scoped_folder.h"

namespace gcode {
namespace {

const std::filesystem::path canon =
    std::filesystem::path(FEELER_SOURCE_DIR) / "../shared/oracle/canon.py";

/// A contour as a LinuxCNC program, and the result of Feeler.
struct Sample {
    std::string program;
    CompensatedMoves moves{};
    bool refused = false;
};

struct Draw {
    std::mt19937_64 bits;

    double between(double low, double high) {
        return low + (high - low) * static_cast<double>(bits() >> 11) * 0x1p-53;
    }
    bool chance(double fraction) { return between(0.0, 1.0) < fraction; }
};

double rounded(double value) { return std::round(value * 1e9) * 1e-9; }

/// The next move from a point; sometimes tangential, reversing, or a full circle.
ContourMove next_move(Draw& draw, FlatPoint from, double& heading, bool first) {
    const double kind = draw.between(0.0, 1.0);
    if (kind > 0.3) heading += draw.between(-std::numbers::pi, std::numbers::pi);
    if (kind > 0.95) heading += std::numbers::pi;
    const FlatPoint way{std::cos(heading), std::sin(heading)};
    if (first || draw.chance(0.5)) {
        const FlatPoint end = from + draw.between(first ? 10.0 : 2.0, 25.0) * way;
        return {.rapid = draw.chance(0.1), .end = {rounded(end.u), rounded(end.v)}};
    }
    const int turns = draw.chance(0.5) ? 1 : -1;
    const FlatPoint to_centre = turns * draw.between(2.0, 20.0) * left_of(way);
    const FlatPoint offset{rounded(to_centre.u), rounded(to_centre.v)};
    const double sweep = draw.chance(0.1) ? 0.0 : turns * draw.between(0.1, 6.0);
    heading += sweep;
    const double c = std::cos(sweep), s = std::sin(sweep);
    const FlatPoint end =
        from + offset - FlatPoint{c * offset.u - s * offset.v, s * offset.u + c * offset.v};
    return {.end = {rounded(end.u), rounded(end.v)},
            .arc = FlatArc{from + offset, draw.chance(0.1) ? 2 * turns : turns}};
}

std::string block(const ContourMove& move, FlatPoint from) {
    if (!move.arc)
        return fmt::format("G{} X{:.9f} Y{:.9f}\n", move.rapid ? 0 : 1, move.end.u, move.end.v);
    const FlatPoint offset = move.arc->centre - from;
    return fmt::format("G{} X{:.9f} Y{:.9f} I{:.9f} J{:.9f} P{}\n", move.arc->turns > 0 ? 3 : 2,
                       move.end.u, move.end.v, offset.u, offset.v, std::abs(move.arc->turns));
}

Sample draw_sample(Draw& draw) {
    const bool on_left = draw.chance(0.5);
    const double radius = rounded(draw.between(0.3, 4.0));
    RadiusCompensation compensation =
        begin_compensation(on_left ? ContourSide::left : ContourSide::right, radius, {});
    Sample sample{fmt::format("G0 X0 Y0\nG4{}.1 D{:.9f}\n", on_left ? 1 : 2, 2.0 * radius)};
    const auto take = [&sample](const core::Result<CompensatedMoves>& moves) {
        sample.refused = sample.refused || !moves;
        if (moves) sample.moves.insert(sample.moves.end(), moves->begin(), moves->end());
    };
    FlatPoint at;
    double heading = draw.between(-3.0, 3.0);
    const int count = 2 + static_cast<int>(draw.between(0.0, 5.0));
    for (int i = 0; i < count && !sample.refused; ++i) {
        const ContourMove move = next_move(draw, at, heading, i == 0);
        sample.program += block(move, at);
        take(add_move(compensation, move));
        at = move.end;
    }
    if (!sample.refused) take(end_compensation(compensation));
    sample.program += "G40\n";
    return sample;
}

/// The output of canon.py for a program; `status` is 0 if it ran to its end.
std::vector<std::string> reference_lines(const std::string& program, int& status) {
    const test_support::ScopedFolder folder;
    const std::filesystem::path path = folder.path() / "contours.ngc";
    const std::filesystem::path listing = folder.path() / "contours.txt";
    std::ofstream(path) << "G21 G17 G90 F100\n" << program << "G0 X0 Y0\nM2\n";
    status =
        std::system(fmt::format("/usr/bin/python3 '{}' '{}' > '{}' 2> '{}.err'", canon.string(),
                                path.string(), listing.string(), listing.string())
                        .c_str());
    std::vector<std::string> lines;
    std::ifstream in(listing);
    for (std::string line; std::getline(in, line);)
        if (line.find(" straight_") != line.npos || line.find(" arc_feed") != line.npos)
            lines.push_back(line);
    return lines;
}

constexpr double inch = 25.4;

testing::AssertionResult equals(const CompensatedMove& move, const std::string& line) {
    std::istringstream words(line);
    int number = 0;
    std::string call;
    double u = 0.0, v = 0.0, centre_u = 0.0, centre_v = 0.0;
    int turns = 0;
    words >> number >> call >> u >> v;
    if (call == "arc_feed") words >> centre_u >> centre_v >> turns;
    const FlatPoint missed{move.end.u - inch * u, move.end.v - inch * v};
    const std::string own = move.arc     ? "arc_feed"
                            : move.rapid ? "straight_traverse"
                                         : "straight_feed";
    bool equal = call == own && length(missed) < 1e-6;
    if (equal && move.arc)
        equal = turns == move.arc->turns
                && length(move.arc->centre - FlatPoint{inch * centre_u, inch * centre_v}) < 1e-6;
    if (equal) return testing::AssertionSuccess();
    return testing::AssertionFailure()
           << own << " to " << move.end.u << ' ' << move.end.v << ", reference: " << line;
}

class ReferenceCompensation : public testing::Test {
protected:
    void SetUp() override {
        const bool there =
            std::filesystem::exists("/usr/bin/rs274") && std::filesystem::exists(canon);
        if (there) return;
        if (std::getenv("FEELER_REQUIRE_SHARED")) FAIL() << "rs274 or " << canon << " is missing";
        GTEST_SKIP() << "rs274 or " << canon << " is missing";
    }
};

TEST_F(ReferenceCompensation, MakesTheSameMoves) {
    Draw draw{std::mt19937_64(20261121)};
    std::string program;
    std::vector<CompensatedMoves> contours;
    size_t arcs = 0, corners = 0;
    while (contours.size() < 3000) {
        const Sample sample = draw_sample(draw);
        if (sample.refused) continue;
        program += sample.program;
        contours.push_back(sample.moves);
        for (const CompensatedMove& move : sample.moves) {
            arcs += move.arc.has_value();
            corners += move.rounds_corner;
        }
    }
    EXPECT_GT(arcs, 3000u);
    EXPECT_GT(corners, 1500u);
    int status = 0;
    const std::vector<std::string> lines = reference_lines(program, status);
    EXPECT_EQ(status, 0);
    size_t next = 0;
    for (const CompensatedMoves& contour : contours) {
        ++next; // the rapid to the start
        for (const CompensatedMove& move : contour) {
            ASSERT_LT(next, lines.size());
            ASSERT_TRUE(equals(move, lines[next++])) << "call " << next;
        }
    }
}

TEST_F(ReferenceCompensation, RefusesTheSameContours) {
    Draw draw{std::mt19937_64(4)};
    int refused = 0;
    while (refused < 25) {
        const Sample sample = draw_sample(draw);
        if (!sample.refused) continue;
        ++refused;
        int status = 0;
        const std::vector<std::string> lines = reference_lines(sample.program, status);
        EXPECT_NE(status, 0) << sample.program;
        EXPECT_EQ(lines.size(), sample.moves.size() + 1) << sample.program;
    }
}

} // namespace
} // namespace gcode
