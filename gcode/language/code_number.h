#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace gcode {

/// The letter and number of a G or M code, such as G59.3. In order: first G, then M, by number.
enum class CodeNumber : int {};

/// Every number of a code in tenths is below this.
constexpr int tenths_end = 10000;

constexpr CodeNumber code_of(char letter, int tenths) {
    return CodeNumber(letter == 'M' ? tenths_end + tenths : tenths);
}

/// g_code(59, 3) is G59.3.
constexpr CodeNumber g_code(int whole, int tenth = 0) { return code_of('G', 10 * whole + tenth); }
constexpr CodeNumber m_code(int whole) { return code_of('M', 10 * whole); }

constexpr char letter_of(CodeNumber code) { return int(code) < tenths_end ? 'G' : 'M'; }

/// 593 for G59.3.
constexpr int tenths_of(CodeNumber code) { return int(code) % tenths_end; }

/// 59 for G59.3.
constexpr int whole_of(CodeNumber code) { return tenths_of(code) / 10; }

/// 3 for G59.3.
constexpr int tenth_of(CodeNumber code) { return tenths_of(code) % 10; }

/// 59.3 for G59.3.
constexpr double value_of(CodeNumber code) { return tenths_of(code) / 10.0; }

/// The code as a program has it: G59.3, M6.
std::string written(CodeNumber code);

/// The modal motion code.
enum class MotionCode : uint8_t {
    rapid,                // G0
    straight,             // G1
    arc_clockwise,        // G2
    arc_counterclockwise, // G3
    spline_control_point, // G5.2
    spindle_feed,         // G33
    rigid_tap,            // G33.1
    probe_toward,         // G38.2
    try_probe_toward,     // G38.3: no contact is no error
    probe_away,           // G38.4
    try_probe_away,       // G38.5
    compensated_tap,      // G63 of Siemens
    tap_in,               // G331 of Siemens
    tap_out,              // G332 of Siemens
    arc_through_point,    // CIP of Siemens, a keyword
    tangent_arc,          // CT of Siemens, a keyword
};

constexpr bool is_straight(std::optional<MotionCode> motion) {
    return motion == MotionCode::rapid || motion == MotionCode::straight;
}
constexpr bool is_arc(std::optional<MotionCode> motion) {
    return motion == MotionCode::arc_clockwise || motion == MotionCode::arc_counterclockwise;
}

/// The motion that a code activates; empty for a code that is no motion or acts in its block only.
std::optional<MotionCode> motion_of(CodeNumber code);

/// The code of a motion; empty for a keyword.
std::optional<CodeNumber> number_of(MotionCode motion);

/// A motion as a program has it: G38.2, CIP.
std::string written(MotionCode motion);

} // namespace gcode
