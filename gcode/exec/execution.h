#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "gcode/exec/interpreter.h"
#include "gcode/exec/statement.h"
#include "gcode/language/environment.h"

namespace gcode {

/// The direction of the tool that a block programs, from the tip up. Program coordinates.
struct ToolDirection {
    core::Vec3 direction = core::Vec3(0.0);
    const Word* word = nullptr; // one of its words
};

/// A block being executed: its words, the state it changes and its commands. Each of the functions
/// below is a step: it executes its words, or does nothing.
struct Execution {
    ProgramLibrary& library;
    const Environment& environment;
    const Dialect& dialect;
    const Block& block;
    const Statement& statement;
    InterpreterState& state;
    BlockCommands& result;
    uint32_t column = 1; // of the word being executed
    // By angles, where the block has them. Words for rotary axes are then no positions.
    std::optional<ToolDirection> tool_by_angles{};
    // The block turns the tool in a way that is not modelled, and so the words do not count either.
    bool loses_rotary_axes = false;

    ModalState& modal() { return state.modal; }
    const ModalState& modal() const { return state.modal; }
    void emit(CanonicalCommand command) {
        result.commands.push_back(std::move(command));
        result.columns.push_back(column);
    }
    void warn(core::SourceSpan where, std::string message, Severity severity = Severity::warning) {
        result.warnings.push_back({severity, where, std::move(message)});
    }

