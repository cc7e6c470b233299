#pragma once

#include <vector>

#include "gcode/exec/interpreter.h"
#include "gcode/exec/program_parameters.h"
#include "gcode/language/block.h"

namespace gcode {

/// A parameter that a block has set, and what it was before.
struct AssignmentUndo {
    bool is_named;
    double number;
    std::string name;
    Value value;
};

/// A block whose values are worked out, and where its parameters are.
struct Assigning {
    Block& block;
    const Dialect& dialect;
    ProgramParameters& parameters;
    std::vector<AssignmentUndo>& undos; // gets what was set, in order
    std::vector<Value>& values;         // room to work in
    BlockCommands& result;
    bool inch; // what lengths are in
};

/// Works out a block's words and sets its parameters: first the words, then all right-hand sides,
/// then the parameters; on some controls one by one as they stand in the block.
///
/// Errors: those of the expressions and parameters.
core::Result<void> work_out_block(const Assigning& assigning);

/// Gives parameters their old values.
void take_back_assignments(const std::vector<AssignmentUndo>& undos, ProgramParameters& parameters);

/// What a program says by setting #3000, an alarm, or #3006, a stop with a message. The message is
/// the block's comment.
///
/// Errors: invalid_value for an alarm: the control goes no further.
core::Result<void> heed_alarm(const Block& block, const Dialect& dialect, double number,
                              Value value, core::SourceSpan where, BlockCommands& result);

/// Says once that a program reads a clock, which stands still here.
void note_clock(const Block& block, InterpreterState& state, BlockCommands& result);

/// Emits what changed in the offsets since a block began.
void announce_offsets(const Offsets& before, const ModalState& modal, BlockCommands& result);

} // namespace gcode
