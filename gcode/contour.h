#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "core/base/result.h"
#include "gcode/block_result.h"
#include "gcode/corners.h"
#include "gcode/dialect.h"
#include "gcode/modal_state.h"
#include "gcode/radius_compensation.h"

namespace gcode {

/// A block whose motions are being moved aside by the cutter's radius: its commands, and what has
/// become of each of them so far.
struct PendingBlock {
    struct Slot {
        Position start;                        // as programmed
        std::vector<CanonicalCommand> moves{}; // what has become of a motion
        bool is_waiting = false;
    };

    BlockResult result;
    std::vector<Slot> slots; // one for each command
};

/// Corners and cutter radius compensation of a run: blocks go in as programmed and come out with
/// the moves of the tool's centre, as soon as these are final. Part of the interpreter's state.
struct Contour {
    Corners corners{};                      // what waits here has not come to the compensation yet
    std::optional<RadiusCompensation> path; // while compensation is on
    Plane plane = Plane::xy;
    FlatPoint tip{};     // from the centre of a turning tool's nose to the point that is controlled
    bool pauses = false; // the block being executed takes the tool away from the contour
    ContourStyle style = ContourStyle::rs274;
    std::deque<PendingBlock> pending{};
    std::deque<BlockResult> ready{};
    size_t first_pending = 0;             // how many blocks came before the pending ones
    std::optional<core::Error> failure{}; // what comes behind the ready blocks

    bool is_idle() const {
        return corners.is_idle() && !path && pending.empty() && ready.empty() && !failure;
    }
    bool operator==(const Contour& other) const;
};

/// Takes a block as executed, with the state before and after it.
///
/// Errors: those of the corners, of add_move and of end_compensation; the block is then not taken.
core::Result<void> take_block(Contour& contour, const BlockResult& block, const ModalState& before,
                              const ModalState& after);

/// The program has come to its end: what waits becomes final as it stands.
///
/// Errors: a corner waits for a motion.
core::Result<void> end_contour(Contour& contour);

/// Ends the compensation where it is: what waits becomes final as it stands.
void give_up(Contour& contour);

} // namespace gcode
