#pragma once

#include "gcode/exec/execution.h"
#include "gcode/exec/flow.h"
#include "gcode/klartext/klartext_line.h"
#include "gcode/klartext/klartext_state.h"

namespace gcode {

struct LanguageFunctions;

/// Heidenhain Klartext.
extern const LanguageFunctions klartext_language;

/// Runs a block of Klartext: the codes that act before its statement, the statement, then the codes
/// that act after it.
core::Result<void> run_klartext(Execution& execution, const ModalState& before);

// The statements.
core::Result<void> move_in_klartext(Execution& execution); // L LP CC C CP CR CT CTP
/// CYCL CALL POS: to the point in the plane, and to the height `above` the surface.
core::Result<void> go_to_cycle(Execution& execution, double surface, double above);
core::Result<void> make_corner(Execution& execution);          // RND CHF
core::Result<void> call_klartext_tool(Execution& execution);   // TOOL CALL
core::Result<void> define_klartext_tool(Execution& execution); // TOOL DEF
core::Result<void> read_system_datum(Execution& execution);    // FN 18
core::Result<void> define_cycle(Execution& execution);         // CYCL DEF
core::Result<void> change_coordinates(Execution& execution);   // CYCL DEF 7, 8, 10, 11, 19
core::Result<void> set_plane(Execution& execution);            // PLANE
core::Result<void> call_defined_cycle(Execution& execution);   // M99, M89, CYCL CALL
core::Result<void> run_pattern(Execution& execution);          // CYCL DEF 220 and 221

/// Makes a tilted plane the last of the transformations, or removes it.
///
/// Errors: others came after it.
core::Result<void> use_plane(Execution& execution, const std::optional<core::Mat3>& axes);

/// The rotation by spatial angles about the fixed axes X, then Y, then Z, in degrees.
core::Mat3 spatial_rotation(const core::Vec3& angles);

/// The positions of the rotary axes that tilt the tool into the plane; stores them in Q120 to Q122.
/// Only with a machine.
core::Result<AxisValues> calculate_plane(Execution& execution);

/// The end of a motion, shortened if a rounding or chamfer follows, which is then stored.
///
/// `centre` and `turn` are those of an arc; turn 0 is a straight line.
/// Errors: invalid_value when the corner does not fit; those of the blocks up to the next motion.
core::Result<Position> end_before_corner(Execution& execution, const Position& end,
                                         const PlanePoint& centre, int turn);

/// LBL, CALL LBL, CALL PGM, IF..GOTO LBL, END PGM.
core::Result<void> run_klartext_flow(const FlowStep& step);

/// The words of the statement, without comments.
std::string words_of(const Execution& execution);

/// An error about the statement; its message starts with the words of the statement.
tl::unexpected<core::Error> refuse_statement(const Execution& execution, std::string_view why);

/// The feed of the statement in mm/min.
///
/// Errors: missing_value when no F has been programmed yet.
core::Result<double> klartext_feed(const Execution& execution);

/// The value of a Q parameter of a cycle: as a length in mm, and as a plain number.
double q_length(const Execution& execution, int number);
double q_number(const Execution& execution, int number);

} // namespace gcode
