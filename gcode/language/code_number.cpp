#include "gcode/language/code_number.h"

#include <iterator>

#include <fmt/format.h>

namespace gcode {
namespace {

/// The codes of the motions, in the order of MotionCode.
constexpr CodeNumber motion_codes[] = {
    g_code(0),     g_code(1),     g_code(2),     g_code(3),     g_code(5, 2),
    g_code(33),    g_code(33, 1), g_code(38, 2), g_code(38, 3), g_code(38, 4),
    g_code(38, 5), g_code(63),    g_code(331),   g_code(332),
};
static_assert(std::size(motion_codes) == static_cast<size_t>(MotionCode::arc_through_point));

} // namespace

std::string written(CodeNumber code) {
    const std::string whole = fmt::format("{}{}", letter_of(code), whole_of(code));
    return tenth_of(code) == 0 ? whole : fmt::format("{}.{}", whole, tenth_of(code));
}

std::optional<MotionCode> motion_of(CodeNumber code) {
    for (size_t i = 0; i < std::size(motion_codes); ++i)
        if (motion_codes[i] == code) return static_cast<MotionCode>(i);
    return std::nullopt;
}

std::optional<CodeNumber> number_of(MotionCode motion) {
    const auto index = static_cast<size_t>(motion);
    if (index >= std::size(motion_codes)) return std::nullopt;
    return motion_codes[index];
}

std::string written(MotionCode motion) {
    if (const std::optional<CodeNumber> code = number_of(motion)) return written(*code);
    return motion == MotionCode::tangent_arc ? "CT" : "CIP";
}

} // namespace gcode
