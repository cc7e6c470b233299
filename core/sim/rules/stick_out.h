#pragma once

#include <map>
#include <vector>

#include "core/sim/leg/leg_check.h"
#include "core/sim/rules/air_cut.h"

namespace core {

/// Where a tool is too short for what it does, over all blocks so far. A plain value.
struct ToolReach {
    std::optional<BlockIndex> holder_block; // the first in which the holder meets the stock
    double more_stick_out = 0.0;            // mm that the holder would have to stand higher
    std::optional<BlockIndex> shank_block;  // the first in which the shank does
    double more_flute = 0.0;                // mm that the shank would have to begin higher
    std::optional<BlockIndex> rub_block;    // the first in which the shank only touches
    size_t blocks = 0;                      // in which holder or shank meet the stock
    size_t looks = 0;                       // at how long it would have to be; then no more
    std::optional<BlockIndex> last;
};

using ToolReaches = std::map<ToolNumber, ToolReach>;

/// A leg that was cut, with what a check needs.
struct CutLeg {
    const Setup& setup;
    const ToolAssembly& tool;
    BlockIndex block;
    const Leg& leg;
    const std::vector<bool>& fixtures_there;
    const CutModel& stock; // after the leg
};

/// Notes whether holder and shank met the stock on a leg that the flutes cut, and how much higher
/// they would have to stand to keep every allowance on it.
///
/// Cost: nothing for a leg on which they keep away; else, where they have to stand higher than on
///       any leg before, some ten checks of the leg.
void note_reach(ToolReaches& reaches, const CutLeg& cut, const std::vector<PairClearance>& pairs);

/// The findings `stick-out-short` and `over-engagement`, one of each for a tool, with the first
/// block that they are about and what would do for all blocks. Severities are left open but for a
/// shank that only rubs, which is a note.
std::vector<Finding> findings_of(const ToolReaches& reaches, const Setup& setup);

/// What rules that look at more than one block remember. A plain value.
struct RunWatch {
    AirSeries air;
    ToolReaches reaches;
    bool has_fed = false;           // the tool that is in the spindle now
    bool singular_reported = false; // of the same tool, singular-orientation
    // The control counts with another length than the tool's: how deep the tool goes then says
    // nothing of its stick-out. Whoever runs the blocks knows that and sets it.
    bool length_in_doubt = false;
};

} // namespace core
