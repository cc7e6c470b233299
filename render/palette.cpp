#include "render/palette.h"

#include <cmath>

#include "core/base/math.h"

namespace render {
namespace {

constexpr Color hex(uint32_t rgb, uint8_t alpha = 255) {
    return {static_cast<uint8_t>(rgb >> 16), static_cast<uint8_t>(rgb >> 8 & 0xFF),
            static_cast<uint8_t>(rgb & 0xFF), alpha};
}

using Colors = std::array<Color, role_count>;

// In the order of Role. tests/render/palette_test.cpp checks that roles that touch in the picture
// stay apart for every kind of sight.
constexpr Colors dark = {
    hex(0x14171C),      hex(0x1B1F26),     hex(0x252B34),      hex(0x323A46), // surfaces, line
    hex(0xE6EAF0),      hex(0x8D97A6),     hex(0x4CB3F0),                     // text, dim, accent
    hex(0xFF5A36),      hex(0xFFD23F),     hex(0x5B8DB8),                     // states
    hex(0x2C333D),      hex(0x15181D),                                        // view
    hex(0xC4CBD5),      hex(0x3F86B4),                                        // stock
    hex(0x8B909A),      hex(0x4E6F6C),     hex(0x8A5420), // fixture, vise, clamp
    hex(0xF2CB45),      hex(0xE8EEF5),     hex(0x8FA0B4, 140), hex(0x7C8896), // tool
    hex(0x41454B),      hex(0x7FB8A4),                                        // machine, part
    hex(0x0C0F13, 190), hex(0x9AA5B4),     hex(0xFFFFFF),      hex(0xE6EAF0), // edge ... section
    hex(0xDAA8FF),      hex(0x9DF5BC),                                        // pair
    hex(0xF0616D),      hex(0x57BE62),     hex(0x5AA2F5),                     // axes
    hex(0xA9B6C8, 60),  hex(0x000000, 190)};                                  // grid, shadow

constexpr Colors light = {
    hex(0xF3F5F8),      hex(0xFFFFFF),     hex(0xE9EDF2),      hex(0xCBD3DD), // surfaces, line
    hex(0x1B2430),      hex(0x5B6777),     hex(0x0B72C4),                     // text, dim, accent
    hex(0xB3261E),      hex(0xD69A00),     hex(0x2A6FA8),                     // states
    hex(0xFFFFFF),      hex(0xD3DAE3),                                        // view
    hex(0xD5DEEA),      hex(0x5683C8),                                        // stock
    hex(0x8E98A8),      hex(0x687A77),     hex(0xAC7433), // fixture, vise, clamp
    hex(0xEED238),      hex(0xEEF2F6),     hex(0x8FA0B4, 140), hex(0x9BA6B3), // tool
    hex(0xB4B7BB),      hex(0x6FAF98),                                        // machine, part
    hex(0x2A3442, 200), hex(0x6B7888),     hex(0x0A1420),      hex(0x1B2430), // edge ... section
    hex(0x852F66),      hex(0x56CE92),                                        // pair
    hex(0xC8323F),      hex(0x2C8A3B),     hex(0x1F69CC),                     // axes
    hex(0x3A4A60, 60),  hex(0x1A2433, 140)};                                  // grid, shadow

uint8_t mix(uint8_t a, uint8_t b, double fraction) {
    return static_cast<uint8_t>(core::round_to_integer(a + (b - a) * fraction));
}

} // namespace

Color with_alpha(Color color, double alpha) {
    color.a = static_cast<uint8_t>(core::round_to_integer(255.0 * alpha));
    return color;
}

Color mixed(Color a, Color b, double fraction) {
    return {mix(a.r, b.r, fraction), mix(a.g, b.g, fraction), mix(a.b, b.b, fraction),
            mix(a.a, b.a, fraction)};
}

Color color(ColorScheme theme, Role role) {
    return (theme == ColorScheme::dark ? dark : light)[static_cast<size_t>(role)];
}

Color state_color(ColorScheme theme, ClearanceState state) {
    switch (state) {
    case ClearanceState::violation:
        return color(theme, Role::violation);
    case ClearanceState::near:
        return color(theme, Role::near);
    case ClearanceState::clear:
        return color(theme, Role::clear);
    case ClearanceState::none:
        break;
    }
    return color(theme, Role::dim);
}

} // namespace render
