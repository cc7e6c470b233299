#pragma once

#include <string_view>

#include "gcode/exec/execution.h"
#include "gcode/exec/flow.h"

namespace gcode {

struct FlowIndex;
struct LanguageFunctions;

/// The language of ISO 6983: letters with numbers, with the macro languages of LinuxCNC and Fanuc.
extern const LanguageFunctions iso_language;

core::Result<void> parse_iso(std::string_view text, uint32_t line, const Dialect& dialect,
                             Block& block);

FlowIndex iso_index(const Program& program, const Dialect& dialect);

core::Result<void> run_iso_flow(const FlowStep& step);

/// Executes a block of codes and words in the prescribed order, and checks the modal rules.
///
/// Source: NISTIR 6556 (RS274/NGC v3), 3.8, order of execution.
core::Result<void> execute_iso(Execution& execution, const ModalState& before);

core::Result<void> act(Execution& execution);  // G10 G28 G30 G52 G92
core::Result<void> move(Execution& execution); // G0 to G3, G73 to G89, with G53
/// G92.1 where the move of its block still has the offset.
core::Result<void> clear_offset_after_move(Execution& execution);

/// Whether the control allows only one axis command in a block.
bool has_axis_commands(const Execution& execution);

/// Reports what is wrong with the axis commands of a block, of which the control runs no word then:
/// two of them, axis words that are missing or do not belong to them, or axis words after G80.
///
/// Source: Grbl 1.1, gcode.c, gc_execute_line, steps 2 and 3.
core::Result<void> check_axis_commands(Execution& execution);

/// Reports an arc without an end in its plane.
///
/// Source: as above.
core::Result<void> check_end_of_arc(const Execution& execution);

} // namespace gcode
