#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace render {

/// A colour as screens have it: sRGB, and how much it covers.
struct Color {
    uint8_t r = 0, g = 0, b = 0, a = 255;

    bool operator==(const Color&) const = default;
};

/// The channels as shares 0..1, as OpenGL and user interfaces want them.
constexpr std::array<float, 4> shares(Color c) {
    return {static_cast<float>(c.r) / 255.0F, static_cast<float>(c.g) / 255.0F,
            static_cast<float>(c.b) / 255.0F, static_cast<float>(c.a) / 255.0F};
}

/// The colour with another cover, 0..1.
Color with_alpha(Color color, double alpha);

/// A mixture: `a` at share 0, `b` at share 1.
Color mixed(Color a, Color b, double share);

enum class ColorScheme : uint8_t { dark, light };

/// What a colour is for.
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
    clamp,
    flutes,
    shank,
    holder,
    nose,
    machine,
    part,
    edge,    // feature edges of bodies
    rapid,   // rapids whose clearance is not known
    current, // the block at which the program stands
    section  // hatching of a cut face
};
constexpr size_t role_count = static_cast<size_t>(Role::section) + 1;

Color color(ColorScheme theme, Role role);

/// How a clearance stands to its allowance; `none` as long as nobody knows it.
enum class ClearanceState : uint8_t { none, clear, near, violation };

/// violation: less than the allowance. near: up to twice the allowance.
ClearanceState clearance_state(std::optional<double> clearance, double allowance);

/// The colour that stands for a state, in lists, on the path and on the timeline.
Color state_color(ColorScheme theme, ClearanceState state);

/// The colour of a clearance in mm by the state that it is in.
inline Color clearance_color(ColorScheme theme, std::optional<double> clearance, double allowance) {
    return state_color(theme, clearance_state(clearance, allowance));
}

} // namespace render
