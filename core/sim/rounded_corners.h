#pragma once

#include "core/sim/clearance.h"
#include "core/sim/event.h"
#include "core/sim/machine.h"
#include "core/sim/path.h"

namespace core {

/// How far the control's rounding of corners may take the tool off its programmed way, mm.
///
/// Where a corner is rounded hangs on the next motion, on speeds and on short moves that the
/// control joins, so all of a feed is taken to be as far off as its corners. Rapids are not
/// rounded.
struct RoundedCorners {
    double by = 0.0;                // of feeds from now on; 0 under G61 and G61.1
    double of_cuts = 0.0;           // of those that have cut: the stock is known no better
    std::optional<ToolNumber> tool; // that has cut so
    bool by_several = false;        // tools

    /// Takes a feed that cuts.
    void note_cut(const std::optional<ToolNumber>& by_tool) {
        if (by == 0.0) return;
        by_several = by_several || (tool && tool != by_tool);
        tool = by_tool;
        of_cuts = std::max(of_cuts, by);
    }
};

/// What is stated before the program says anything.
RoundedCorners corners_at_start(const Machine& machine);

/// Takes a change of the path mode; whether it leaves a tolerance that nobody stated.
bool change_mode(RoundedCorners& corners, const PathModeChange& change, const Machine& machine);

/// How far the bodies of a pair may be off over a block whose feeds are by `of_block`.
double off_way(const Pair& pair, double of_block, const RoundedCorners& corners);

/// Whether a leg is straight and goes nowhere but up, or nowhere.
bool rises(const Leg& leg);

/// Whether a motion goes where its tool has cut, however corners were rounded: it is off as its
/// cuts were, or leaves them upwards, all of its legs (`rises`).
bool follows_cuts(const RoundedCorners& corners, const std::optional<ToolNumber>& tool, bool rises,
                  bool is_rapid);

/// Takes off the lower bound of a pair, and adds to the upper one, how far its bodies may be off.
///
/// Of a pair that may touch, the verdict about the stock stays where `follows_cuts` says that the
/// same tool is off as its cuts were, or leaves them upwards: it is where it has cut. Else it stays
/// if all that may stand of a corner is less than the contact depth.
///
/// `of_block`: by how much feeds of the block may be off; 0 if there was none.
void widen(PairClearance& pair, double of_block, const RoundedCorners& corners, bool follows_cuts);

} // namespace core
