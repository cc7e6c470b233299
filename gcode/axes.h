#pragma once

#include "core/sim/axes.h"

namespace gcode {

using core::axis_count;
using core::axis_letters;
using core::AxisValues;
using core::is_rotary;
using core::is_secondary;

/// mm and degrees, axis by axis; empty where nobody knows.
using Position = core::AxisPosition;

constexpr Position zero_position = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};

} // namespace gcode
