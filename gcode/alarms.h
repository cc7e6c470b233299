#pragma once

#include "gcode/interpreter.h"

namespace gcode {

/// What a program says by setting #3000, an alarm, or #3006, a stop with a message. The message is
/// the block's comment.
///
/// Errors: invalid_value for an alarm: the control goes no further.
core::Result<void> heed_alarm(const Block& block, const Dialect& dialect, double number,
                              Value value, core::SourceSpan where, BlockResult& result);

/// Says once that a program reads a clock, which stands still here.
void note_clock(const Block& block, InterpreterState& state, BlockResult& result);

/// Emits what changed in the offsets since a block began.
void announce_offsets(const Offsets& before, const ModalState& modal, BlockResult& result);

} // namespace gcode
