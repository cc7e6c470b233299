#pragma once

#include <vector>

#include "gcode/exec/interpreter.h"
#include "gcode/exec/program_parameters.h"
#include "gcode/language/block.h"
#include "gcode/language/dialect.h"

namespace gcode {

/// A parameter set by a block, with its previous value: for those of the call level, since
/// Parameters keeps the changes of those that all levels share.
struct AssignmentUndo {
    bool is_named;
    double number;
    std::string name;
    Value value;
};

/// A block to be evaluated, and its parameters.
struct Assigning {
    Block& block;
    const Dialect& dialect;
    ProgramParameters& parameters;
    std::vector<AssignmentUndo>& undos; // receives the assignments in order
    std::vector<Value>& values;         // scratch space
    BlockCommands& result;
    bool inch; // lengths are in inches
};

/// Evaluates the words of a block and sets its parameters: first the words, then all right-hand
/// sides, then the parameters. Some controls do this one by one in the order written.
///
/// Errors: those of the expressions and parameters.
core::Result<void> evaluate_block(const Assigning& assigning);

/// Whether a block has G4, in which X and P are times.
bool is_dwell(const Block& block);

/// Whether words with this letter are lengths or angles, which controls count in least increments.
bool counts_increments(char letter);

/// Restores the old values of the parameters of a call level.
void take_back_assignments(const std::vector<AssignmentUndo>& undos, ProgramParameters& parameters);

/// Executes an assignment to #3000 (alarm) or #3006 (stop with a message). The message is the
/// comment of the block.
///
/// Errors: invalid_value for an alarm, at which the control stops.
core::Result<void> execute_alarm(const Block& block, const Dialect& dialect, double number,
                                 Value value, core::SourceSpan where, BlockCommands& result);

/// Warns once that the program reads a clock, which is not simulated in real time.
void note_clock(const Block& block, InterpreterState& state, BlockCommands& result);

/// Emits the offsets if they changed during a block.
void announce_offsets(const Offsets& before, const ModalState& modal, BlockCommands& result);

} // namespace gcode
