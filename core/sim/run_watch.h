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
    // The control counts with another length than the tool's: how deep the tool goes then says
    // nothing of its stick-out. Whoever runs the blocks knows that and sets it.
    bool length_in_doubt = false;
};

} // namespace core
