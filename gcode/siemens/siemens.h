#pragma once

#include "gcode/exec/execution.h"
#include "gcode/siemens/siemens_flow.h"
#include "gcode/siemens/siemens_state.h"

namespace gcode {

struct LanguageFunctions;

/// Native Siemens, SINUMERIK 840D.
extern const LanguageFunctions siemens_language;

/// Runs a block of native Siemens that is not a flow statement.
core::Result<void> run_siemens(Execution& execution, const ModalState& before);

/// Whether the call level may change in this block.
bool changes_levels_in_siemens(const Statement& statement, const InterpreterState& state);

/// The value of a system variable such as `$aa_im[x]`; empty if it is not supported.
std::optional<Value> siemens_variable(const InterpreterState& state, std::string_view name);

// Steps of a block.
core::Result<void> use_siemens_words(Execution& execution);     // unused words, units, feed
core::Result<void> use_siemens_tool(Execution& execution);      // T, M6
core::Result<void> select_siemens_plane(Execution& execution);  // G17 G18 G19
core::Result<void> use_siemens_edge(Execution& execution);      // D
core::Result<void> select_siemens_offset(Execution& execution); // G54 G500 G505
core::Result<void> set_siemens_radius(Execution& execution);    // G40 G41 G42
core::Result<void> change_siemens_frame(Execution& execution);  // TRANS ROT SCALE MIRROR
void delete_siemens_frame(Execution& execution);                // as TRANS alone
/// CYCLE800.
core::Result<void> swivel(Execution& execution, const SiemensKeywordUse& use);
/// The plane of CYCLE800, before the frame of the program. Not on: level.
void use_swivelled_plane(Execution& execution, const ProgramFrame& plane, bool is_on);
/// TRAORI and TRAFOOF.
core::Result<void> switch_orientation(Execution& execution, const SiemensKeywordUse& use);
/// TOROT and TOROTOF.
core::Result<void> use_tool_frame(Execution& execution, const SiemensKeywordUse& use);
/// ORIAXES, ORIVECT, ORIMKS, ORIWKS and the like.
void choose_orientation(Execution& execution, SiemensAction action);
/// Decides before a move how the tool turns, and checks the words for its direction.
core::Result<void> prepare_orientation(Execution& execution);
core::Result<void> set_pole(Execution& execution);             // G110 G111 G112
core::Result<void> move_in_siemens(Execution& execution);      // G0 to G3, CIP, CT, polar positions
core::Result<void> go_to_fixed_position(Execution& execution); // G74 G75
core::Result<void> run_siemens_cycle(Execution& execution, const SiemensKeywordUse& use);
/// Drilling cycles and hole patterns.
core::Result<void> run_hole_cycle(Execution& execution, const SiemensKeywordUse& use);
core::Result<void> drill_here(Execution& execution, const SiemensDrilling& cycle);
core::Result<void> run_siemens_holes(Execution& execution, const SiemensKeywordUse& use);

/// What the path mode and its words say of the corners.
void set_corner_tolerances(const SiemensState& siemens, ModalState& modal);

/// The parameters of a cycle in order; empty where one is left out.
core::Result<std::vector<std::optional<double>>> cycle_values(Execution& execution,
                                                              const SiemensKeywordUse& use);

/// Changes the offsets without moving the machine, and adds to `travel` by how much the position
/// that was programmed last moves with them.
void change_siemens_offsets(Execution& execution, const Offsets& offsets, AxisValues& travel);

/// The axis has been moved: earlier changes of offsets have been travelled.
void forget_travel(Execution& execution, size_t axis);

/// Decides before a move which tool length is active, and along which axis.
void settle_length(Execution& execution, bool straight);

/// The block's keyword of a kind; null when it has none.
const SiemensKeywordUse* use_of(const Execution& execution, SiemensAction action);

/// The flow step of the block, for evaluating arguments and for calls.
FlowStep flow_step_of(Execution& execution);

/// Sets the spindle as with M3, M4 or M5; other numbers act as M5.
void turn_siemens_spindle(Execution& execution, int code);

} // namespace gcode
