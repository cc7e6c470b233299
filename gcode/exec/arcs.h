#pragma once

#include <cmath>
#include <numbers>

namespace gcode {

/// The angle an arc turns through, radians, positive counter-clockwise seen from the plane's
/// normal.
///
/// An end within a millionth of a radian of the start is a full turn (LinuxCNC: CIRCLE_FUZZ).
inline double arc_angle(const double (&start)[2], const double (&end)[2], const double (&centre)[2],
                        int turns) {
    constexpr double full_turn = 2.0 * std::numbers::pi;
    constexpr double fuzz = 1e-6;
    const double start_angle = std::atan2(start[1] - centre[1], start[0] - centre[0]);
    const double end_angle = std::atan2(end[1] - centre[1], end[0] - centre[0]);
    const double sign = turns < 0 ? -1.0 : 1.0;
    double angle = sign * (end_angle - start_angle);
    if (angle < 0.0) angle += full_turn;
    if (angle < fuzz) angle = full_turn;
    if (start[0] == end[0] && start[1] == end[1]) angle = full_turn;
    return sign * (angle + full_turn * (std::abs(turns) - 1));
}

} // namespace gcode