    /// Emits a rapid or a feed to `end` and updates the position.
    void traverse(const Position& end, std::optional<core::RapidStyle> style = {});
    void feed(const Position& end, double rate);
};

/// Whether the block moves in machine coordinates: G53, G153 or SUPA.
bool in_machine_coordinates(const Execution& execution);

/// The word that makes the block move: its motion or cycle code, else its first axis word.
const Word& moving_word(const Execution& execution);

/// The length given by a word, in mm.
double length_of(const Execution& execution, const Word& word);

/// The length of the word with this letter, in mm; empty if there is none.
std::optional<double> length_word(const Execution& execution, char letter);

/// The maximum number of commands of one block.
inline constexpr size_t most_commands = 200000;

/// Whether an H word without G43 changes the active length offset.
bool changes_length_alone(const Execution& execution);

/// Takes the active length offset from the table again. The machine does not move.
void reload_length(Execution& execution);

/// The value of an axis word: mm; degrees for a rotary axis; halved for X with G7.
double axis_value(const Execution& execution, size_t axis, const Word& word);

/// Whether an axis word counts from the current position: by G91, or by itself.
bool is_incremental(const Execution& execution, const Word& word);

/// The end position given by the axis words, in program coordinates.
core::Result<Position> target_of(const Execution& execution);

/// Completes the end of a straight move from `,A`, its angle from the first axis of the plane.
///
/// Errors: missing_value, invalid_value, syntax or unsupported where no single end follows.
core::Result<void> place_by_angle(const Execution& execution, Position& target);

/// The length of a straight move as the feed rate counts it: along X, Y, Z; if these do not move,
/// along U, V, W; else along the rotary axes, in degrees. Empty if an end is unknown.
std::optional<double> distance_between(const Position& from, const Position& to);

/// Why there is no feed rate before the first F.
inline constexpr std::string_view no_feed_yet = "no feed rate: no F has been programmed yet";

/// The feed rate along a path in mm/min.
///
/// Errors: missing_value without F (with G93: in this block), with a stopped spindle under G95, or
///         with an unknown path length under G93; invalid_value for F0.
core::Result<double> feed_rate(const Execution& execution, std::optional<double> path_length);

/// The rate of a straight feed from the present position to `end`: `rate` is that of F. Where only
/// rotary axes move, F per minute is in degrees, also if it was programmed in inches.
double rate_to(const ModalState& modal, const Position& end, double rate);

/// Changes the offsets without moving the machine; the program coordinates change instead.
void change_offsets(Execution& execution, const Offsets& offsets);

/// The time of a dwell in seconds.
///
/// Errors: invalid_value for a negative time.
core::Result<double> dwell_time(const Execution& execution, const Word& word);

/// Warns of the M codes of the block that are unknown and may be ignored.
void warn_of_unknown_m_codes(Execution& execution);

core::Result<void> check_words(Execution& execution); // reports unused words
core::Result<void> note_assumed_units(Execution& execution);
core::Result<void> set_feed_mode(Execution& execution);         // G93 G94 G95
core::Result<void> set_feed(Execution& execution);              // F
core::Result<void> set_speed(Execution& execution);             // S
core::Result<void> select_tool(Execution& execution);           // T
core::Result<void> change_tool(Execution& execution);           // M6
core::Result<void> turn_spindle(Execution& execution);          // M3 M4 M5 M19
core::Result<void> say_message(Execution& execution);           // (MSG, ...)
core::Result<void> set_spindle_mode(Execution& execution);      // G96 G97
core::Result<void> switch_machine(Execution& execution);        // M62 to M68
core::Result<void> save_or_restore_modes(Execution& execution); // M70 to M73
core::Result<void> set_coolant(Execution& execution);           // M7 M8 M9
core::Result<void> set_overrides(Execution& execution);         // M48 to M53
core::Result<void> dwell(Execution& execution);                 // G4
core::Result<void> select_plane(Execution& execution);          // G17 G18 G19
core::Result<void> set_units(Execution& execution);             // G20 G21
core::Result<void> set_diameter_mode(Execution& execution);     // G7 G8
core::Result<void> set_cutter_radius(Execution& execution);     // G40 G41 G42
core::Result<void> set_path_mode(Execution& execution);         // G61 G61.1 G64
core::Result<void> set_tool_length(Execution& execution);       // G43 G43.1 G44 G49, H
void cancel_length_offset(Execution& execution);
/// On Fanuc mills, what a move of these axes to machine coordinates (G28, G30, G53) does to a
/// length offset along them.
void leave_length_behind(Execution& execution, const std::array<bool, axis_count>& moved);
/// Asks whether the control has restored the length offset that such a move cancelled, in the
/// first block to which it matters.
core::Result<void> take_length_up(Execution& execution);
core::Result<void> select_offset(Execution& execution); // G54 to G59.3
/// Makes a work offset active. The machine does not move.
void use_work_offset(Execution& execution, size_t index);
core::Result<void> set_distance_mode(Execution& execution); // G90 G91 G90.1 G91.1
core::Result<void> set_retract_mode(Execution& execution);  // G98 G99
core::Result<void> set_frame(Execution& execution);         // G15 G16 G50 G51 G68 G69
core::Result<void> ask_for_corner(Execution& execution);    // ,R ,C
core::Result<void> stop(Execution& execution);              // M0 M1 M2 M30 M60
core::Result<void> call(Execution& execution);              // M96 to M99, M198, G65 to G67

core::Result<void> write_offset(Execution& execution);               // G10
core::Result<void> write_tool_entry(Execution& execution, int kind); // G10 L1 L10 L11
core::Result<void> name_tool(Execution& execution);                  // M61
/// The moves before the tool is exchanged. `exchanges`: another tool is known to be in the spindle.
void move_to_tool_change(Execution& execution, bool exchanges = false);
core::Result<void> go_home(Execution& execution);          // G28 G30
core::Result<void> check_home(Execution& execution);       // G27
core::Result<void> return_from_home(Execution& execution); // G29
/// G60: a rapid past the end and back, so that the last part has always the same direction.
///
/// Source: Fanuc 30i user's manual B-63944EN, 4.2 "Single direction positioning"; Haas mill
///         operator's manual 96-8000, G60.
core::Result<void> move_one_way(Execution& execution);

core::Result<void> skip_move(Execution& execution);         // G31
core::Result<void> measure(Execution& execution);           // G35 G36 G136
core::Result<void> forbid_area(Execution& execution);       // G22
core::Result<void> store_home(Execution& execution);        // G28.1 G30.1
core::Result<void> set_local_offset(Execution& execution);  // G52
core::Result<void> set_axis_offset(Execution& execution);   // G92 to G92.3
core::Result<void> move_along_arc(Execution& execution);    // G2 G3
core::Result<void> feed_with_spindle(Execution& execution); // G33 G33.1
core::Result<void> probe(Execution& execution);             // G38.2 to G38.5
core::Result<void> call_subprogram(Execution& execution);   // M96 to M99, M198
core::Result<void> call_macro(Execution& execution);        // G65 to G67, and the calls of G66

/// The number of a tool that the program calls by name: that of the set-up's tool of this name; the
/// name itself if it is a number; else the number under which `named_tools` of the state has it. A
/// new name gets the lowest free number, with a remark.
core::ToolNumber tool_of_name(Execution& execution, std::string_view name, core::SourceSpan where);

/// The diameter in the control's table for the D word of a block, mm; 0 with a warning if it is
/// unknown.
core::Result<double> offset_diameter(Execution& execution, const CodeWord& entry);

/// G10 P R: the entry of a control that keeps one value for each offset number.
///
/// Source: Fanuc series 0 and 16 operator's manuals, "Tool compensation memory A".
core::Result<void> write_single_entry(Execution& execution);

/// G10 L10 to L13: tool offset table, with P the number and R the value. L2 P0: external work
/// offset. L3, L50, L52: ignored with a warning.
///
/// Source: Fanuc 30i user's manual B-63944EN-2, "Entering compensation values from a program", and
///         B-63944EN, 7.2.2.
core::Result<void> write_fanuc_entry(Execution& execution, int kind);
core::Result<void> write_external_offset(Execution& execution);
void skip_data(Execution& execution, const Word& kind);

} // namespace gcode
