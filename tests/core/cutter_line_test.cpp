#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/dbm/cutter.h"
#include "core/sim/tool_assembly.h"

namespace core {
namespace {

ToolDescription tool(ToolShape shape) {
    ToolDescription tool;
    tool.number = ToolNumber{1};
    tool.shape = shape;
    tool.diameter = 10.4;
    tool.flute_length = 8.56;
    switch (shape) {
    case ToolShape::bull:
        tool.corner_radius = 1.96;
        tool.flute_length = 20.0;
        break;
    case ToolShape::taper:
    case ToolShape::chamfer:
        tool.angle_deg = 31.0;
        tool.tip_diameter = 2.5;
        break;
    case ToolShape::dovetail:
        tool.angle_deg = 20.0;
        tool.flute_length = 4.0;
        break;
    case ToolShape::tslot:
    case ToolShape::lollipop:
        tool.neck_diameter = 4.0;
        tool.neck_length = 15.0;
        tool.flute_length = shape == ToolShape::tslot ? 3.0 : 7.0;
        break;
    default:
        break;
    }
    return tool;
}

/// The distance of a point from the path of the tip, seen from above.
double distance_from_path(const CutterSweep& sweep, double x, double y) {
    const Vec3 way(sweep.to.x - sweep.from.x, sweep.to.y - sweep.from.y, 0.0);
    const Vec3 to(x - sweep.from.x, y - sweep.from.y, 0.0);
    const double length_2 = glm::dot(way, way);
    const double t = length_2 > 0.0 ? std::clamp(glm::dot(to, way) / length_2, 0.0, 1.0) : 0.0;
    return glm::length(to - t * way);
}

class EveryShapeAndPathError : public testing::TestWithParam<std::tuple<ToolShape, double>> {};

/// The segment of a line is the hull of the segments of all pieces, although only those are
/// computed that can be its ends.
TEST_P(EveryShapeAndPathError, GivesTheHullOfAllPiecesOnLinesAlongZ) {
    const auto [shape, path_error] = GetParam();
    const auto assembled = assemble(tool(shape));
    ASSERT_TRUE(assembled) << assembled.error().message;
    const auto cutter =
        std::make_shared<const Cutter>(make_cutter(assembled->parts[0].profile, path_error));
    std::mt19937 rng(7);
    const auto within = [&](double most) {
        return std::uniform_real_distribution<double>(-most, most)(rng);
    };
    int hits = 0;
    for (int i = 0; i < 40000; ++i) {
        CutterSweep sweep{.cutter = cutter, .from = {within(1), within(1), within(1)}};
        const double way = i % 3 == 0 ? 0.3 : 9.0;
        sweep.to = sweep.from + Vec3(within(way), within(way), i % 2 ? within(way) : 0.0);
        if (i % 17 == 0) sweep.to.x = sweep.from.x, sweep.to.y = sweep.from.y;
        const double x = within(9.0), y = within(9.0);
        for (const Cutter::Piece& piece : cutter->pieces)
            for (const RevolvedProfile* profile : {&piece.within, &piece.around}) {
                Interval hull{infinity, -infinity};
                for (const ProfileElement& element : profile->elements)
                    if (const auto part =
                            line_interval(ElementSweep{element, sweep.from, sweep.to}, 2, x, y)) {
                        hull.lower = std::min(hull.lower, part->lower);
                        hull.upper = std::max(hull.upper, part->upper);
                    }
                const auto found = line_interval(*profile, sweep, 2, x, y);
                ASSERT_EQ(found.has_value(), hull.lower < hull.upper) << x << " " << y;
                if (!found) continue;
                ASSERT_NEAR(found->lower, hull.lower, 1e-9) << x << " " << y;
                ASSERT_NEAR(found->upper, hull.upper, 1e-9) << x << " " << y;
                const double low = std::min(sweep.from.z, sweep.to.z)
                                   + cutter->underside.beyond(distance_from_path(sweep, x, y));
                ASSERT_GE(found->lower, low - 1e-9) << x << " " << y;
                ++hits;
            }
    }
    EXPECT_GT(hits, 10000);
}

TEST(Underside, IsAboutThatOfTheBody) {
    const double r = 3.0;
    const RevolvedProfile ball{{{r, 0, r, 0, r}, {r, r, 20, r, 0}}};
    const RevolvedProfile bull{{{1, 2, 1, 2, 1}, {1, r, 20, r, 0}}};
    const RevolvedProfile cone{{{0, 0, 2, r, 0}, {2, r, 20, r, 0}}};
    for (double d = 0.0; d < 0.9 * r; d += 0.01) {
        constexpr double step = 3.0 / 32 + 1e-6;
        const double ball_low = r - std::sqrt(r * r - d * d);
        const double before = std::max(0.0, d - step);
        EXPECT_LE(make_cutter(ball, 0.0).underside.beyond(d), ball_low + 1e-9);
        EXPECT_GE(make_cutter(ball, 0.0).underside.beyond(d),
                  r - std::sqrt(r * r - before * before) - 1e-9);
        const double off = std::max(0.0, d - 2.0);
        EXPECT_LE(make_cutter(bull, 0.0).underside.beyond(d),
                  1.0 - std::sqrt(1.0 - off * off) + 1e-9);
        EXPECT_NEAR(make_cutter(cone, 0.0).underside.beyond(d), d / r * 2.0, 0.07);
    }
    EXPECT_EQ(make_cutter(ball, 0.0).underside.beyond(r + 1e-6), infinity);
}

INSTANTIATE_TEST_SUITE_P(
    Cutter, EveryShapeAndPathError,
    testing::Combine(testing::Values(ToolShape::flat, ToolShape::ball, ToolShape::bull,
                                     ToolShape::drill, ToolShape::taper, ToolShape::chamfer,
                                     ToolShape::dovetail, ToolShape::tslot, ToolShape::lollipop),
                     testing::Values(0.0, 0.0025, 0.2)));

} // namespace
} // namespace core
