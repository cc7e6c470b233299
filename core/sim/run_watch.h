#pragma once

#include "core/sim/air_cut.h"
#include "core/sim/stick_out.h"

namespace core {

/// What rules that look at more than one block remember. A plain value.
struct RunWatch {
    AirSeries air;
    ToolReaches reaches;
    bool has_fed = false;    // the tool that is in the spindle now
    bool told_swing = false; // of the same tool, singular-orientation
};

} // namespace core
