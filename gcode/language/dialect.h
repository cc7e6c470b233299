#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "gcode/language/expression.h"
#include "gcode/language/modal_state.h"

namespace gcode {

struct Program;

enum class DialectId : uint8_t { linuxcnc, fanuc, haas, grbl, siemens, heidenhain, siemens_iso };

/// The syntax of lines: letters with numbers, or keywords.
enum class Language : uint8_t { words, klartext, siemens };

/// How far the radius to an arc's end may be from the radius to its start.
struct ArcTolerance {
    double absolute_mm;   // always allowed
    double absolute_inch; // the same in inches, while G20 is active
    double relative;      // of the radius: allowed up to `limit` times the absolute tolerance
    double limit;
    double warned_mm; // beyond the above but not beyond this: a warning; 0 refuses
};

/// Whose numbers the parameters have in which a control shows its state.
enum class SystemParameters : uint8_t { rs274, siemens, fanuc, haas };

/// Whether a control's macros can ask for the words and times of the blocks before.
constexpr bool remembers_words(SystemParameters parameters) {
    return parameters >= SystemParameters::fanuc;
}

/// Which codes interrupt the contour between G41 and G40.
enum class ContourCodes : uint8_t { rs274, fanuc };

/// How the tool approaches a contour and passes its outside corners.
enum class ContourStyle : uint8_t {
    rs274, // beside the end of the entry; round corners
    fanuc, // beside the start of the move after the entry; straight on at corners
};

/// How the controls of one kind differ. Everything the interpreter asks about a dialect is here.
struct Dialect {
    DialectId id;
    std::string_view name;
    bool supported;
    LengthUnit unit;       // until G20 or G21
    bool unit_is_machines; // instead, the unit that the machine is set up in
    RetractMode retract;   // until G98 or G99
    ArcTolerance arc;
    double peck_clearance; // mm left between a rapid back into the hole and its bottom
    bool dwell_without_point_is_milliseconds; // P500 is half a second, P0.5 as well
    bool dwell_takes_x_and_u;                 // G4 X1.5
    bool bare_length_offset_is_tool;          // G43 without H means the tool in the spindle
    bool cycles_are_rs274;  // exact path, spindles that turn, G87 and G88 as NISTIR 6556 has them
    bool begins_with_g0;    // axis words before any motion code are a rapid, else an error
    bool motion_codes_move; // G0 without axis words is a rapid to the current position, G2 an error
    bool cycles_are_motions;          // G80-G89 share a modal group with G0-G3
    bool axis_words_serve_one_code;   // G0 and G28 in one block are refused
    bool unused_words_are_errors;     // a K word where nothing uses it
    bool machine_move_is_rapid;       // G53 under any motion code, G1 as well
    bool machine_move_needs_g90;      // G53 under G91 is not as under G90
    bool machine_move_needs_motion;   // G53 in a block that does not move is refused
    bool length_needs_g43;            // else a tool change puts its length on
    bool lone_h_is_length_offset;     // H without G43, while a length offset is on
    bool p_names_more_places;         // G54 P1, G30 P3
    bool local_offset_is_axis_offset; // G52 and G92 write the same offset
    bool offset_writes_follow_g91;    // G10 L2 under G91 adds
    bool work_offsets_turn;           // G10 L2 R
    bool feed_before_units;           // F is read in the units of the blocks before
    bool g98_cycle_starts_high;       // under G98 the way to the hole climbs to the initial level
    bool cycle_stays_above_r;         // from below R a cycle first climbs to R, and G98 ends there
    bool has_extended_offsets;        // G54.1 P1; G10 L20 P1 writes it
    bool diameters_in_tool_entries;   // G10 L12 R is a diameter, else a radius
    bool g87_is_back_boring;          // else boring with a retract by hand
    bool cycle_levels_follow_g91;     // R and Z said under G90 count as ways under G91
    bool boring_feeds_to_r;           // G85 and G89 climb beyond R in a rapid
    bool pecks_may_shrink;            // I, J and K of G73 and G83: the first, less each, the least
    bool peck_sign_is_ignored;        // Q-2 pecks as Q2
    bool scale_without_point_is_thousandths; // G51 P2000 doubles
    bool repeats_with_k;                     // K repeats a canned cycle, as L does
    bool tape_mark_ends_program;             // a second % is as good as M2
    bool repeated_codes_are_errors;          // the same G code twice in a block

    // the language around the words
    Language language;
    ExpressionSyntax expressions;
    Arithmetic arithmetic;
    bool tool_entries_by_axes;       // G10 L1, L10 and L11 take P and axis words
    bool arc_after_contour_is_error; // an arc in the block after G40
    bool contour_breaks_are_errors;  // G28, G53 and the like between G41 and G40
    ContourCodes contour_codes;      // what is like G28 and G53 there
    ContourStyle contour_style;
    bool radius_number_stays;              // G41 without D uses the last D, D0 cancels
    bool has_active_comments;              // (MSG, ...) and (DEBUG, ...)
    bool has_o_words;                      // o<name> sub, if, while ...
    bool has_fanuc_flow;                   // IF[] GOTO, WHILE[] DO, M98 P, G65
    bool deletes_within_blocks;            // X1 /Y2 leaves out Y2
    bool has_corner_words;                 // ,R and ,C
    bool has_polar_words;                  // @ and ^
    bool offset_words_may_repeat;          // I, J and K, as arguments of a macro
    bool brackets_optional_in_assignments; // #1=#2+1
    bool unset_is_vacant;                  // an unset parameter is nothing, else 0
    bool feed_mode_clears_feed;     // G94 and G95 leave no feed rate, the same mode again as well
    bool bare_h0_is_tool;           // G43 H0 means the tool in the spindle
    bool repeats_in_program_number; // M98 P31000 calls O1000 three times
    bool calls_stand_alone;         // M98 and M99 have no other words beside them
    bool decimal_points_matter;     // X5 may mean 5 of the smallest steps
    double assumed_feed;            // mm/min of a feed that no F came before; 0 refuses
    SystemParameters system_parameters;
    std::string_view parameter_letter; // of numbered parameters: # or R
    bool has_parameter_zero;           // R0
    bool names_are_declared;           // DEF REAL X; names are of one level, also those with _
    bool assigns_in_order;             // assignments take effect for the rest of the block
    bool machine_places_are_of_tip;    // G53 and SUPA leave the tool's length on
    bool text_end_returns;             // from a subprogram
    std::string_view radius_word;      // of an arc: R or CR=
    int first_alarm;                   // #3000=1 is the alarm after this
    int local_count;                   // #1 to this are of each level of calls
    size_t deepest_calls;
    bool same_offset_stays;              // G54 while G54 is active does not reload the table
    bool offset_writes_miss_axis_offset; // G10 recomputes the position without G92
    bool surface_speed_needs_s;          // G96 has its S in the same block
};

const Dialect& dialect(DialectId id);

/// The dialect of a name such as "fanuc"; empty when there is none of that name.
std::optional<DialectId> dialect_named(std::string_view name);

struct Recognition {
    DialectId dialect;
    std::string reason; // "line 2 is a program number (O1000)"
};

/// The dialect that a program seems to be written in, and the evidence. Reads 10,000 blocks at
/// most.
Recognition recognise(const Program& program);

} // namespace gcode
