#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "gcode/language/expression.h"
#include "gcode/language/modal_state.h"

namespace gcode {

struct Program;

enum class DialectId : uint8_t { linuxcnc, fanuc, haas, grbl, siemens, heidenhain, siemens_iso };

/// Syntax of a line: letters with numbers, or keywords.
enum class Language : uint8_t { words, klartext, siemens };

/// Allowed difference between the radii at the start and the end of an arc.
struct ArcTolerance {
    double absolute_mm;   // always allowed
    double absolute_inch; // the absolute tolerance in inches, while G20 is active
    double relative; // fraction of the radius; allowed up to `limit` times the absolute tolerance
    double limit;
    double warned_mm; // above the other limits and up to this: a warning; 0: always an error
};

/// Whose numbering the system variables follow.
enum class SystemParameters : uint8_t { rs274, siemens, fanuc, haas };

/// Whether macros can read the words and times of earlier blocks.
constexpr bool remembers_words(SystemParameters parameters) {
    return parameters == SystemParameters::fanuc || parameters == SystemParameters::haas;
}

/// The switches for block delete, and how a program names them.
enum class BlockDelete : uint8_t {
    none,       // a / has no effect, wherever it is
    one_switch, // a number after a / is that of the block
    from_zero,  // / is /0, and /1 is the second switch
    from_one,   // / is /1
};

/// The switch of a / without a number.
constexpr int number_of_plain_slash(BlockDelete switches) {
    return switches == BlockDelete::from_zero ? 0 : 1;
}

/// Which codes are not allowed between G41 and G40.
enum class ContourCodes : uint8_t { rs274, fanuc };

/// How the tool approaches a contour and passes outside corners.
enum class ContourStyle : uint8_t {
    rs274, // entry ends at the offset point of its own end; corners rounded
    fanuc, // entry ends at the offset start point of the next move; corners extended
};

/// The differences between controls. Everything the interpreter needs to know about a dialect.
struct Dialect {
    DialectId id;
    std::string_view name;
    DialectId codes; // the dialect whose G and M codes it has, in the table of codes
    bool supported;
    LengthUnit unit;       // initial, until G20 or G21
    bool unit_is_machines; // the initial unit is that of the machine instead
    RetractMode retract;   // initial, until G98 or G99
    ArcTolerance arc;
    double peck_clearance; // mm between the end of the rapid back into the hole and its bottom
    bool dwell_without_point_is_milliseconds; // P500 and P0.5 are both half a second
    bool dwell_takes_x_and_u;                 // G4 X1.5
    bool bare_length_offset_is_tool;          // G43 without H means the tool in the spindle
    bool cycles_are_rs274;  // exact path, spindle must run, G87 and G88 as in NISTIR 6556
    bool begins_with_g0;    // axis words before any motion code are a rapid; otherwise an error
    bool motion_codes_move; // G0 without axis words is a rapid to the current position, G2 an error
    bool cycles_are_motions;          // G80-G89 share a modal group with G0-G3
    bool axis_words_serve_one_code;   // G0 and G28 in one block are an error
    bool unused_words_are_errors;     // a K word that no code uses
    bool machine_move_is_rapid;       // G53 with any active motion code, also G1
    bool machine_move_bends;          // G53 and the way home of G28 and G30 are never straight
    bool machine_move_needs_g90;      // G53 with G91 is an error
    bool machine_move_needs_motion;   // G53 in a block without a move is an error
    bool length_needs_g43;            // otherwise a tool change activates the tool's length offset
    bool lone_h_is_length_offset;     // H without G43 changes an active length offset
    bool p_selects_more_offsets;      // G54 P1, G30 P3
    bool local_offset_is_axis_offset; // G52 and G92 write the same offset
    bool offset_writes_follow_g91;    // G10 L2 under G91 adds
    bool work_offsets_turn;           // G10 L2 R
    bool feed_before_units;           // F is read in the units of the blocks before
    bool g98_cycle_starts_high; // with G98 the move to the hole first retracts to the initial level
    bool cycle_stays_above_r;   // below R, a cycle first retracts to R; that is also its G98 level
    bool has_extended_offsets;  // G54.1 P1; G10 L20 P1 writes it
    bool has_older_tool_entries;  // G10 P R, and L1 for L11
    bool g87_is_back_boring;      // otherwise boring with manual retract
    bool cycle_levels_follow_g91; // with G91, R and Z programmed with G90 become distances
    bool boring_feeds_to_r;       // G85 and G89 feed to R and continue in rapid
    bool pecks_may_shrink;     // I, J, K of G73 and G83: first depth, reduction per peck, minimum
    bool peck_sign_is_ignored; // Q-2 pecks as Q2
    bool scale_without_point_is_thousandths; // G51 P2000 doubles
    bool cycles_run_with_axes_or_r; // a cycle runs in blocks with an axis word or R, and no others
    bool repeats_with_k;            // K repeats a canned cycle, as L does
    bool tape_mark_ends_program;    // a second % ends the program like M2
    bool runs_on_after_end;         // M2 and M30 only set modes back, and a % does nothing
    bool repeated_codes_are_errors; // the same G code twice in a block
    bool last_of_group_counts;      // of two G codes of a group; otherwise an error
    bool has_axis_commands; // G0-G3, G10, G28, G30, G38, G43.1, G49, G92: a block has at most one;
                            // G80 is in the group of G0, and axis words after it are an error
    bool clears_offset_after_move; // a move in the block of G92.1 still has the offset of G92

