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

/// `,R` or `,C` behind a motion.
struct CornerWord {
    CornerKind kind = CornerKind::rounding;
    double size = 0.0; // mm
    core::SourceSpan where{};
    std::string written{};
};

/// A block as executed, with the modes and the place before and after it.
struct ExecutedBlock {
    BlockResult result;
    ModalState before, after;
};

/// The corners of a run: a block that ends in one waits for the motion behind it, and what stands
/// between them waits as well. Part of the interpreter's state.
struct Corners {
    std::optional<CornerWord> asked{}; // by the block that is being executed
    std::optional<CornerWord> word{};  // of the first block that waits
    CornerSide first{};                // its motion in the plane
    std::vector<ExecutedBlock> waiting{};

    bool is_idle() const { return !asked && !word; }
    bool operator==(const Corners& other) const;
};

/// Takes a block and returns those that are complete now, in order: the corner is then the last
/// command of the block that it was written in.
///
/// Errors: invalid_value when the corner does not fit, missing_value when no motion in the plane
///         follows. The blocks that waited are dropped then.
/// Source: Fanuc 30i user's manual B-63944EN-2, "Optional chamfering and corner R": what may stand
///         between the two motions, and that within one degree of straight on there is no corner.
core::Result<std::vector<ExecutedBlock>> take_for_corners(Corners& corners, ExecutedBlock block);

/// What the end of the program means for a corner that still waits.
///
/// Errors: missing_value when one does.
core::Result<void> end_corners(Corners& corners);

/// The blocks that wait, as programmed; they wait no longer.
std::vector<ExecutedBlock> give_up_corners(Corners& corners);

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
