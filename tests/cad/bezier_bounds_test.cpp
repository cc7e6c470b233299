#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/cad/reader/bezier_bounds.h"

namespace core::cad {
namespace {

/// The point of a rational Bezier curve at a parameter from 0 to 1, by the Bernstein polynomials.
Vec3 value(const BezierArc& arc, double t) {
    const size_t n = arc.size() - 1;
    Vec3 top(0.0);
    double weight = 0.0, binomial = 1.0;
    for (size_t i = 0; i <= n; ++i) {
        const double share = binomial * std::pow(t, static_cast<double>(i))
                             * std::pow(1.0 - t, static_cast<double>(n - i)) * arc[i].weight;
        top += share * arc[i].at;
        weight += share;
        binomial *= static_cast<double>(n - i) / static_cast<double>(i + 1);
    }
    return top / weight;
}

Vec3 value(const BezierPatch& patch, double u, double v) {
    BezierArc column;
    for (const BezierArc& row : patch.rows) {
        double weight = 0.0, binomial = 1.0;
        const size_t n = row.size() - 1;
        for (size_t i = 0; i <= n; ++i) {
            weight += binomial * std::pow(v, static_cast<double>(i))
                      * std::pow(1.0 - v, static_cast<double>(n - i)) * row[i].weight;
            binomial *= static_cast<double>(n - i) / static_cast<double>(i + 1);
        }
        column.push_back({value(row, v), weight});
    }
    return value(column, u);
}

class RandomPoles {
public:
    explicit RandomPoles(unsigned seed) : random_(seed) {}

