#include <cmath>
#include <vector>

#include <glm/glm.hpp>
#include <gtest/gtest.h>

#include "render/palette.h"

namespace render {
namespace {

using Vec3 = glm::dvec3;

double linear(uint8_t channel) {
    const double c = channel / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

Vec3 linear(Color c) { return {linear(c.r), linear(c.g), linear(c.b)}; }

/// CIE L*a*b* under D65.
Vec3 lab(const Vec3& rgb) {
    const Vec3 xyz(0.4124 * rgb.x + 0.3576 * rgb.y + 0.1805 * rgb.z,
                   0.2126 * rgb.x + 0.7152 * rgb.y + 0.0722 * rgb.z,
                   0.0193 * rgb.x + 0.1192 * rgb.y + 0.9505 * rgb.z);
    const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116.0; };
    const double x = f(xyz.x / 0.95047), y = f(xyz.y), z = f(xyz.z / 1.08883);
    return {116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)};
}

/// How people without one kind of cones see a colour. Source: Machado, Oliveira, Fernandes: A
/// physiologically-based model for simulation of color vision deficiency, 2009; severity 1.
struct NodeView {
    const char* name;
    std::array<Vec3, 3> rows;
};
const std::array<NodeView, 4> sights = {{
    {"all", {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}},
    {"protanopia",
     {Vec3(0.152286, 1.052583, -0.204868), Vec3(0.114503, 0.786281, 0.099216),
      Vec3(-0.003882, -0.048116, 1.051998)}},
    {"deuteranopia",
     {Vec3(0.367322, 0.860646, -0.227968), Vec3(0.280085, 0.672501, 0.047413),
      Vec3(-0.011820, 0.042940, 0.968881)}},
    {"tritanopia",
     {Vec3(1.255528, -0.076749, -0.178779), Vec3(-0.078411, 0.930809, 0.147602),
      Vec3(0.004733, 0.691367, 0.303900)}},
}};

Vec3 seen(const NodeView& sight, Color color) {
    const Vec3 rgb = linear(color);
    Vec3 changed(0.0);
    for (int i = 0; i < 3; ++i)
        changed[i] = glm::clamp(glm::dot(sight.rows[static_cast<size_t>(i)], rgb), 0.0, 1.0);
    return lab(changed);
}

double apart(const NodeView& sight, Color a, Color b) {
    return glm::distance(seen(sight, a), seen(sight, b));
}

double degrees(double radians) { return radians * 57.29577951308232; }
double cos_of(double degrees) { return std::cos(degrees / 57.29577951308232); }

/// The difference of two colours as people see it, CIEDE2000. Source: Sharma, Wu, Dalal: The
/// CIEDE2000 color-difference formula, 2005.
double difference(const Vec3& a, const Vec3& b) {
    const auto seventh = [](double c) {
        return std::sqrt(std::pow(c, 7) / (std::pow(c, 7) + std::pow(25.0, 7)));
    };
    const double grey = 0.5 * (1.0 - seventh(0.5 * (std::hypot(a.y, a.z) + std::hypot(b.y, b.z))));
    const double a1 = (1.0 + grey) * a.y, a2 = (1.0 + grey) * b.y;
    const double c1 = std::hypot(a1, a.z), c2 = std::hypot(a2, b.z), both = c1 * c2;
    const auto hue = [](double x, double y) {
        const double angle = degrees(std::atan2(y, x));
        return angle < 0.0 ? angle + 360.0 : angle;
    };
    const double h1 = hue(a1, a.z), h2 = hue(a2, b.z);
    double turn = both > 0.0 ? h2 - h1 : 0.0;
    turn += turn > 180.0 ? -360.0 : (turn < -180.0 ? 360.0 : 0.0);
    double h = h1 + h2;
    if (both > 0.0)
        h = std::abs(h1 - h2) <= 180.0 ? 0.5 * h : 0.5 * (h + (h < 360.0 ? 360.0 : -360.0));
    const double l = 0.5 * (a.x + b.x) - 50.0, c = 0.5 * (c1 + c2);
    const double t = 1.0 - 0.17 * cos_of(h - 30.0) + 0.24 * cos_of(2.0 * h)
                     + 0.32 * cos_of(3.0 * h + 6.0) - 0.20 * cos_of(4.0 * h - 63.0);
    const double dl = (b.x - a.x) / (1.0 + 0.015 * l * l / std::sqrt(20.0 + l * l));
    const double dc = (c2 - c1) / (1.0 + 0.045 * c);
    const double dh =
        2.0 * std::sqrt(both) * std::sin(turn / 2.0 / 57.29577951308232) / (1.0 + 0.015 * c * t);
    const double around = (h - 275.0) / 25.0;
    const double mixed =
        -2.0 * seventh(c) * std::sin(60.0 * std::exp(-around * around) / 57.29577951308232);
    return std::sqrt(dl * dl + dc * dc + dh * dh + mixed * dc * dh);
}

/// The least difference of two colours over every kind of sight.
double least_difference(Color a, Color b) {
    double least = 1000.0;
    for (const NodeView& sight : sights)
        least = std::min(least, difference(seen(sight, a), seen(sight, b)));
    return least;
}

TEST(ColourDifference, AgreesWithThePublishedPairs) {
    const auto expect = [](const Vec3& a, const Vec3& b, double expected) {
        EXPECT_NEAR(difference(a, b), expected, 5e-5);
        EXPECT_NEAR(difference(b, a), expected, 5e-5);
    };
    expect({50, 2.6772, -79.7751}, {50, 0, -82.7485}, 2.0425);
    expect({50, 2.4900, -0.0010}, {50, -2.4900, 0.0009}, 7.1792);
    expect({50, 2.4900, -0.0010}, {50, -2.4900, 0.0011}, 7.2195);
    expect({50, 2.5, 0}, {61, -5, 29}, 22.8977);
    expect({60.2574, -34.0099, 36.2677}, {60.4626, -34.1751, 39.4387}, 1.2644);
    expect({2.0776, 0.0795, -1.1350}, {0.9033, -0.0636, -0.5514}, 0.9082);
}

/// Two roles that touch in the picture, and the difference that they need.
struct Neighbours {
    Role a, b;
    double least;
};

constexpr double enough = 10.0;      // bodies next to each other
constexpr double enough_pair = 12.0; // a body of the pair next to others
constexpr double enough_mark = 14.0; // a body of the pair next to marks

std::vector<Neighbours> neighbours() {
    using enum Role;
    std::vector<Neighbours> all;
    const auto add = [&](Role a, std::initializer_list<Role> others, double least) {
        for (const Role b : others) all.push_back({a, b, least});
    };
    add(stock_raw, {stock_cut, vise, clamp, fixture, machine, flutes}, enough);
    add(stock_cut, {vise, clamp, fixture, machine, flutes, shank}, enough);
    add(machine, {vise, clamp, fixture}, enough);
    add(machine, {view_top, view_bottom}, 5.0);
    add(vise, {clamp, fixture, flutes, shank}, enough);
    add(clamp, {fixture, flutes, shank}, enough);
    add(flutes, {shank, fixture}, enough);
    add(part, {stock_raw, stock_cut}, enough);
    add(pair_tool, {pair_body}, 24.0);
    for (const Role side : {pair_tool, pair_body}) {
        add(side, {violation, near, clear}, enough_mark);
        add(side, {stock_raw, stock_cut, vise, clamp, fixture, machine, flutes, shank},
            enough_pair);
    }
    return all;
}

TEST(Palette, RolesThatTouchStayApartForEveryKindOfSight) {
    for (const ColorScheme theme : {ColorScheme::dark, ColorScheme::light})
        for (const Neighbours& pair : neighbours())
            EXPECT_GE(least_difference(color(theme, pair.a), color(theme, pair.b)), pair.least)
                << (theme == ColorScheme::dark ? "dark " : "light ") << static_cast<int>(pair.a)
                << " and " << static_cast<int>(pair.b);
}

TEST(Palette, StockKeepsRawAndCutApartInThePair) {
    for (const ColorScheme theme : {ColorScheme::dark, ColorScheme::light}) {
        const auto of_pair = [&](Role role) {
            return mixed(color(theme, role), color(theme, Role::pair_body), 0.4);
        };
        EXPECT_GE(least_difference(of_pair(Role::stock_raw), of_pair(Role::stock_cut)), 7.0);
    }
}

TEST(Palette, StatesStayApartForEveryKindOfSight) {
    for (const ColorScheme theme : {ColorScheme::dark, ColorScheme::light})
        for (const NodeView& sight : sights) {
            const Color violation = state_color(theme, ClearanceState::violation);
            const Color near = state_color(theme, ClearanceState::near);
            const Color clear = state_color(theme, ClearanceState::clear);
            EXPECT_GT(apart(sight, violation, near), 25.0) << sight.name;
            EXPECT_GT(apart(sight, near, clear), 25.0) << sight.name;
            EXPECT_GT(apart(sight, violation, clear), 25.0) << sight.name;
        }
}

TEST(Palette, TheMeasureSeesThatRedAndGreenCanFallTogether) {
    // A traffic light is what these colours are not: the measure must find it wanting.
    const Color amber{230, 160, 30}, green{120, 180, 60};
    double least = 1000.0;
    for (const NodeView& sight : sights) least = std::min(least, apart(sight, amber, green));
    EXPECT_LT(least, 20.0);
    EXPECT_GT(apart(sights[0], amber, green), 40.0);
}

/// Contrast as WCAG 2 has it.
double contrast(Color a, Color b) {
    const auto luminance = [](Color c) {
        const Vec3 rgb = linear(c);
        return 0.2126 * rgb.x + 0.7152 * rgb.y + 0.0722 * rgb.z;
    };
    const double x = luminance(a), y = luminance(b);
    return (std::max(x, y) + 0.05) / (std::min(x, y) + 0.05);
}

TEST(Palette, TextCanBeRead) {
    for (const ColorScheme theme : {ColorScheme::dark, ColorScheme::light})
        for (const Role ground : {Role::background, Role::panel, Role::raised}) {
            EXPECT_GT(contrast(color(theme, Role::text), color(theme, ground)), 7.0);
            EXPECT_GT(contrast(color(theme, Role::dim), color(theme, ground)), 4.5);
            EXPECT_GT(contrast(color(theme, Role::violation), color(theme, ground)), 4.0);
        }
}

TEST(Palette, HasTheColoursOfTheTable) {
    EXPECT_EQ(color(ColorScheme::dark, Role::violation), (Color{0xFF, 0x5A, 0x36}));
    EXPECT_EQ(color(ColorScheme::light, Role::violation), (Color{0xB3, 0x26, 0x1E}));
    EXPECT_EQ(color(ColorScheme::dark, Role::background), (Color{0x14, 0x17, 0x1C}));
    EXPECT_EQ(color(ColorScheme::light, Role::stock_cut), (Color{0x56, 0x83, 0xC8}));
    EXPECT_EQ(color(ColorScheme::dark, Role::flutes), (Color{0xF2, 0xCB, 0x45}));
    EXPECT_EQ(color(ColorScheme::dark, Role::holder).a, 140); // 55 %
}

TEST(Colour, MixesFromOneToTheOther) {
    const Color a{0, 100, 200, 255}, b{100, 0, 100, 55};
    EXPECT_EQ(mixed(a, b, 0.0), a);
    EXPECT_EQ(mixed(a, b, 1.0), b);
    EXPECT_EQ(mixed(a, b, 0.5), (Color{50, 50, 150, 155}));
    EXPECT_EQ(with_alpha(a, 0.5).a, 128);
}

} // namespace
} // namespace render
