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

// In the order of Role.
constexpr Colors dark = {hex(0x14171C), hex(0x1B1F26), hex(0x252B34),      hex(0x323A46),
                         hex(0xE6EAF0), hex(0x8D97A6), hex(0x4CB3F0),      hex(0xFF5A36),
                         hex(0xFFD23F), hex(0x5B8DB8), hex(0x2C333D),      hex(0x15181D),
                         hex(0xAEB9C6), hex(0x6F95C2), hex(0x5B6675),      hex(0xB08A3C),
                         hex(0xF2C14E), hex(0xD6DAE0), hex(0x8FA0B4, 140), hex(0x7C8896),
                         hex(0x49525F), hex(0x7FB8A4), hex(0x0C0F13, 190), hex(0x9AA5B4),
                         hex(0xFFFFFF), hex(0xE6EAF0)};

constexpr Colors light = {hex(0xF3F5F8), hex(0xFFFFFF), hex(0xE9EDF2),      hex(0xCBD3DD),
                          hex(0x1B2430), hex(0x5B6777), hex(0x0B72C4),      hex(0xB3261E),
                          hex(0xD69A00), hex(0x2A6FA8), hex(0xFFFFFF),      hex(0xD3DAE3),
                          hex(0xC3CCD6), hex(0x7FA0C8), hex(0x8A95A3),      hex(0xC49C4A),
                          hex(0xF2C14E), hex(0xDDE1E7), hex(0x8FA0B4, 140), hex(0x9BA6B3),
                          hex(0xA9B3BF), hex(0x6FAF98), hex(0x2A3442, 200), hex(0x6B7888),
                          hex(0x0A1420), hex(0x1B2430)};

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
