#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "core/sim/tool_assembly.h"
#include "tests/support/profile_oracle.h"

namespace core {
namespace {

using test_support::outside;

/// A tool and its radius at each height, computed without pieces.
struct Described {
    ToolDescription tool;
    double height;
    std::function<double(double)> radius;
    double cut_to = infinity; // does not cut above this height
};

/// The outermost radius, at a height, of a ball of radius c swept around a circle of radius `disc`.
double round_at(double z, double disc, double c) {
    return disc + std::sqrt(std::max(0.0, c * c - (z - c) * (z - c)));
}

double tan_deg(double degrees) { return std::tan(degrees * std::numbers::pi / 180.0); }

ToolDescription sized(ToolShape shape, double diameter, double flutes) {
    ToolDescription tool;
    tool.number = ToolNumber{7};
    tool.shape = shape;
    tool.diameter = diameter;
    tool.flute_length = flutes;
    return tool;
}

ToolDescription with(ToolDescription tool, const std::function<void(ToolDescription&)>& change) {
    change(tool);
    return tool;
}

/// A flank at `deg` from the axis, tangential to the rounding: the outline of the convex hull is
/// the lower envelope of its boundaries, seen from outside.
double flank_at(double z, double tip, double corner, double deg) {
    // The distance of the tangent from the centre of the rounding is its radius.
    const double a = deg * std::numbers::pi / 180.0;
    return tip - corner + corner / std::cos(a) + (z - corner) * std::tan(a);
}

std::vector<Described> described_tools() {
    std::vector<Described> tools;
    tools.push_back({sized(ToolShape::flat, 10, 20), 20, [](double) { return 5.0; }});
    tools.push_back({sized(ToolShape::ball, 8, 20), 20,
                     [](double z) { return z < 4.0 ? round_at(z, 0, 4) : 4.0; }});
    tools.push_back({sized(ToolShape::ball, 8, 5), 5,
                     [](double z) { return z < 4.0 ? round_at(z, 0, 4) : 4.0; }});
    tools.push_back({with(sized(ToolShape::bull, 10, 20), [](auto& t) { t.corner_radius = 1.5; }),
                     20, [](double z) { return z < 1.5 ? round_at(z, 3.5, 1.5) : 5.0; }});
    tools.push_back({with(sized(ToolShape::flat, 10, 20), [](auto& t) { t.corner_radius = 2; }), 20,
                     [](double z) { return z < 2 ? round_at(z, 3, 2) : 5.0; }});
    tools.push_back({sized(ToolShape::drill, 6, 30), 30,
                     [](double z) { return std::min(3.0, z * tan_deg(59)); }});
    tools.push_back({with(sized(ToolShape::drill, 6, 30), [](auto& t) { t.point_deg = 180; }), 30,
                     [](double) { return 3.0; }});
    tools.push_back({with(sized(ToolShape::chamfer, 12, 9),
                          [](auto& t) {
                              t.angle_deg = 45;
                              t.tip_diameter = 2;
                          }),
                     9, [](double z) { return std::min(6.0, 1.0 + z); }});
    tools.push_back({with(sized(ToolShape::taper, 12, 25),
                          [](auto& t) {
                              t.angle_deg = 5;
                              t.tip_diameter = 2;
                          }),
                     25, [](double z) { return 1.0 + z * tan_deg(5); }});
    for (const double deg : {3.0, 10.0, 30.0, 60.0}) {
        const double diameter = deg > 20 ? 12 : 9;
        tools.push_back({with(sized(ToolShape::taper, diameter, 25),
                              [deg](auto& t) {
                                  t.angle_deg = deg;
                                  t.corner_radius = 1;
                              }),
                         25, [=](double z) {
                             const double foot = 1.0 - std::sin(deg * std::numbers::pi / 180);
                             return z < foot ? round_at(z, 0, 1)
                                             : std::min(0.5 * diameter, flank_at(z, 1, 1, deg));
                         }});
        tools.push_back({with(sized(ToolShape::taper, diameter, 1.6),
                              [deg](auto& t) {
                                  t.angle_deg = deg;
                                  t.tip_diameter = 4;
                                  t.corner_radius = 1;
                              }),
                         1.6, [=](double z) {
                             const double foot = 1.0 - std::sin(deg * std::numbers::pi / 180);
                             return z < foot ? round_at(z, 1, 1)
                                             : std::min(0.5 * diameter, flank_at(z, 2, 1, deg));
                         }});
    }
    tools.push_back({with(sized(ToolShape::tslot, 25, 8),
                          [](auto& t) {
                              t.neck_diameter = 10;
                              t.neck_length = 15;
                              t.corner_radius = 1;
                          }),
                     23,
                     [](double z) {
                         if (z > 8) return 5.0;
                         return round_at(z < 1 ? z : z > 7 ? 8 - z : 1.0, 11.5, 1);
                     },
                     8});
    tools.push_back({with(sized(ToolShape::dovetail, 20, 6),
                          [](auto& t) {
                              t.angle_deg = 30;
                              t.neck_diameter = 8;
                              t.neck_length = 4;
                          }),
                     10, [](double z) { return z > 6 ? 4.0 : 10.0 - z * tan_deg(30); }, 6});
    tools.push_back({with(sized(ToolShape::dovetail, 20, 6),
                          [](auto& t) {
                              t.angle_deg = 30;
                              t.corner_radius = 0.8;
                          }),
                     6, [](double z) {
                         if (z < 0.8 + 0.8 * 0.5) return round_at(z, 9.2, 0.8);
                         // The tangent at 30 degrees inwards from vertical.
                         return 9.2 + 0.8 / std::cos(std::numbers::pi / 6)
                                - (z - 0.8) * tan_deg(30);
                     }});
    tools.push_back({with(sized(ToolShape::lollipop, 10, 0), [](auto& t) { t.neck_diameter = 6; }),
                     9, [](double z) { return round_at(z, 0, 5); }});
    tools.push_back({with(sized(ToolShape::lollipop, 10, 30), [](auto& t) { t.neck_diameter = 6; }),
                     30, [](double z) { return z < 9 ? round_at(z, 0, 5) : 3.0; }, 9});
    tools.push_back({with(sized(ToolShape::lollipop, 10, 7), [](auto& t) { t.neck_diameter = 6; }),
                     9, [](double z) { return round_at(z, 0, 5); }, 7});
    tools.push_back({with(sized(ToolShape::threadmill, 12, 15),
                          [](auto& t) {
                              t.pitch = 1.5;
                              t.teeth = 3;
                          }),
                     15, [](double z) {
                         if (z > 4.5) return 6.0 - 0.3125 * 1.5 * std::sqrt(3.0);
                         const double from_crest =
                             std::abs(z - 1.5 * (std::floor(z / 1.5) + 0.5)) - 1.5 / 16;
                         const double depth = std::clamp(from_crest, 0.0, 0.3125 * 1.5);
                         return 6.0 - depth * std::sqrt(3.0);
                     }});
    tools.push_back(
        {sized(ToolShape::threadmill, 12, 15), 15, [](double) { return 6.0; }}); // the envelope
    return tools;
}

RevolvedProfile part(const ToolAssembly& tool, PartKind kind) {
    for (const ToolPart& each : tool.parts)
        if (each.kind == kind) return each.profile;
    return {};
}

TEST(ToolHead, IsTheSolidThatItsSizesDescribe) {
    constexpr double sag = 0.0025 + 1e-9; // of roundings that are approximated by cones, inwards
    for (const Described& each : described_tools()) {
        const auto tool = assemble(each.tool);
        ASSERT_TRUE(tool.has_value()) << tool.error().message;
        const std::string name = name_of(each.tool.shape);
        EXPECT_NEAR(tool->length, each.height, 1e-9) << name;
        const RevolvedProfile flutes = part(*tool, PartKind::flutes);
        const RevolvedProfile shank = part(*tool, PartKind::shank);
        for (double z = 0.0137; z < each.height; z += 0.0313) {
            const double r = each.radius(z);
            const double cut = outside(flutes, {r, 0, z});
            const double rest = shank.empty() ? infinity : outside(shank, {r, 0, z});
            EXPECT_LE(std::min(cut, rest), sag) << name << " r " << r << " z " << z;
            EXPECT_GT(outside(flutes, {r + 1e-7, 0, z}), 0.0) << name << " r " << r << " z " << z;
            if (!shank.empty()) {
                EXPECT_GT(outside(shank, {r + 1e-7, 0, z}), 0.0) << name << z;
            }
            if (z < each.cut_to) {
                EXPECT_LE(cut, sag) << name << z;
            }
        }
        EXPECT_GT(outside(flutes, {0, 0, -1e-6}), 0.0) << name;
    }
}

TEST(ToolHead, IsExactWhereNothingDividesARounding) {
    for (const Described& each : described_tools()) {
        const bool divided = each.tool.flute_length == 5 || each.tool.flute_length == 7
                             || each.tool.flute_length == 1.6;
        if (divided) continue;
        const auto tool = assemble(each.tool);
        ASSERT_TRUE(tool.has_value());
        const RevolvedProfile flutes = part(*tool, PartKind::flutes);
        const double top = std::min(each.height, each.cut_to);
        for (double z = 0.0137; z < top; z += 0.0313) {
            EXPECT_GT(outside(flutes, {each.radius(z) + 1e-7, 0, z}), 0.0) << z;
            EXPECT_LE(outside(flutes, {each.radius(z) - 1e-7, 0, z}), 0.0) << z;
        }
    }
}

TEST(ToolHead, WithATangentTipIsConvex) {
    for (const double deg : {1.0, 5.0, 17.3, 45.0, 60.0})
        for (const double corner : {0.1, 0.5, 1.0}) {
            const auto tool = assemble(with(sized(ToolShape::taper, 12, 40), [&](auto& t) {
                t.angle_deg = deg;
                t.tip_diameter = 2;
                t.corner_radius = corner;
            }));
            ASSERT_TRUE(tool.has_value()) << tool.error().message;
            EXPECT_TRUE(is_convex(tool->parts[0].profile)) << deg << ' ' << corner;
        }
}

std::string why_not(const ToolDescription& tool) {
    const auto assembled = assemble(tool);
    return assembled ? "" : assembled.error().message;
}

void expect_refused(const ToolDescription& tool, const std::string& words) {
    const std::string why = why_not(tool);
    EXPECT_NE(why.find(words), std::string::npos) << words << ": " << why;
    EXPECT_NE(why.find("tool 7: "), std::string::npos) << why;
}

TEST(ToolHead, RefusesSizesThatMakeNoTool) {
    using enum ToolShape;
    expect_refused(sized(flat, 0, 10), "diameter must be above 0");
    expect_refused(sized(flat, NAN, 10), "diameter must be above 0");
    expect_refused(sized(flat, 10, -1), "flute_length must be above 0");
    expect_refused(sized(flat, 10, 3000), "flute_length = 3000");
    expect_refused(sized(ball, 10, 4), "flute_length 4 is shorter than the ball's radius 5");
    expect_refused(sized(dovetail, 10, 4), "angle_deg");
    expect_refused(sized(taper, 10, 4), "angle_deg");
    expect_refused(sized(lollipop, 10, 4), "neck_diameter");
    expect_refused(sized(bull, 10, 4), "corner_radius");
    const auto changed = [](ToolShape shape, const std::function<void(ToolDescription&)>& change) {
        return with(sized(shape, 10, 12), change);
    };
    expect_refused(changed(flat, [](auto& t) { t.angle_deg = 3; }), "angle_deg does not apply");
    expect_refused(changed(ball, [](auto& t) { t.corner_radius = 2; }), "corner_radius of a ball");
    expect_refused(changed(drill, [](auto& t) { t.point_deg = 190; }), "point_deg");
    expect_refused(changed(flat, [](auto& t) { t.pitch = 1; }), "pitch does not apply");
    expect_refused(changed(threadmill, [](auto& t) { t.pitch = 13; }), "pitch 13");
    expect_refused(changed(threadmill,
                           [](auto& t) {
                               t.pitch = 1;
                               t.teeth = 13;
                           }),
                   "teeth = 13");
    expect_refused(changed(taper,
                           [](auto& t) {
                               t.angle_deg = 3;
                               t.tip_diameter = 2;
                               t.corner_radius = 1.5;
                           }),
                   "corner_radius 1.5");
    expect_refused(changed(dovetail, [](auto& t) { t.angle_deg = 60; }), "meets the axis");
    expect_refused(changed(tslot, [](auto& t) { t.neck_diameter = 11; }), "neck_diameter 11");
    expect_refused(changed(lollipop, [](auto& t) { t.neck_diameter = 10; }), "neck_diameter 10");
    expect_refused(changed(tslot, [](auto& t) { t.neck_length = 11; }), "neck_length needs");
    expect_refused(changed(flat, [](auto& t) { t.centre_radius = 5; }), "centre_diameter 10");
    expect_refused(changed(profile,
                           [](auto& t) {
                               t.outline = {{5, 0}, {5, 8}};
                           }),
                   "flute_length 12 goes beyond the profile, which ends at 8");
}

TEST(ToolHead, LeavesTheOutlineAboveTheFlutesToTheShank) {
    const auto tool = assemble(with(sized(ToolShape::profile, 0, 6), [](auto& t) {
        t.outline = {{2, 0}, {4, 4}, {4, 8}, {3, 8}, {3, 20}};
    }));
    ASSERT_TRUE(tool.has_value()) << tool.error().message;
    ASSERT_EQ(tool->parts.size(), 2U);
    EXPECT_EQ(bounds(tool->parts[0].profile).max.z, 6.005);
    EXPECT_EQ(bounds(tool->parts[1].profile).min.z, 6.0);
    EXPECT_EQ(tool->length, 20.0);
    EXPECT_EQ(tool->description.diameter, 8.0);
}

TEST(ToolAssembly, FillsTheStickOutWithAShank) {
    ToolDescription tool = sized(ToolShape::flat, 10, 20);
    tool.holder = {{40, 40, 50}};
    tool.stick_out = 45;
    EXPECT_EQ(assemble(tool)->length, 95.0);
    EXPECT_EQ(bounds(assemble(tool)->parts[1].profile).max.x, 5.0);
    tool.shank_diameter = 12;
    EXPECT_EQ(bounds(assemble(tool)->parts[1].profile).max.x, 6.0);
    tool.stick_out.reset();
    tool.gauge_length = 90;
    EXPECT_EQ(assemble(tool)->description.shank.front().length, 20.0);
    tool.shank = {{10, 10, 20}};
    EXPECT_EQ(assemble(tool)->length, 90.0);
}

TEST(ToolAssembly, TakesTheGaugeLengthForAMissingHolder) {
    ToolDescription tool = sized(ToolShape::flat, 10, 20);
    tool.gauge_length = 90;
    const auto assembled = assemble(tool);
    EXPECT_EQ(assembled->length, 90.0);
    EXPECT_EQ(assembled->parts.size(), 1U);
}

TEST(ToolAssembly, RefusesLengthsThatContradictEachOther) {
    ToolDescription tool = sized(ToolShape::flat, 10, 20);
    tool.shank = {{10, 10, 20}};
    tool.stick_out = 45;
    expect_refused(tool, "stick_out is 45 mm, but flutes, neck and shank are 40 mm");
    tool.stick_out.reset();
    tool.gauge_length = 39;
    expect_refused(tool, "gauge_length is 39 mm, but flutes and shank alone are 40 mm");
    tool.holder = {{40, 40, 50}};
    expect_refused(tool, "gauge_length is 39 mm, but flutes, shank and holder are 90 mm");
    tool.shank.clear();
    tool.gauge_length = 60;
    expect_refused(tool, "gauge_length leaves 10 mm below the holder");
}

} // namespace
} // namespace core
