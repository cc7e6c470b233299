#pragma once

#include "gcode/exec/interpreter.h"

namespace gcode {

struct Execution;

/// Where the machine is after a probing move between two positions, in the coordinates of either.
/// It goes on from the end, but may have stopped on the way. Axes of which that cannot be followed
/// are unknown: rotary axes, and all if a motion of the tip moves several machine axes.
Position where_probing_ends(const Offsets& offsets, const Position& from, Position to);

/// Emits a probing move and goes on from its end. The position is then uncertain by the way back to
/// the start.
void probe_to(Execution& execution, const StraightProbe& command);

/// Whether a probing move has ended at an unknown point, and an axis has not been positioned since.
bool is_stopped_somewhere(const ModalState& modal);

/// Moves to the farthest point at which the machine may be instead.
void start_elsewhere(ModalState& modal);

/// Compares a block with the same block run `elsewhere`, from the farthest point at which the
/// machine may be: an axis whose ends do not differ is positioned, one whose ends differ by as much
/// as the starts is as uncertain as before.
/// Notes in `result` which axes each of its motions positions, and what is uncertain afterwards.
///
/// Result: false if more than the ends of straight moves and arcs depends on the position, so that
///         the block has to be run from an unknown position. `state` is then of no use.
bool settle_positions(const ModalState& before, InterpreterState& state, BlockCommands& result,
                      InterpreterState& elsewhere, const BlockCommands& there);

/// Whether a numbered parameter is a coordinate that only the machine knows: of an axis whose
/// position is unknown, or of the machine after it has stopped somewhere.
bool reads_unknown_position(const ModalState& modal, const Environment& environment, int number);

/// The position without the axes that are uncertain.
Position known_position(const ModalState& modal);

/// Makes the position unknown in the axes that are uncertain.
void forget_uncertain_axes(ModalState& modal);

} // namespace gcode
