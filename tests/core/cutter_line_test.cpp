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
                ++hits;
            }
    }
    EXPECT_GT(hits, 10000);
}

INSTANTIATE_TEST_SUITE_P(
    Cutter, EveryShapeAndPathError,
    testing::Combine(testing::Values(ToolShape::flat, ToolShape::ball, ToolShape::bull,
                                     ToolShape::drill, ToolShape::taper, ToolShape::chamfer,
                                     ToolShape::dovetail, ToolShape::tslot, ToolShape::lollipop),
                     testing::Values(0.0, 0.0025, 0.2)));

} // namespace
} // namespace core
