#pragma once

#include "gcode/interpreter.h"

namespace gcode {

/// What a block may change, kept until it has succeeded.
struct BeforeBlock {
    ModalState modal;
    Place next;
    uint32_t next_block;
    bool tape_open, said_unit, said_home;
    Ending ending;
    bool said_time;
    DecimalPoints points;
    RuleWatch rules;
    Shared<Tables> tables;
    Shared<KlartextState> klartext;
    Shared<SplineState> spline;
    Shared<SiemensState> siemens;
    // Only of blocks that call or return.
    bool has_calls = false;
    std::vector<Frame> frames;
    std::vector<ModalMacro> modal_macros;
};

void keep(const InterpreterState& state, BeforeBlock& before);
void restore(InterpreterState& state, const BeforeBlock& before);

/// The levels of calls are large, so they are kept apart from the rest and only for few blocks.
void keep_calls(const InterpreterState& state, BeforeBlock& before);
void restore_calls(InterpreterState& state, const BeforeBlock& before); // if they were kept

} // namespace gcode
