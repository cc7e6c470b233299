#include <cmath>
#include <complex>
#include <optional>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "gcode/cycles/turning_cycle.h"
#include "tests/support/reference.h"

namespace gcode {
namespace {

/// A shaft of radius 10, 10 long, followed by a cone up to radius 16.
const TurningContour shaft = {{{10, 0}}, {{10, -10}}, {{16, -16}}, {{18, -16}}};

/// The arc with this radius between two points: the shorter one.
std::optional<TurningArc> turning_arc_from_radius(TurningPoint start, TurningPoint end,
                                                  double radius, bool counterclockwise) {
    const std::complex<double> from(start.z, start.x), to(end.z, end.x);
    const double square = radius * radius / std::norm(to - from) - 0.25;
    if (!(square >= 0.0)) return std::nullopt;
    const auto aside = std::complex<double>(0, 1) * std::sqrt(square) * (to - from);
    const auto centre = (from + to) / 2.0 + (counterclockwise ? aside : -aside);
    return TurningArc{{centre.imag(), centre.real()}, counterclockwise};
}

TurningMove rapid(double x, double z) { return {{x, z}, true}; }
TurningMove feed(double x, double z) { return {{x, z}, false}; }

TEST(Roughing, CutsLevelsUntilTheContourIsReached) {
    // From X18 in steps of 4: the levels 18, 14 and 10. The lead-in is a line from (18, 4) to (10,
    // 0), on the cone Z = -X; each cut retracts by 1.
    RoughingWords words;
    words.depth = 4.0;
    words.retract = 1.0;
    const auto moves = roughing_moves({18, 4}, shaft, words);
    ASSERT_TRUE(moves) << moves.error().message;
    const TurningMoves expected = {rapid(18, 4),   rapid(18, 4),  feed(18, -16), rapid(19, -15),
                                   rapid(19, 3),   rapid(18, 4),  rapid(14, 2),  feed(14, -14),
                                   rapid(15, -13), rapid(15, 1),  rapid(14, 2),  rapid(10, 0),
                                   feed(10, -10),  feed(16, -16), feed(18, -16)};
    EXPECT_EQ(*moves, expected);
}

TEST(Finishing, ComesNearerWithEachPass) {
    const TurningContour step = {{{10, 0}}, {{10, -10}}, {{20, -10}}};
    const auto moves = finishing_moves({22, 2}, step, {2.0, 0.5, 2.0});
    ASSERT_TRUE(moves) << moves.error().message;
    // Distances: 0.5 + (2 - 0.5) / 2 = 1.25, then 0.5; the shoulder at Z-10 moves to Z+.
    const TurningMoves expected = {rapid(22, 2),     rapid(11.25, 0), feed(11.25, -8.75),
                                   feed(20, -8.75),  rapid(22, 2),    rapid(10.5, 0),
                                   feed(10.5, -9.5), feed(20, -9.5)};
    EXPECT_EQ(*moves, expected);
}

TEST(Finishing, RoundsAndChamfersCorners) {
    TurningContour corner = {{{10, 0}}, {{10, -10}}, {{20, -10}}};
    corner[1].corner = CornerShape::fillet;
    corner[1].corner_size = 2.0;
    const auto fillet = finishing_moves({22, 2}, corner, {});
    ASSERT_TRUE(fillet) << fillet.error().message;
    ASSERT_EQ(fillet->size(), 5u);
    EXPECT_EQ((*fillet)[2], feed(10, -8));
    EXPECT_EQ((*fillet)[3], (TurningMove{{12, -10}, false, TurningArc{{12, -8}, false}}));
    corner[1].corner = CornerShape::chamfer;
    const auto chamfer = finishing_moves({22, 2}, corner, {});
    ASSERT_TRUE(chamfer) << chamfer.error().message;
    EXPECT_EQ((*chamfer)[3], feed(12, -10));
}

TEST(Roughing, HasNoMovesForASingleSegment) {
    EXPECT_TRUE(roughing_moves({18, 4}, {{{10, 0}}}, {})->empty());
    EXPECT_TRUE(finishing_moves({18, 4}, {}, {})->empty());
}

TEST(Roughing, RefusesADepthOfNothing) {
    RoughingWords words;
    words.depth = 0.0;
    EXPECT_FALSE(roughing_moves({18, 4}, shaft, words));
}

TEST(Roughing, RefusesAContourThatTurnsBack) {
    const TurningContour back = {{{10, 0}}, {{10, -10}}, {{14, -5}}, {{18, -16}}};
    EXPECT_FALSE(roughing_moves({18, 4}, back, {}));
    EXPECT_TRUE(finishing_moves({18, 4}, back, {})); // it runs in one direction in X
    const TurningContour both = {{{10, 0}}, {{10, -10}}, {{14, -5}}, {{12, -16}}, {{18, -16}}};
    EXPECT_FALSE(finishing_moves({18, 4}, both, {}));
}

TEST(Roughing, RefusesAnAllowanceBetweenParallelLines) {
    const TurningContour straight = {{{10, 0}}, {{10, -5}}, {{10, -10}}, {{18, -10}}};
    RoughingWords words;
    EXPECT_TRUE(roughing_moves({18, 4}, straight, words));
    words.allowance = 1.0;
    EXPECT_FALSE(roughing_moves({18, 4}, straight, words));
}

TEST(Roughing, InchesAreTwinsOfMillimetres) {
    TurningContour in_inches = shaft;
    for (TurningSegment& segment : in_inches)
        segment.end = {segment.end.x * 25.4, segment.end.z * 25.4};
    const auto mm = roughing_moves({18, 4}, shaft, {});
    const auto inch = roughing_moves({18 * 25.4, 4 * 25.4}, in_inches, {}, 25.4);
    ASSERT_TRUE(mm && inch);
    ASSERT_EQ(mm->size(), inch->size());
    for (size_t i = 0; i < mm->size(); ++i)
        EXPECT_NEAR((*mm)[i].end.x * 25.4, (*inch)[i].end.x, 1e-9);
}

TEST(Roughing, EndsWhereTheReferenceDoesNot) {
    // Steps of 0.1 below an arc that turns back: LinuxCNC cuts X17.3 forever.
    const auto arc = [](TurningPoint from, TurningPoint to, double radius, bool ccw) {
        return *turning_arc_from_radius(from, to, radius, ccw);
    };
    const TurningContour contour = {
        {{7, -3.8}},    {{16, -3.8}},
        {{21.2, -0.4}}, {{22.8, 7}, arc({21.2, -0.4}, {22.8, 7}, 5.3535035257296695, true)},
        {{30.8, 14.8}}, {{36.4, 22.2}, arc({30.8, 14.8}, {36.4, 22.2}, 6.562011886609166, true)},
        {{39, 22.8}},   {{41, 28}, arc({39, 22.8}, {41, 28}, 3.939543120718442, false)}};
    RoughingWords words;
    words.pockets = PocketCutting::none;
    words.allowance = 1.8;
    words.depth = 0.1;
    EXPECT_FALSE(roughing_moves({43, -3.8}, contour, words));
    EXPECT_FALSE(roughing_moves({18, 4}, TurningContour(greatest_contour + 1, {{1, 1}}), {}));
    EXPECT_FALSE(finishing_moves({22, 2}, {{{10, 0}}, {{10, -10}}}, {0, 0, 1e300}));
}

TEST(TurningArc, RadiusMustReachTheEnd) {
    EXPECT_FALSE(turning_arc_from_radius({10, 0}, {20, 0}, 4.9, true));
    const auto arc = turning_arc_from_radius({10, -10}, {15, -15}, 5.0, false);
    ASSERT_TRUE(arc);
    EXPECT_NEAR(arc->centre.x, 15.0, 1e-12);
    EXPECT_NEAR(arc->centre.z, -10.0, 1e-12);
}

struct TurningCase {
    std::string program;
    core::Result<TurningMoves> ours;
};

class TurningGenerator {
public:
    explicit TurningGenerator(unsigned seed) : rng_(seed) {}

