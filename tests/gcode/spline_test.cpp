#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "gcode/contour/spline.h"
#include "tests/support/reference.h"

namespace gcode {
namespace {

void expect_near(SplinePoint found, SplinePoint expected, double tolerance = 1e-12) {
    EXPECT_NEAR(found.x, expected.x, tolerance);
    EXPECT_NEAR(found.y, expected.y, tolerance);
}

/// The ends of the straight feed moves with which LinuxCNC's preview follows a curve: 15 for each
/// control point, at equal steps of the parameter; empty if weights cancel out.
std::vector<SplinePoint> preview_chords(const NurbsCurve& curve) {
    const double last = curve.spans();
    const double step = last / static_cast<double>(curve.points.size() * 15);
    std::vector<SplinePoint> chords;
    // The parameter is accumulated, not multiplied: whether the sum is still below the last knot
    // after the last step but one decides whether there is one more chord.
    for (double parameter = step; parameter < last; parameter += step) {
        const SplinePoint at = point_at(curve, parameter);
        if (!std::isfinite(at.x) || !std::isfinite(at.y)) return {};
        chords.push_back(at);
    }
    chords.push_back(curve.points.back().at);
    return chords;
}

NurbsGathering gathered(const std::vector<ControlPointWords>& blocks) {
    NurbsGathering gathering;
    for (const ControlPointWords& words : blocks)
        EXPECT_TRUE(add_control_point(gathering, {0, 0}, words));
    return gathering;
}

TEST(Spline, CubicRunsThroughItsMiddle) {
    // Bezier of (0 0) (0 8) (8 8) (8 0): the middle is (p0 + 3 p1 + 3 p2 + p3) / 8 = (4, 6).
    const auto spline = cubic_spline({0, 0}, {}, {0.0, 8.0, 0.0, 8.0, {8, 0}});
    ASSERT_TRUE(spline);
    expect_near(point_at(spline->curve, 0.5), {4, 6});
    expect_near(point_at(spline->curve, 0.0), {0, 0});
    expect_near(point_at(spline->curve, 1.0), {8, 0});
    EXPECT_EQ(spline->next_tangent, (SplinePoint{0, -8}));
}

TEST(Spline, CubicContinuesInTheLastDirectionWithoutIAndJ) {
    const auto spline = cubic_spline({8, 0}, {0, -8}, {{}, {}, 1.0, 2.0, {20, 0}});
    ASSERT_TRUE(spline);
    EXPECT_EQ(spline->curve.points[1].at, (SplinePoint{8, -8}));
    EXPECT_EQ(spline->curve.points[2].at, (SplinePoint{21, 2}));
}

TEST(Spline, RefusesHalfATangent) {
    EXPECT_FALSE(cubic_spline({}, {}, {1.0, {}, 1.0, 1.0, {8, 0}}));
    EXPECT_FALSE(cubic_spline({}, {}, {{}, 1.0, 1.0, 1.0, {8, 0}}));
    EXPECT_FALSE(cubic_spline({}, {}, {1.0, 1.0, {}, 1.0, {8, 0}}));
    EXPECT_FALSE(cubic_spline({}, {}, {1.0, 1.0, 1.0, {}, {8, 0}}));
    EXPECT_FALSE(quadratic_spline({}, 1.0, {}, {8, 0}));
    EXPECT_FALSE(quadratic_spline({}, {}, 1.0, {8, 0}));
}

TEST(Spline, QuadraticIsAParabola) {
    // (0 0) (2 4) (4 0): x = 4 t, y = 8 t (1 - t), so y = x (4 - x) / 2.
    const auto curve = quadratic_spline({0, 0}, 2.0, 4.0, {4, 0});
    ASSERT_TRUE(curve);
    const auto chords = preview_chords(*curve);
    EXPECT_EQ(chords.size(), 45u);
    for (const SplinePoint p : chords) EXPECT_NEAR(p.y, p.x * (4.0 - p.x) / 2.0, 1e-12);
}

TEST(Nurbs, WeightsMakeAQuarterOfACircle) {
    // The usual quarter circle: (1 0) (1 1) (0 1) with weights 1, 1/sqrt 2, 1.
    const NurbsCurve curve{{{{1, 0}, 1.0}, {{1, 1}, std::sqrt(0.5)}, {{0, 1}, 1.0}}, 3};
    for (int i = 0; i <= 10; ++i) {
        const SplinePoint p = point_at(curve, 0.1 * i);
        EXPECT_NEAR(std::hypot(p.x, p.y), 1.0, 1e-12);
    }
}

TEST(Nurbs, PassesHalfWayBetweenControlPointsAtAKnot) {
    // At order 3 with equal weights, a whole parameter is the midpoint of two inner control points.
    const auto curve =
        finish_nurbs(gathered({{0.0, 1.0, 1.0, 3}, {2.0, 2.0, 1.0, {}}, {2.0, 0.0, 1.0, {}}}));
    ASSERT_TRUE(curve);
    EXPECT_EQ(curve->spans(), 2);
    expect_near(point_at(*curve, 1.0), {1.0, 1.5});
}

TEST(Nurbs, StartTakesTheWeightOfABlockWithoutEnds) {
    EXPECT_EQ(gathered({{{}, {}, 2.0, 4}}).points, (std::vector<ControlPoint>{{{0, 0}, 2.0}}));
    EXPECT_EQ(gathered({{{}, {}, {}, 4}}).points, (std::vector<ControlPoint>{{{0, 0}, 1.0}}));
    EXPECT_EQ(gathered({{1.0, 2.0, 3.0, {}}}).points,
              (std::vector<ControlPoint>{{{0, 0}, 1.0}, {{1, 2}, 3.0}}));
    EXPECT_EQ(gathered({{1.0, 2.0, {}, {}}}).points[1].weight, -1.0);
}

TEST(Nurbs, OrderIsTheLastLAboveThree) {
    EXPECT_EQ(gathered({{1.0, 2.0, 1.0, 2}}).order, 3);
    EXPECT_EQ(gathered({{1.0, 2.0, 1.0, 4}, {1.0, 3.0, 1.0, 3}}).order, 4);
    EXPECT_EQ(gathered({{1.0, 2.0, 1.0, 5}, {1.0, 3.0, 1.0, 4}}).order, 4);
}

TEST(Nurbs, RefusalsChangeNothing) {
    NurbsGathering gathering = gathered({{1.0, 2.0, 1.0, 4}});
    const NurbsGathering before = gathering;
    EXPECT_FALSE(add_control_point(gathering, {}, {1.0, {}, 1.0, {}}));
    EXPECT_FALSE(add_control_point(gathering, {}, {{}, 1.0, 1.0, {}}));
    EXPECT_FALSE(add_control_point(gathering, {}, {{}, {}, 1.0, {}}));
    EXPECT_FALSE(add_control_point(gathering, {}, {1.0, 1.0, {}, {}}));
    EXPECT_FALSE(add_control_point(gathering, {}, {1.0, 1.0, 0.0, {}}));
    EXPECT_FALSE(add_control_point(gathering, {}, {1.0, 1.0, 1.0, greatest_nurbs_order + 1}));
    EXPECT_EQ(gathering, before);
    EXPECT_FALSE(finish_nurbs(gathering));
    EXPECT_FALSE(finish_nurbs({}));
}

TEST(Nurbs, RefusesWeightsThatCancel) {
    // Weights 1 and -1 of a straight line cancel out at its midpoint.
    EXPECT_FALSE(chords_within({{{{0, 0}, 1.0}, {{1, 0}, -1.0}}, 2}, 0.01));
}

/// A program with splines and our chords for it; empty if Feeler reports an error.
struct SplineCase {
    std::string program;
    std::optional<std::vector<SplinePoint>> chords;
};

class SplineGenerator {
public:
    explicit SplineGenerator(unsigned seed) : rng_(seed) {}