    BezierArc arc(size_t count, bool is_rational) {
        BezierArc poles;
        for (size_t i = 0; i < count; ++i)
            poles.push_back(
                {{at_(random_), at_(random_), at_(random_)}, is_rational ? weight_(random_) : 1.0});
        return poles;
    }

private:
    std::mt19937 random_;
    std::uniform_real_distribution<double> at_{-10.0, 10.0}, weight_{0.3, 2.0};
};

constexpr double step = 1e-3; // of numerical derivatives
constexpr double loose = 1.001;

TEST(BezierBounds, HoldForEachPointOfACurve) {
    RandomPoles random(1);
    for (int round = 0; round < 60; ++round) {
        const BezierArc arc = random.arc(2 + round % 4, round % 2 == 1);
        const double length = 0.5 + round;
        const DerivativeBounds bounds = bounds_of(arc, length);
        ASSERT_TRUE(bounds.known);
        double first = 0.0, second = 0.0;
        for (double t = step; t < 1.0 - step; t += 0.01) {
            const Vec3 a = value(arc, t - step), b = value(arc, t), c = value(arc, t + step);
            first = std::max(first, glm::length(c - a) / (2.0 * step * length));
            second =
                std::max(second, glm::length(a - 2.0 * b + c) / (step * step * length * length));
        }
        EXPECT_LE(first, loose * bounds.first.length);
        EXPECT_LE(second, loose * bounds.second.length + 1e-6);
    }
}

TEST(BezierBounds, HoldForEachPointOfASurface) {
    RandomPoles random(2);
    for (int round = 0; round < 40; ++round) {
        BezierPatch patch;
        for (int i = 0; i < 2 + round % 3; ++i)
            patch.rows.push_back(random.arc(2 + round % 4, round % 2 == 1));
        const SurfaceDerivativeBounds bounds = bounds_of(patch, 2.0, 3.0);
        SurfaceDerivativeBounds found;
        const auto at = [&](double u, double v) { return value(patch, u, v); };
        for (double u = 0.01; u < 0.99; u += 0.07)
            for (double v = 0.01; v < 0.99; v += 0.07) {
                const double h = step;
                found.u = std::max(found.u, glm::length(at(u + h, v) - at(u - h, v)) / (4.0 * h));
                found.v = std::max(found.v, glm::length(at(u, v + h) - at(u, v - h)) / (6.0 * h));
                found.uu =
                    std::max(found.uu, glm::length(at(u + h, v) - 2.0 * at(u, v) + at(u - h, v))
                                           / (4.0 * h * h));
                found.vv =
                    std::max(found.vv, glm::length(at(u, v + h) - 2.0 * at(u, v) + at(u, v - h))
                                           / (9.0 * h * h));
                found.uv = std::max(found.uv, glm::length(at(u + h, v + h) - at(u + h, v - h)
                                                          - at(u - h, v + h) + at(u - h, v - h))
                                                  / (24.0 * h * h));
            }
        EXPECT_LE(found.u, loose * bounds.u);
        EXPECT_LE(found.v, loose * bounds.v);
        EXPECT_LE(found.uu, loose * bounds.uu + 1e-6);
        EXPECT_LE(found.uv, loose * bounds.uv + 1e-6);
        EXPECT_LE(found.vv, loose * bounds.vv + 1e-6);
    }
}

/// A quarter of a circle of radius 1.
BezierArc quarter(const Vec3& a, const Vec3& corner, const Vec3& b) {
    return {{a, 1.0}, {corner, std::sqrt(0.5)}, {b, 1.0}};
}

TEST(BezierBounds, AreTightForSmallArcsOfACircle) {
    BezierArc arc = quarter({1, 0, 0}, {1, 1, 0}, {0, 1, 0});
    for (int i = 0; i < 5; ++i) arc = halves(arc).first;
    const double length = 1.0 / 32.0;
    const DerivativeBounds bounds = bounds_of(arc, length);
    const double speed = std::sqrt(2.0); // at the start: 2 w |b - a|
    EXPECT_NEAR(bounds.first.length, speed, 0.1);
    EXPECT_LT(bounds.second.length, 1.3 * speed * speed);
}

TEST(BezierBounds, SeeNoKinkBetweenArcsOfACircle) {
    const BezierArc a = quarter({1, 0, 0}, {1, 1, 0}, {0, 1, 0});
    const BezierArc b = quarter({0, 1, 0}, {-1, 1, 0}, {-1, 0, 0});
    EXPECT_NEAR(kink_between(a, 1.0, b, 1.0).length, 0.0, 1e-12);
    EXPECT_NEAR(kink_between(a, 1.0, b, 2.0).length, std::sqrt(2.0) / 2.0, 1e-12);
    const BezierPatch low = transposed({{a, a}}), high = transposed({{b, b}});
    EXPECT_NEAR(kink_between(low, 1.0, high, 1.0), 0.0, 1e-12);
    EXPECT_NEAR(kink_between(low, 1.0, high, 2.0), std::sqrt(2.0) / 2.0, 1e-12);
}

TEST(BezierBounds, DivideAndContinueTheSameCurve) {
    RandomPoles random(3);
    for (int round = 0; round < 20; ++round) {
        const BezierArc arc = random.arc(2 + round % 4, round % 2 == 1);
        const ArcHalves both = halves(arc);
        const BezierArc longer = extended(arc, 0.05);
        for (const double t : {0.0, 0.3, 1.0}) {
            EXPECT_LT(glm::distance(value(both.first, t), value(arc, 0.5 * t)), 1e-9);
            EXPECT_LT(glm::distance(value(both.second, t), value(arc, 0.5 + 0.5 * t)), 1e-9);
            EXPECT_LT(glm::distance(value(longer, t), value(arc, -0.05 + 1.05 * t)), 1e-9);
        }
    }
}

TEST(BezierBounds, DivideAPatchInTheOrderOfItsCells) {
    RandomPoles random(5);
    const BezierPatch patch{{random.arc(3, true), random.arc(3, true), random.arc(3, true)}};
    const std::vector<BezierPatch> cells = divided(patch, 4);
    ASSERT_EQ(cells.size(), 16u);
    for (size_t i = 0; i < 4; ++i)
        for (size_t k = 0; k < 4; ++k)
            EXPECT_LT(glm::distance(value(cells[4 * i + k], 0.5, 0.5),
                                    value(patch, (0.5 + static_cast<double>(i)) / 4.0,
                                          (0.5 + static_cast<double>(k)) / 4.0)),
                      1e-9);
}

TEST(BezierBounds, AreUnknownForWeightsThatAreNotPositive) {
    EXPECT_FALSE(bounds_of(BezierArc{{{0, 0, 0}, 1.0}, {{1, 0, 0}, -1.0}}, 1.0).known);
    EXPECT_FALSE(bounds_of(BezierArc{{{0, 0, 0}, 1.0}, {{1, 0, 0}, 0.0}}, 1.0).known);
}

} // namespace
} // namespace core::cad
