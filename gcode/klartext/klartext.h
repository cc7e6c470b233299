#pragma once

#include "gcode/exec/execution.h"
#include "gcode/exec/flow.h"

namespace gcode {

/// Carries out a block of Klartext: what begins with the block, its statement, what ends it.
core::Result<void> run_klartext(Execution& execution);

// The statements, a source for each topic.
core::Result<void> move_in_klartext(Execution& execution);     // L LP CC C CP CR CT CTP
core::Result<void> make_corner(Execution& execution);          // RND CHF
core::Result<void> call_klartext_tool(Execution& execution);   // TOOL CALL
core::Result<void> define_klartext_tool(Execution& execution); // TOOL DEF
core::Result<void> read_system_datum(Execution& execution);    // FN 18
core::Result<void> define_cycle(Execution& execution);         // CYCL DEF
core::Result<void> change_coordinates(Execution& execution);   // CYCL DEF 7, 8, 10, 11, 19
core::Result<void> call_defined_cycle(Execution& execution);   // M99, M89, CYCL CALL
core::Result<void> run_pattern(Execution& execution);          // CYCL DEF 220 and 221

/// The end of a motion, shortened where a rounding or chamfer follows it, which is remembered then.
///
/// `centre` and `turn` are those of an arc; turn 0 is a straight line.
/// Errors: invalid_value when the corner does not fit in; those of the blocks up to the motion
///         behind it.
core::Result<Position> end_before_corner(Execution& execution, const Position& end,
                                         const PlanePoint& centre, int turn);

/// LBL, CALL LBL, CALL PGM, IF..GOTO LBL, END PGM.
core::Result<void> run_klartext_flow(const FlowStep& step);

/// What a statement is refused with: its words first.
tl::unexpected<core::Error> refuse_statement(const Execution& execution, std::string_view why);

/// The feed of the statement in mm/min.
///
/// Errors: missing_value when no F came before it.
core::Result<double> klartext_feed(const Execution& execution);

/// A length that a cycle's Q parameter gives, in mm; a plain number.
double q_length(const Execution& execution, int number);
double q_number(const Execution& execution, int number);

} // namespace gcode