    SplineCase next() {
        start_ = {number(), number()};
        program_ = fmt::format("G21 G90 G17 F100\nG0 X{} Y{}\n", start_.x, start_.y);
        const int kind = pick(3);
        const auto chords = kind == 0 ? cubics() : kind == 1 ? quadratic() : nurbs();
        return {program_ + "M2\n", chords};
    }

private:
    using Chords = std::optional<std::vector<SplinePoint>>;

    int pick(int count) { return std::uniform_int_distribution<int>(0, count - 1)(rng_); }
    double number() { return std::uniform_int_distribution<int>(-500, 500)(rng_) / 10.0; }
    /// A word, sometimes missing.
    std::optional<double> word(char letter, double value, int rarity = 12) {
        if (pick(rarity) == 0) return {};
        program_ += fmt::format(" {}{}", letter, value);
        return value;
    }
    SplinePoint end() {
        const SplinePoint p{number(), number()};
        program_ += fmt::format(" X{} Y{}", p.x, p.y);
        return p;
    }
    static void append(std::vector<SplinePoint>& all, const NurbsCurve& curve) {
        const auto chords = preview_chords(curve);
        all.insert(all.end(), chords.begin(), chords.end());
    }

    Chords cubics() {
        std::vector<SplinePoint> all;
        SplinePoint at = start_, tangent;
        for (int i = 0; i < 3; ++i) {
            program_ += "G5";
            CubicWords words{{}, {}, {}, {}, end()};
            if (pick(3) > 0) words.i = word('I', number()), words.j = word('J', number());
            words.p = word('P', number());
            words.q = word('Q', number());
            program_ += "\n";
            const auto spline = cubic_spline(at, tangent, words);
            if (!spline) return {};
            append(all, spline->curve);
            at = words.end;
            tangent = spline->next_tangent;
        }
        return all;
    }

