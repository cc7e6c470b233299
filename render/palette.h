#pragma once

#include <array>
#include <cstdint>

namespace render {

/// An sRGB colour with opacity.
struct Color {
    uint8_t r = 0, g = 0, b = 0, a = 255;

    bool operator==(const Color&) const = default;
};

/// The channels as 0..1, for OpenGL and user interfaces.
constexpr std::array<float, 4> fractions(Color c) {
    return {static_cast<float>(c.r) / 255.0F, static_cast<float>(c.g) / 255.0F,
            static_cast<float>(c.b) / 255.0F, static_cast<float>(c.a) / 255.0F};
}

/// The colour with another opacity, 0..1.
Color with_alpha(Color color, double alpha);

/// A mixture: `a` at 0, `b` at 1.
Color mixed(Color a, Color b, double fraction);

enum class ColorScheme : uint8_t { dark, light };

/// The uses of colours.
enum class Role : uint8_t {
    background,
    panel,
    raised,
    line,
    text,
    dim,
    accent,
    violation,
    near,
    clear,
    view_top,
    view_bottom,
    stock_raw,
    stock_cut,
    fixture,
    vise,
    clamp,
    flutes,
    shank,
    holder,
    nose,
    machine,
    part,
    edge,      // feature edges of bodies
    rapid,     // rapids with unknown clearance
    current,   // the current block
    section,   // hatching of a cut face
    pair_tool, // of the two bodies of a pair, the one on the tool side
    pair_body, // and the one that it must not touch
    axis_x,    // arrows at program zero and machine zero
    axis_y,
    axis_z,
    grid,  // lines on the ground
    shadow // of the work on the ground
};
constexpr size_t role_count = static_cast<size_t>(Role::shadow) + 1;

Color color(ColorScheme theme, Role role);

/// A clearance compared with its allowance: `violation` less than it, `near` up to twice the
/// allowance, `none` while it is unknown.
enum class ClearanceState : uint8_t { none, clear, near, violation };

/// The colour of a state in lists, on the path and on the timeline.
Color state_color(ColorScheme theme, ClearanceState state);

} // namespace render
