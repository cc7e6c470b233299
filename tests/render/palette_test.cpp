#include <cmath>

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
    EXPECT_EQ(color(ColorScheme::light, Role::stock_cut), (Color{0x7F, 0xA0, 0xC8}));
    EXPECT_EQ(color(ColorScheme::dark, Role::flutes), (Color{0xF2, 0xC1, 0x4E}));
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
