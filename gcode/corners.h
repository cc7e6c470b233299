#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "gcode/block_result.h"
#include "gcode/corner_geometry.h"
#include "gcode/modal_state.h"

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

} // namespace gcode
