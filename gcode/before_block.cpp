#include "gcode/before_block.h"

namespace gcode {

void keep_calls(const InterpreterState& state, BeforeBlock& before) {
    before.has_calls = true;
    before.frames = state.frames;
    before.modal_macros = state.modal_macros;
}

void keep(const InterpreterState& state, BeforeBlock& before) {
    before.modal = state.modal;
    before.next = state.next;
    before.next_block = state.next_block;
    before.tape_open = state.tape_open;
    before.said_unit = state.said_unit;
    before.said_home = state.said_home;
    before.ending = state.ending;
    before.said_time = state.said_time;
    before.points = state.points;
    before.rules = state.rules;
    before.tables = state.tables;
    before.klartext = state.klartext;
    before.spline = state.spline;
    before.siemens = state.siemens;
    before.has_calls = false;
}

void restore(InterpreterState& state, const BeforeBlock& before) {
    state.modal = before.modal;
    state.next = before.next;
    state.next_block = before.next_block;
    state.tape_open = before.tape_open;
    state.said_unit = before.said_unit;
    state.said_home = before.said_home;
    state.ending = before.ending;
    state.said_time = before.said_time;
    state.points = before.points;
    state.rules = before.rules;
    state.tables = before.tables;
    state.klartext = before.klartext;
    state.spline = before.spline;
    state.siemens = before.siemens;
}

void restore_calls(InterpreterState& state, const BeforeBlock& before) {
    if (!before.has_calls) return;
    state.frames = before.frames;
    state.modal_macros = before.modal_macros;
}

} // namespace gcode
