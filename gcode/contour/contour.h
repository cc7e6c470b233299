#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "gcode/contour/flat_path.h"
#include "gcode/contour/radius_compensation.h"
#include "gcode/language/canonical.h"
#include "gcode/language/dialect.h"
#include "gcode/language/modal_state.h"

namespace gcode {

/// `,R` or `,C` in the block of a motion.
struct CornerWord {
    CornerKind kind = CornerKind::rounding;
    double size = 0.0; // mm
    core::SourceSpan where{};
    std::string written{};

    bool operator==(const CornerWord&) const = default;
};

/// An executed block and the modal states before and after it.
struct ExecutedBlock {
    BlockCommands result;
    ModalState before, after;

    bool operator==(const ExecutedBlock&) const = default;
};

/// The corners of a run. A block that ends in a corner is held back until the next motion is known,
/// together with the blocks in between. Part of the interpreter's state.
struct Corners {
    std::optional<CornerWord> asked{}; // in the block being executed
    std::optional<CornerWord> word{};  // in the first waiting block
    CornerSide first{};                // motion of the first waiting block, in the plane
    std::vector<ExecutedBlock> waiting{};

    bool is_idle() const { return !asked && !word; }
    bool operator==(const Corners&) const = default;
};

/// Takes a block and adds the blocks that are now complete to `ready`, in order. A corner becomes
/// the last command of the block in which it was programmed.
///
/// Errors: invalid_value when the corner does not fit, missing_value when no motion in the plane
///         follows. Then the block is not added; the waiting ones stay.
/// Source: Fanuc 30i user's manual B-63944EN-2, "Optional chamfering and corner R": which blocks
///         may come between the two motions; no corner is inserted where the directions differ by
///         less than one degree.
core::Result<void> add_to_corners(Corners& corners, ExecutedBlock block,
                                  std::vector<ExecutedBlock>& ready);

/// Reports a corner that is still waiting at the end of the program.
///
/// Errors: missing_value if there is one.
core::Result<void> end_corners(const Corners& corners);

/// Returns the waiting blocks as programmed, without the corner, and clears them.
std::vector<ExecutedBlock> give_up_corners(Corners& corners);

/// A block whose motions are being offset by the cutter radius, with the results so far.
struct PendingBlock {
    struct Slot {
        Position start;                        // as programmed
        std::vector<CanonicalCommand> moves{}; // the compensated motion
        bool is_waiting = false;

        bool operator==(const Slot&) const = default;
    };

    BlockCommands result;
    std::vector<Slot> slots; // one for each command

    bool operator==(const PendingBlock&) const = default;
};

/// Corners and cutter radius compensation of a run. Takes blocks as programmed and returns them
/// with the moves of the tool centre once these are final. Part of the interpreter's state.
struct Contour {
    Corners corners{};                      // blocks waiting here are not compensated yet
    std::optional<RadiusCompensation> path; // while compensation is on
    Plane plane = Plane::xy;
    FlatPoint tip{};     // from the centre of a turning tool's nose to the controlled point
    bool pauses = false; // the block being executed leaves the contour
    ContourStyle style = ContourStyle::rs274;
    bool extends_ends = false;   // of the next path, as in RadiusCompensation
    bool enters_upright = false; // likewise
    OutsideCorners outside{};    // likewise
    size_t look_ahead = 3;       // blocks that the control reads ahead
    std::deque<PendingBlock> pending{};
    std::deque<BlockCommands> ready{};
    size_t first_pending = 0;             // number of blocks before the pending ones
    std::optional<core::Error> failure{}; // reported after the ready blocks

    bool is_idle() const {
        return corners.is_idle() && !path && pending.empty() && ready.empty() && !failure;
    }
    bool operator==(const Contour&) const = default;
};

/// Adds an executed block, with the state before and after it.
///
/// Errors: those of the corners, of add_move and of end_compensation. Then the block is not added.
core::Result<void> take_block(Contour& contour, const BlockCommands& block,
                              const ModalState& before, const ModalState& after);

/// Ends the program: all waiting moves become final as they are.
///
/// Errors: a corner is still waiting for a motion.
core::Result<void> end_contour(Contour& contour);

/// Ends the compensation: all waiting moves become final as they are.
void give_up(Contour& contour);

} // namespace gcode
