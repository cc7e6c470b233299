#pragma once

#include <vector>

#include "gcode/block.h"
#include "gcode/program_parameters.h"

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
    BlockResult& result;
    bool inch; // what lengths are in
};

/// Works out a block's words and sets its parameters: first the words, then all right-hand sides,
/// then the parameters; on some controls one by one as they stand in the block.
///
/// Errors: those of the expressions and parameters.
core::Result<void> work_out_block(const Assigning& assigning);

/// Gives parameters their old values.
void take_back_assignments(const std::vector<AssignmentUndo>& undos, ProgramParameters& parameters);

} // namespace gcode