    // language syntax besides words
    Language language;
    std::optional<DialectId> iso_mode; // the dialect after G291; empty: there is only one language
    ExpressionSyntax expressions;
    Arithmetic arithmetic;
    bool tool_entries_by_axes;       // G10 L1, L10 and L11 take P and axis words
    bool arc_after_contour_is_error; // an arc in the block after G40
    bool contour_breaks_are_errors;  // G28, G53 and similar between G41 and G40
    ContourCodes contour_codes;      // which codes these are
    ContourStyle contour_style;
    bool radius_number_stays;   // G41 without D uses the last D, D0 cancels
    bool has_active_comments;   // (MSG, ...) and (DEBUG, ...)
    bool has_o_words;           // o<name> sub, if, while ...
    bool has_fanuc_flow;        // IF[] GOTO, WHILE[] DO, M98 P, G65
    bool deletes_within_blocks; // X1 /Y2 leaves out Y2
    BlockDelete block_delete;
    bool semicolon_ends_block;        // text after a ; can be a block; otherwise it is a comment
    bool comments_nest;               // otherwise a comment ends at the first ), or with its line
    bool has_parameters;              // #5, and values in brackets
    std::string_view refused_letters; // of words that make the control refuse their line
    size_t longest_line;              // characters besides blanks and comments; 0: no limit
    bool has_corner_words;            // ,R and ,C
    bool has_polar_words;             // @ and ^
    bool offset_words_may_repeat;     // I, J and K, as arguments of a macro
    bool brackets_optional_in_assignments; // #1=#2+1
    bool unset_is_vacant;                  // an unset parameter is vacant; otherwise 0
    bool feed_mode_clears_feed; // G94 and G95 clear the feed rate, even if the mode does not change
    bool bare_h0_is_tool;       // G43 H0 means the tool in the spindle
    bool home_cancels_length;   // G28 cancels the length offset, as G49 does
    bool repeats_in_program_number; // M98 P31000 calls O1000 three times
    bool calls_stand_alone;         // M98 and M99 allow no other words in their block
    bool decimal_points_matter;     // X5 may mean 5 least increments
    bool third_offset_is_ignored;   // K in an arc of the XY plane
    double assumed_feed;            // mm/min, used before the first F; 0: an error
    SystemParameters system_parameters;
    std::string_view parameter_letter; // of numbered parameters: # or R
    bool has_parameter_zero;           // R0
    bool names_are_declared;      // DEF REAL X; all names are local to a level, also those with _
    bool assigns_in_order;        // assignments apply to the rest of the block
    bool text_end_returns;        // the end of the text returns from a subprogram
    std::string_view radius_word; // of an arc: R or CR=
    int first_alarm;              // #3000=1 raises this alarm number plus 1
    int local_count;              // #1 to #n are local to a call level
    size_t deepest_calls;
    bool same_offset_stays;              // G54 while G54 is active does not reload the table
    bool offset_writes_miss_axis_offset; // G10 recomputes the position without G92
    bool surface_speed_needs_s;          // G96 needs S in the same block
    bool change_raises_z;                // M6 raises Z to machine zero before it exchanges the tool
    bool radius_arc_may_vanish;          // an arc with R that ends where it starts does not move
    bool stores_homes;       // G28 and G30 go where G28.1 and G30.1 were, also in earlier programs
    bool has_variables_file; // which can be read: LinuxCNC
};

const Dialect& dialect(DialectId id);

/// The dialect, if this version supports it.
///
/// Errors: unsupported, with the name of the dialect.
core::Result<DialectId> supported(DialectId id);

/// Whether a dialect has the codes of lathes: diameter mode and turning cycles.
bool has_lathe_codes(DialectId id);

/// All dialects, in the order of their enumerators.
std::span<const Dialect> all_dialects();

/// The names of all dialects, in the order of their enumerators.
std::span<const std::string_view> dialect_names();

/// The dialect with a name such as "fanuc"; empty if there is none.
std::optional<DialectId> dialect_named(std::string_view name);

struct Recognition {
    DialectId dialect;
    std::string reason;    // "line 2 is a program number (O1000)"
    std::string refusal{}; // why no dialect reads it: a control that is not supported, by name
};

/// The recognised dialect, if this version can read the program.
///
/// Errors: unsupported, with the name of the dialect or the control.
core::Result<DialectId> supported(const Recognition& recognition);

/// Recognises the dialect of a program and returns the evidence. Reads at most 10,000 blocks.
Recognition recognise(const Program& program);

} // namespace gcode