    Chords quadratic() {
        std::vector<SplinePoint> all;
        program_ += "G5.1";
        const SplinePoint to = end();
        const auto i = word('I', number(), 4), j = word('J', number(), 4);
        program_ += "\n";
        const auto curve = quadratic_spline(start_, i, j, to);
        if (!curve) return {};
        append(all, *curve);
        return all;
    }

    Chords nurbs() {
        std::vector<SplinePoint> all;
        NurbsGathering gathering;
        const int blocks = 1 + pick(8);
        for (int i = 0; i < blocks; ++i) {
            program_ += "G5.2";
            ControlPointWords words;
            if (i > 0 || pick(2)) {
                words.x = word('X', number(), 40);
                words.y = word('Y', number(), 40);
            }
            words.weight = word('P', 0.1 * (pick(50) - (i > 0 && pick(9) == 0 ? 25 : -1)), 60);
            if (pick(4) == 0) words.order = static_cast<int>(*word('L', 1 + pick(6), 1 << 30));
            program_ += "\n";
            if (!add_control_point(gathering, start_, words)) return {};
        }
        program_ += "G5.3\n";
        const auto curve = finish_nurbs(gathering);
        if (!curve) return {};
        append(all, *curve);
        return all;
    }

    std::mt19937 rng_;
    std::string program_;
    SplinePoint start_;
};

void expect_same_chords(const std::vector<SplinePoint>& ours,
                        const std::vector<test_support::ReferenceMotion>& theirs) {
    ASSERT_EQ(ours.size() + 1, theirs.size()); // the first is the rapid to the start
    for (size_t i = 0; i < ours.size(); ++i) {
        EXPECT_EQ(theirs[i + 1].call, "straight_feed");
        const double tolerance = 1e-6 + 1e-9 * std::hypot(ours[i].x, ours[i].y);
        expect_near(ours[i], {theirs[i + 1].values[0], theirs[i + 1].values[1]}, tolerance);
    }
}

TEST(Spline, AgreesWithTheReferenceOnRandomCurves) {
    if (!test_support::reference_is_installed()) GTEST_SKIP() << "rs274 is not installed";
    SplineGenerator generator(20);
    std::vector<SplineCase> cases;
    std::vector<std::string> programs;
    for (int i = 0; i < 400; ++i) {
        cases.push_back(generator.next());
        programs.push_back(cases.back().program);
    }
    const auto runs = test_support::run_reference(programs);
    ASSERT_EQ(runs.size(), cases.size());
    size_t refused = 0;
    for (size_t i = 0; i < cases.size(); ++i) {
        SCOPED_TRACE(cases[i].program);
        ASSERT_EQ(runs[i].refusal.empty(), cases[i].chords.has_value()) << runs[i].refusal;
        refused += !cases[i].chords;
        if (cases[i].chords) expect_same_chords(*cases[i].chords, runs[i].motions);
        if (HasFailure()) return;
    }
    EXPECT_GT(refused, 60u);
    EXPECT_LT(refused, 340u);
}

} // namespace
} // namespace gcode
