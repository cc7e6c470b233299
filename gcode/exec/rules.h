#pragma once

#include <cstdint>

namespace gcode {

struct Execution;
struct ModalState;

/// What the rules about a program remember from block to block: what they wait for, and what was
/// said already. It has no part in how a program goes on.
struct RuleWatch {
    bool lacks_length = false;     // a tool came into the spindle, no length offset since
    bool length_cancelled = false; // G49 with a tool in the spindle, no length offset since
    bool offset_is_fresh = true;   // no motion yet under the active work offset
    bool increments_stay = false;  // G91 was on when the tool was changed
    bool has_moved = false;
    bool said_block_delete = false;

    bool waits() const {
        return lacks_length || length_cancelled || offset_is_fresh || increments_stay;
    }
};

/// Warns of what a control accepts and a machinist regrets, as far as the program, the tool table
/// and the work offsets show it: to be called after a block was carried out, with the modes before
/// it.
///
/// Rules: missing-length-offset, length-offset-cancelled, work-offset-unset, home-through-part,
///        machine-move-with-state, incremental-left-on, state-left-over, units-jump, block-delete.
///        offset-not-tool, tool-not-in-table and missing-decimal-point are where the words are
///        read.
/// Cost:  next to nothing for a block that only moves.
void check_modal_rules(Execution& execution, const ModalState& before);

} // namespace gcode