    TurningCase next() {
        contour_.clear();
        program_ = "O100 SUB\n";
        toward_z_ = pick(0, 1) ? 1.0 : -1.0;
        toward_x_ = pick(0, 3) ? 1.0 : -1.0;
        at_ = {pick(0, 100) / 5.0, pick(-20, 20) / 5.0};
        line(at_);
        for (int i = pick(1, 7); i > 0; --i) segment();
        program_ += "O100 ENDSUB\nG21 G90 G18 F100\n";
        start_ = {tenths(at_.x + toward_x_ * pick(-5, 50) / 10.0),
                  tenths(contour_.front().end.z - toward_z_ * pick(-5, 30) / 10.0)};
        program_ += fmt::format("G0 X{:.1f} Z{:.1f}\n", start_.x, start_.z);
        return cycle();
    }

private:
    int pick(int low, int high) { return std::uniform_int_distribution<int>(low, high)(rng_); }

    /// The nearest number with one decimal.
    static double tenths(double value) { return std::round(value * 10.0) / 10.0; }

    void line(TurningPoint end) {
        contour_.push_back({end});
        program_ += fmt::format("G1 X{:.1f} Z{:.1f}", end.x, end.z);
        if (pick(0, 7) == 0) {
            contour_.back().corner_size = pick(0, 20) / 10.0;
            contour_.back().corner = pick(0, 1) ? CornerShape::fillet : CornerShape::chamfer;
            const char letter = contour_.back().corner == CornerShape::fillet ? 'A' : 'C';
            program_ += fmt::format(" {}{}", letter, contour_.back().corner_size);
        }
        program_ += "\n";
        at_ = end;
    }
    void segment() {
        const double dz = toward_z_ * pick(pick(0, 9) ? 0 : -5, 50) / 5.0;
        const double dx = toward_x_ * pick(pick(0, 2) ? 0 : -30, 50) / 5.0;
        const TurningPoint end{tenths(at_.x + dx), tenths(at_.z + dz)};
        if (end == at_) return;
        if (pick(0, 2) > 0) return line(end);
        arc(end);
    }
    void arc(TurningPoint end) {
        const bool ccw = pick(0, 1);
        const double length = std::hypot(end.x - at_.x, end.z - at_.z);
        const double radius = length * (pick(0, 3) ? std::sqrt(0.5) : pick(51, 200) / 100.0);
        const auto made = turning_arc_from_radius(at_, end, radius, ccw);
        if (!made) return;
        contour_.push_back({end, *made});
        program_ += fmt::format("G{} X{:.1f} Z{:.1f} R{}\n", ccw ? 3 : 2, end.x, end.z, radius);
        at_ = end;
    }
    double say(char letter, double value) {
        program_ += fmt::format(" {}{}", letter, value);
        return value;
    }
    TurningCase cycle() {
        const int kind = pick(0, 2), digit = kind ? pick(0, 2) : 0;
        program_ += fmt::format("G7{}{} Q100", kind, digit ? fmt::format(".{}", digit) : "");
        const double d = pick(0, 2) ? say('D', pick(-10, 20) / 10.0) : 0.0;
        core::Result<TurningMoves> moves;
        if (kind == 0) {
            FinishingWords words{d};
            if (pick(0, 1)) words.last_distance = say('E', pick(0, 10) / 10.0);
            if (pick(0, 1)) words.passes = say('P', pick(0, 30) / 10.0);
            moves = finishing_moves(start_, contour_, words);
        } else {
            RoughingWords words{kind == 2, static_cast<PocketCutting>(digit), d};
            if (pick(0, 3)) words.depth = say('I', pick(0, 40) / 10.0);
            if (pick(0, 1)) words.retract = say('R', pick(1, 10) / 10.0);
            if (pick(0, 3) == 0) words.shift_x = say('U', pick(-5, 5) / 10.0);
            if (pick(0, 3) == 0) words.shift_z = say('W', pick(-5, 5) / 10.0);
            moves = roughing_moves(start_, contour_, words);
        }
        return {program_ + "\nM2\n", std::move(moves)};
    }

