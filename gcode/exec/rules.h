#pragma once

#include <cstdint>

namespace gcode {

struct Execution;
struct ModalState;

/// The memory of the modal rules: what they wait for, and what they have already reported. It does
/// not influence how the program continues.
struct RuleState {
    bool lacks_length = false;     // a tool was changed in, without a length offset since
    bool g43_lacks_h = false;      // the last G43 or G44 found no length offset to apply
    bool length_cancelled = false; // G49 with a tool in the spindle, without a length offset since
    bool offset_is_fresh = true;   // no motion yet with the active work offset
    bool increments_stay = false;  // G91 was active at the tool change
    bool has_moved = false;
    bool said_block_delete = false;

    bool waits() const {
        return lacks_length || length_cancelled || offset_is_fresh || increments_stay;
    }
};

/// Warns of mistakes that a control accepts, if program, tool table and work offsets show
/// them. Call after a block was executed, with the modes before it.
///
/// Rules: missing-length-offset, length-offset-cancelled, work-offset-unset, home-through-part,
///        machine-move-with-state, incremental-left-on, state-left-over, units-jump, block-delete.
///        (offset-not-tool, tool-not-in-table and missing-decimal-point are checked where the words
///        are read.)
/// Cost:  negligible for a block that only moves.
void check_modal_rules(Execution& execution, const ModalState& before);

} // namespace gcode
