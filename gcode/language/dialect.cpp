#include "gcode/language/dialect.h"

#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/base/units.h"

namespace gcode {
namespace {

// LinuxCNC: interp_internal.hh, CENTER_ARC_RADIUS_TOLERANCE and SPIRAL_RELATIVE_TOLERANCE.
constexpr ArcTolerance linuxcnc_arc = {.absolute_mm = 2 * 0.01 * std::numbers::sqrt2,
                                       .absolute_inch = 2 * 0.001 * std::numbers::sqrt2,
                                       .relative = 0.001,
                                       .limit = 100.0,
                                       .warned_mm = 0.0};

// Fanuc: the tolerance is a parameter (3410); post-processors round to a micron.
constexpr ArcTolerance fanuc_arc = {.absolute_mm = 0.005,
                                    .absolute_inch = 0.0005,
                                    .relative = 0.0,
                                    .limit = 1.0,
                                    .warned_mm = 0.05};

// Grbl, gcode.c: an error above 0.5 mm, or above both 0.005 mm and a thousandth of the radius.
constexpr ArcTolerance grbl_arc = {.absolute_mm = 0.005,
                                   .absolute_inch = 0.005 / core::mm_per_inch,
                                   .relative = 0.001,
                                   .limit = 100.0,
                                   .warned_mm = 0.0};

constexpr Dialect linuxcnc_dialect = {.id = DialectId::linuxcnc,
                                      .name = "linuxcnc",
                                      .codes = DialectId::linuxcnc,
                                      .supported = true,
                                      .unit = LengthUnit::mm,
                                      .unit_is_machines = true,
                                      .retract = RetractMode::r_level,
                                      .arc = linuxcnc_arc,
                                      .peck_clearance = 0.254,
                                      .dwell_without_point_is_milliseconds = false,
                                      .dwell_takes_x_and_u = false,
                                      .bare_length_offset_is_tool = true,
                                      .cycles_are_rs274 = true,
                                      .begins_with_g0 = false,
                                      .motion_codes_move = true,
                                      .cycles_are_motions = true,
                                      .axis_words_serve_one_code = true,
                                      .unused_words_are_errors = true,
                                      .machine_move_is_rapid = false,
                                      .machine_move_bends = false,
                                      .machine_move_needs_g90 = true,
                                      .machine_move_needs_motion = true,
                                      .length_needs_g43 = true,
                                      .lone_h_is_length_offset = false,
                                      .p_selects_more_offsets = false,
                                      .local_offset_is_axis_offset = true,
                                      .offset_writes_follow_g91 = false,
                                      .work_offsets_turn = true,
                                      .feed_before_units = true,
                                      .g98_cycle_starts_high = true,
                                      .cycle_stays_above_r = true,
                                      .has_extended_offsets = false,
                                      .has_older_tool_entries = false,
                                      .g87_is_back_boring = false,
                                      .cycle_levels_follow_g91 = true,
                                      .boring_feeds_to_r = false,
                                      .pecks_may_shrink = false,
                                      .peck_sign_is_ignored = false,
                                      .scale_without_point_is_thousandths = false,
                                      .cycles_run_with_axes_or_r = false,
                                      .repeats_with_k = false,
                                      .tape_mark_ends_program = true,
                                      .runs_on_after_end = false,
                                      .repeated_codes_are_errors = true,
                                      .last_of_group_counts = false,
                                      .has_axis_commands = false,
                                      .clears_offset_after_move = false,
                                      .language = Language::words,
                                      .iso_mode = {},
                                      .expressions = ExpressionSyntax::rs274,
                                      .arithmetic = {.equality = 0.0001},
                                      .tool_entries_by_axes = true,
                                      .arc_after_contour_is_error = true,
                                      .contour_breaks_are_errors = true,
                                      .contour_codes = ContourCodes::rs274,
                                      .contour_style = ContourStyle::rs274,
                                      .radius_number_stays = false,
                                      .has_active_comments = true,
                                      .has_o_words = true,
                                      .has_fanuc_flow = false,
                                      .deletes_within_blocks = false,
                                      .block_delete = BlockDelete::from_one,
                                      .semicolon_ends_block = false,
                                      .comments_nest = true,
                                      .has_parameters = true,
                                      .refused_letters = "",
                                      .longest_line = 0,
                                      .has_corner_words = false,
                                      .has_polar_words = true,
                                      .offset_words_may_repeat = false,
                                      .brackets_optional_in_assignments = false,
                                      .unset_is_vacant = false,
                                      .feed_mode_clears_feed = true,
                                      .bare_h0_is_tool = true,
                                      .home_cancels_length = false,
                                      .repeats_in_program_number = false,
                                      .calls_stand_alone = true,
                                      .decimal_points_matter = false,
                                      .third_offset_is_ignored = false,
                                      .assumed_feed = 0.0,
                                      .system_parameters = SystemParameters::rs274,
                                      .parameter_letter = "#",
                                      .has_parameter_zero = false,
                                      .names_are_declared = false,
                                      .assigns_in_order = false,
                                      .text_end_returns = false,
                                      .radius_word = "R",
                                      .first_alarm = 0,
                                      .local_count = 30,
                                      .deepest_calls = 10,
                                      .same_offset_stays = true,
                                      .offset_writes_miss_axis_offset = true,
                                      .surface_speed_needs_s = true,
                                      .change_raises_z = false,
                                      .radius_arc_may_vanish = false,
                                      .stores_homes = true,
                                      .has_variables_file = true};

// Fanuc 30i user's manual B-63944EN, "Custom macro"; angles as with parameter 6004 = 0.
constexpr Arithmetic fanuc_arithmetic = {.bitwise_logic = true,
                                         .fix_is_to_zero = true,
                                         .angles_have_no_sign = true,
                                         .rounds_lengths_to_steps = true};

constexpr Dialect fanuc_dialect = {.id = DialectId::fanuc,
                                   .name = "fanuc",
                                   .codes = DialectId::fanuc,
                                   .supported = true,
                                   .unit = LengthUnit::mm,
                                   .unit_is_machines = false,
                                   .retract = RetractMode::initial_level,
                                   .arc = fanuc_arc,
                                   .peck_clearance = 1.0,
                                   .dwell_without_point_is_milliseconds = true,
                                   .dwell_takes_x_and_u = true,
                                   .bare_length_offset_is_tool = false,
                                   .cycles_are_rs274 = false,
                                   .begins_with_g0 = true,
                                   .motion_codes_move = false,
                                   .cycles_are_motions = false,
                                   .axis_words_serve_one_code = false,
                                   .unused_words_are_errors = false,
                                   .machine_move_is_rapid = true,
                                   .machine_move_bends = true,
                                   .machine_move_needs_g90 = true,
                                   .machine_move_needs_motion = false,
                                   .length_needs_g43 = true,
                                   .lone_h_is_length_offset = true,
                                   .p_selects_more_offsets = true,
                                   .local_offset_is_axis_offset = false,
                                   .offset_writes_follow_g91 = true,
                                   .work_offsets_turn = false,
                                   .feed_before_units = false,
                                   .g98_cycle_starts_high = false,
                                   .cycle_stays_above_r = false,
                                   .has_extended_offsets = true,
                                   .has_older_tool_entries = true,
                                   .g87_is_back_boring = true,
                                   .cycle_levels_follow_g91 = false,
                                   .boring_feeds_to_r = true,
                                   .pecks_may_shrink = false,
                                   .peck_sign_is_ignored = true,
                                   .scale_without_point_is_thousandths = true,
                                   .cycles_run_with_axes_or_r = true,
                                   .repeats_with_k = true,
                                   .tape_mark_ends_program = false,
                                   .runs_on_after_end = false,
                                   .repeated_codes_are_errors = false,
                                   .last_of_group_counts = true,
                                   .has_axis_commands = false,
                                   .clears_offset_after_move = false,
                                   .language = Language::words,
                                   .iso_mode = {},
                                   .expressions = ExpressionSyntax::fanuc,
                                   .arithmetic = fanuc_arithmetic,
                                   .tool_entries_by_axes = false,
                                   .arc_after_contour_is_error = true,
                                   .contour_breaks_are_errors = false,
                                   .contour_codes = ContourCodes::fanuc,
                                   .contour_style = ContourStyle::fanuc,
                                   .radius_number_stays = true,
                                   .has_active_comments = false,
                                   .has_o_words = false,
                                   .has_fanuc_flow = true,
                                   .deletes_within_blocks = true,
                                   .block_delete = BlockDelete::from_one,
                                   .semicolon_ends_block = true,
                                   .comments_nest = true,
                                   .has_parameters = true,
                                   .refused_letters = "",
                                   .longest_line = 0,
                                   .has_corner_words = true,
                                   .has_polar_words = false,
                                   .offset_words_may_repeat = true,
                                   .brackets_optional_in_assignments = true,
                                   .unset_is_vacant = true,
                                   .feed_mode_clears_feed = false,
                                   .bare_h0_is_tool = false,
                                   .home_cancels_length = false,
                                   .repeats_in_program_number = true,
                                   .calls_stand_alone = false,
                                   .decimal_points_matter = true,
                                   .third_offset_is_ignored = false,
                                   .assumed_feed = 0.0,
                                   .system_parameters = SystemParameters::fanuc,
                                   .parameter_letter = "#",
                                   .has_parameter_zero = false,
                                   .names_are_declared = false,
                                   .assigns_in_order = false,
                                   .text_end_returns = false,
                                   .radius_word = "R",
                                   .first_alarm = 3000,
                                   .local_count = 33,
                                   .deepest_calls = 15,
                                   .same_offset_stays = false,
                                   .offset_writes_miss_axis_offset = false,
                                   .surface_speed_needs_s = false,
                                   .change_raises_z = false,
                                   .radius_arc_may_vanish = true,
                                   .stores_homes = false,
                                   .has_variables_file = false};

constexpr Dialect haas_dialect = [] {
    Dialect entry = fanuc_dialect;
    entry.id = DialectId::haas;
    entry.name = "haas";
    entry.codes = DialectId::haas;
    entry.contour_style = ContourStyle::rs274;
    entry.arithmetic.angles_have_no_sign = false;
    entry.machine_move_is_rapid = false;
    entry.machine_move_bends = false;
    entry.machine_move_needs_g90 = false;
    entry.has_older_tool_entries = false;
    entry.last_of_group_counts = false;
    entry.pecks_may_shrink = true;
    entry.g87_is_back_boring = false;
    entry.scale_without_point_is_thousandths = false;
    entry.cycles_run_with_axes_or_r = false;
    entry.repeats_with_k = false;
    entry.change_raises_z = true;
    entry.radius_arc_may_vanish = false;
    entry.repeats_in_program_number = false;
    entry.system_parameters = SystemParameters::haas;
    // Haas mill operator's manual 96-8000, G28.
    entry.home_cancels_length = true;
    entry.first_alarm = 1000;
    return entry;
}();

// Grbl 0.8: defaults.h, DEFAULT_FEEDRATE.
constexpr double grbl_feed = 250.0;

constexpr Dialect grbl_dialect = [] {
    Dialect entry = linuxcnc_dialect;
    entry.id = DialectId::grbl;
    entry.name = "grbl";
    entry.codes = DialectId::grbl;
    entry.assumed_feed = grbl_feed;
    entry.third_offset_is_ignored = true; // gcode.c: clears I, J and K of an arc without R
    entry.length_needs_g43 = false;
    entry.unit_is_machines = false;
    entry.arc = grbl_arc;
    entry.local_offset_is_axis_offset = false;
    entry.work_offsets_turn = false;
    entry.feed_before_units = false;
    entry.tool_entries_by_axes = false;
    entry.has_active_comments = false;
    entry.begins_with_g0 = true;
    entry.motion_codes_move = false;
    entry.has_o_words = false;
    entry.feed_mode_clears_feed = false;
    entry.has_polar_words = false;
    entry.has_variables_file = false;
    // gcode.c, step 21; protocol.c passes % on to the parser, which refuses it
    entry.runs_on_after_end = true;
    entry.tape_mark_ends_program = false;
    entry.has_axis_commands = true;
    entry.clears_offset_after_move = true; // targets are computed in step 3, G92.1 acts in step 4
    entry.machine_move_needs_g90 = false;
    // protocol.c, protocol_main_loop
    entry.block_delete = BlockDelete::none;
    entry.comments_nest = false;
    entry.longest_line = 79;
    // E is refused, too, with a hint of what it may mean
    entry.has_parameters = false;
    entry.refused_letters = "ABCDHOQUVW";
    return entry;
}();

// iTNC manual: the input tolerance for the end point of an arc around CC is 0.016 mm.
constexpr ArcTolerance heidenhain_arc = {.absolute_mm = 0.016,
                                         .absolute_inch = 0.016 / core::mm_per_inch,
                                         .relative = 0.0,
                                         .limit = 1.0,
                                         .warned_mm = 0.05};

constexpr Dialect heidenhain = [] {
    Dialect entry = fanuc_dialect;
    entry.id = DialectId::heidenhain;
    entry.name = "heidenhain";
    entry.codes = DialectId::heidenhain;
    entry.contour_style = ContourStyle::rs274;
    entry.radius_number_stays = false;
    entry.has_older_tool_entries = false;
    entry.last_of_group_counts = false;
    entry.length_needs_g43 = false;
    entry.arc = heidenhain_arc;
    entry.machine_move_is_rapid = false;
    entry.machine_move_bends = false;
    entry.machine_move_needs_g90 = false;
    entry.dwell_without_point_is_milliseconds = false;
    entry.decimal_points_matter = false;
    entry.language = Language::klartext;
    entry.block_delete = BlockDelete::one_switch;
    entry.semicolon_ends_block = false;
    entry.parameter_letter = "Q";
    entry.expressions = ExpressionSyntax::klartext;
    entry.arithmetic = {};
    entry.has_fanuc_flow = false;
    entry.has_corner_words = false;
    entry.unset_is_vacant = false;
    entry.local_count = 0;
    entry.deepest_calls = 30;
    return entry;
}();

// SINUMERIK 840D, default MD21000 and MD21010: 0.01 mm, or a thousandth of the radius.
constexpr ArcTolerance siemens_arc = {.absolute_mm = 0.01,
                                      .absolute_inch = 0.01 / core::mm_per_inch,
                                      .relative = 0.001,
                                      .limit = 1e12,
                                      .warned_mm = 0.0};

constexpr Dialect siemens_dialect = [] {
    Dialect entry = fanuc_dialect;
    entry.id = DialectId::siemens;
    entry.name = "siemens";
    entry.codes = DialectId::siemens;
    entry.arc = siemens_arc;
    entry.has_older_tool_entries = false;
    entry.last_of_group_counts = false;
    entry.machine_move_is_rapid = false;
    entry.machine_move_bends = false;
    entry.machine_move_needs_g90 = false;
    entry.lone_h_is_length_offset = false;
    entry.p_selects_more_offsets = false;
    entry.has_extended_offsets = false;
    entry.dwell_without_point_is_milliseconds = false;
    entry.begins_with_g0 = false;
    entry.language = Language::siemens;
    entry.block_delete = BlockDelete::from_zero;
    entry.semicolon_ends_block = false;
    entry.iso_mode = DialectId::siemens_iso;
    entry.expressions = ExpressionSyntax::siemens;
    entry.arithmetic = {};
    entry.arc_after_contour_is_error = false;
    entry.has_fanuc_flow = false;
    entry.has_corner_words = false;
    entry.unset_is_vacant = false;
    entry.decimal_points_matter = false;
    entry.system_parameters = SystemParameters::siemens;
    entry.parameter_letter = "R";
    entry.has_parameter_zero = true;
    entry.names_are_declared = true;
    entry.assigns_in_order = true;
    entry.text_end_returns = true;
    entry.radius_word = "CR=";
    entry.radius_number_stays = false;
    entry.local_count = 0;
    entry.deepest_calls = 16;
    return entry;
}();

// ISO dialect M after G291: the language of Fanuc on a Siemens control.
constexpr Dialect siemens_iso = [] {
    Dialect entry = fanuc_dialect;
    entry.id = DialectId::siemens_iso;
    entry.name = "siemens-iso";
    entry.codes = DialectId::siemens_iso;
    entry.machine_move_bends = false;
    entry.radius_arc_may_vanish = false;
    entry.semicolon_ends_block = false;
    entry.arc = siemens_arc;
    return entry;
}();

constexpr std::array dialects = {linuxcnc_dialect, fanuc_dialect, haas_dialect, grbl_dialect,
                                 siemens_dialect,  heidenhain,    siemens_iso};

constexpr auto names_of_dialects = [] {
    std::array<std::string_view, dialects.size()> found;
    for (size_t i = 0; i < found.size(); ++i) found[i] = dialects[i].name;
    return found;
}();

} // namespace

const Dialect& dialect(DialectId id) { return dialects[static_cast<size_t>(id)]; }

core::Result<DialectId> supported(DialectId id) {
    if (dialect(id).supported) return id;
    return core::fail(
        core::ErrorCode::unsupported,
        fmt::format("the dialect {} is not supported by this version", dialect(id).name));
}

core::Result<DialectId> supported(const Recognition& recognition) {
    if (recognition.refusal.empty()) return supported(recognition.dialect);
    return core::fail(core::ErrorCode::unsupported, recognition.refusal);
}

std::span<const Dialect> all_dialects() { return dialects; }

std::span<const std::string_view> dialect_names() { return names_of_dialects; }

std::optional<DialectId> dialect_named(std::string_view name) {
    for (const Dialect& entry : dialects)
        if (entry.name == name) return entry.id;
    return std::nullopt;
}

} // namespace gcode