    std::mt19937 rng_;
    std::string program_;
    TurningContour contour_;
    TurningPoint at_, start_;
    double toward_z_ = -1.0, toward_x_ = 1.0;
};

void expect_same_move(const TurningMove& ours, const test_support::ReferenceMotion& theirs) {
    constexpr double tolerance = 1e-6;
    if (!ours.arc) {
        ASSERT_EQ(theirs.call, ours.rapid ? "straight_traverse" : "straight_feed");
        EXPECT_NEAR(ours.end.x, theirs.values[0], tolerance);
        EXPECT_NEAR(ours.end.z, theirs.values[2], tolerance);
        return;
    }
    ASSERT_EQ(theirs.call, "arc_feed");
    EXPECT_NEAR(ours.end.z, theirs.values[0], tolerance);
    EXPECT_NEAR(ours.end.x, theirs.values[1], tolerance);
    EXPECT_NEAR(ours.arc->centre.z, theirs.values[2], tolerance);
    EXPECT_NEAR(ours.arc->centre.x, theirs.values[3], tolerance);
    EXPECT_EQ(ours.arc->counterclockwise ? 1 : -1, theirs.values[4]);
}

/// Whether the reference rejected an arc of the cycle; in Feeler the interpreter does that.
bool refused_an_arc(const test_support::ReferenceRun& run) {
    return run.refusal.find("adius") != std::string::npos;
}

TEST(TurningCycle, AgreesWithTheReferenceOnRandomContours) {
    if (!test_support::reference_is_installed()) GTEST_SKIP() << "rs274 is not installed";
    TurningGenerator generator(71);
    std::vector<TurningCase> cases;
    std::vector<std::string> programs;
    std::vector<size_t> may_be_endless; // whether these end or not, they must be refused
    for (size_t i = 0; i < 500; ++i) {
        cases.push_back(generator.next());
        programs.push_back(cases.back().program);
        if (!cases.back().ours) may_be_endless.push_back(i);
    }
    const auto runs = test_support::run_reference(programs, may_be_endless);
    ASSERT_EQ(runs.size(), cases.size());
    size_t refused = 0, endless = 0, arcs = 0;
    for (size_t i = 0; i < cases.size(); ++i) {
        SCOPED_TRACE(cases[i].program);
        endless += runs[i].refusal == "did not end";
        refused += !cases[i].ours;
        if (refused_an_arc(runs[i]))
            ASSERT_TRUE(cases[i].ours) << cases[i].ours.error().message;
        else
            ASSERT_EQ(runs[i].refusal.empty(), cases[i].ours.has_value())
                << runs[i].refusal << (cases[i].ours ? "" : "; " + cases[i].ours.error().message);
        if (!cases[i].ours) continue;
        // A rapid to the start, and another one for the cycle.
        const size_t lead = 2, count = runs[i].motions.size();
        for (size_t k = lead; k < std::min(count, cases[i].ours->size() + lead); ++k) {
            SCOPED_TRACE(fmt::format("move {}", k));
            arcs += (*cases[i].ours)[k - lead].arc.has_value();
            expect_same_move((*cases[i].ours)[k - lead], runs[i].motions[k]);
            if (HasFailure()) return;
        }
        if (refused_an_arc(runs[i]))
            EXPECT_LT(count, cases[i].ours->size() + lead);
        else
            EXPECT_EQ(count, cases[i].ours->size() + lead);
        if (HasFailure()) return;
    }
    EXPECT_GT(endless, 2u);
    EXPECT_GT(refused, 100u);
    EXPECT_LT(refused, 400u);
    EXPECT_GT(arcs, 100u);
}

} // namespace
} // namespace gcode
