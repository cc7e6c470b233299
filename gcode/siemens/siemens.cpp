#include "gcode/siemens/siemens.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/math.h"
#include "core/base/rule_table.h"
#include "core/base/units.h"
#include "gcode/contour/contour.h"
#include "gcode/exec/flow.h"
#include "gcode/exec/following.h"
#include "gcode/exec/readings.h"
#include "gcode/exec/state_digest.h"
#include "gcode/language/environment.h"
#include "gcode/language/language.h"
#include "gcode/language/lexer.h"
#include "gcode/siemens/siemens_parser.h"
#include "gcode/text/source.h"

namespace gcode {
namespace {

using core::ErrorCode;
using enum SiemensAction;

using SiemensStep = core::Result<void> (*)(Execution&);

core::Result<void> say(Execution& execution) {
    const SiemensKeywordUse* use = use_of(execution, message);
    if (!use) return {};
    std::string text;
    for (const SiemensArgument& part : siemens_of(execution.block).arguments) {
        if (part.kind == SiemensArgument::Kind::text) text += part.text;
        if (part.kind != SiemensArgument::Kind::value) continue;
        FEELER_TRY(const double value, value_of_argument(flow_step_of(execution), part, true));
        text += fmt::format("{:.12g}", value);
    }
    if (text.empty()) return {}; // clears the previous message from the screen
    execution.column = use->span.column;
    execution.emit(Message{std::move(text)});
    return {};
}

core::Result<void> dwell_in_siemens(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::action);
    if (!entry || entry->code->number != g_code(4)) return {};
    const Word* seconds = execution.statement.word('F');
    const Word* turns = execution.statement.word('S');
    const Word* word = seconds ? seconds : turns;
    if (execution.statement.has_axis_word())
        return core::fail(ErrorCode::syntax,
                          "G4 must be in a block by itself: the axes in this block would not move",
                          entry->word->span);
    if (!word)
        return core::fail(ErrorCode::missing_value,
                          "G4 has no time: it needs F in seconds, or S in spindle revolutions",
                          entry->word->span);
    FEELER_TRY(const double time, dwell_time(execution, *word));
    execution.column = entry->word->span.column;
    if (seconds) {
        execution.emit(Dwell{time});
    } else if (execution.modal().speed > 0.0) {
        execution.emit(Dwell{time * 60.0 / execution.modal().speed});
    } else {
        return core::fail(
            ErrorCode::missing_value,
            fmt::format("{}: a dwell in spindle revolutions needs a spindle speed", written(*word)),
            word->span);
    }
    return {};
}

/// Marks the motions from here on as followed only as far as is known.
void doubt(Execution& execution, const SiemensKeywordUse& use, uint8_t reason, std::string_view why,
           std::string cure) {
    execution.modal().doubt |= reason;
    execution.result.warnings.push_back({Severity::warning, use.span,
                                         fmt::format("{}: {}", use.keyword->name, why),
                                         core::rule_id("undecided"), std::move(cure)});
}

core::Result<void> note_keywords(Execution& execution) {
    for (const SiemensKeywordUse& use : siemens_of(execution.block).keywords) {
        const auto say_so = [&](std::string_view why) {
            execution.warn(use.span, fmt::format("{}: {}", use.keyword->name, why));
        };
        switch (use.keyword->action) {
        case warning:
            say_so(use.keyword->text);
            break;
        case transformation:
        case transformation_off:
            if (auto done = switch_orientation(execution, use); !done) return done;
            break;
        case orient_axes:
        case orient_by_vector:
        case orient_in_machine:
        case orient_in_work:
        case other_orientation:
        case orient_along_path:
        case euler_angles:
        case rpy_angles:
        case other_angles:
        case smooth_orientation:
        case plain_orientation:
            choose_orientation(execution, use.keyword->action);
            break;
        case tool_frame:
        case tool_frame_off:
            if (auto done = use_tool_frame(execution, use); !done) return done;
            break;
        case orient_spindle:
            turn_siemens_spindle(execution, 5);
            break;
        case other_approach:
            doubt(execution, use, approach_is_in_doubt,
                  "the approach to a compensated contour is not modelled: the straight approach of "
                  "NORM is checked",
                  "Use NORM.");
            break;
        case usual_approach:
            execution.modal().doubt &= static_cast<uint8_t>(~approach_is_in_doubt);
            break;
        case bent_rapids:
            doubt(
                execution, use, rapids_are_in_doubt,
                "the axes of a rapid need not arrive together; the path that the set-up states is "
                "checked",
                "Use RTLION, or check with rapid = \"dogleg\" under [machine] as well.");
            break;
        case straight_rapids:
            execution.modal().doubt &= static_cast<uint8_t>(~rapids_are_in_doubt);
            break;
        case diameters:
            execution.modal().diameter_mode = true;
            break;
        case radii:
            execution.modal().diameter_mode = false;
            break;
        default:
            break;
        }
    }
    return {};
}

/// G25 and G26 with axes set working-area limits, with S spindle limits.
core::Result<void> note_limits(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::action);
    if (!entry || (entry->code->number != g_code(25) && entry->code->number != g_code(26)))
        return {};
    execution.warn(entry->word->span,
                   fmt::format("{}: working-area limits set by the program are not checked",
                               written(*entry->word)),
                   Severity::note);
    return {};
}

core::Result<void> act_in_siemens(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::action);
    if (!entry) return {};
    switch (entry->code->number) {
    case g_code(74):
    case g_code(75):
        return go_to_fixed_position(execution);
    case g_code(110):
    case g_code(111):
    case g_code(112):
        return set_pole(execution);
    default:
        return note_limits(execution);
    }
}

/// MCALL alone, with a cycle, or with a program.
core::Result<void> set_modal_call(Execution& execution) {
    if (!siemens_of(execution.block).is_modal_call) return {};
    SiemensState& siemens = writable_siemens(execution.state);
    siemens.modal_cycle.reset();
    siemens.modal_call.reset();
    if (siemens_of(execution.block).name.empty()) return {};
    FEELER_TRY(Frame frame, called_frame(flow_step_of(execution)));
    frame.modal_macro = 1;
    writable_siemens(execution.state).modal_call = std::move(frame);
    return {};
}

core::Result<void> run_cycles(Execution& execution) {
    for (const SiemensKeywordUse& use : siemens_of(execution.block).keywords) {
        if (use.keyword->action < swivel) continue;
        if (auto done = run_siemens_cycle(execution, use); !done) return done;
    }
    return {};
}

bool has_moved(const Execution& execution) {
    return std::any_of(execution.result.commands.begin(), execution.result.commands.end(),
                       [](const CanonicalCommand& command) {
                           return std::holds_alternative<StraightTraverse>(command)
                                  || std::holds_alternative<StraightFeed>(command)
                                  || std::holds_alternative<ArcFeed>(command);
                       });
}

/// Runs the modal call of MCALL after each block with a move.
core::Result<void> call_modal(Execution& execution) {
    const SiemensState& siemens = siemens_of(execution.state);
    if (!siemens.modal_cycle && !siemens.modal_call) return {};
    if (siemens_of(execution.block).is_modal_call || execution.result.is_cycle
        || !has_moved(execution))
        return {};
    if (siemens.modal_cycle) return drill_here(execution, SiemensDrilling(*siemens.modal_cycle));
    const auto& frames = execution.state.frames;
    if (std::any_of(frames.begin(), frames.end(),
                    [](const Frame& frame) { return frame.modal_macro > 0; }))
        return {};
    Frame frame = *siemens.modal_call;
    if (frame.restore) save_siemens_modes(execution.state, frame);
    frame.called_from = {execution.state.next.source, execution.block.line};
    return enter(execution.state, execution.environment, std::move(frame),
                 {.line = execution.block.line, .column = 1});
}

/// M2, M30 and M17: a called program returns to its caller.
core::Result<void> end_block(Execution& execution) {
    const CodeWord* stopping = execution.statement.of(ModalGroup::stopping);
    const bool ends =
        stopping && stopping->code->number != m_code(0) && stopping->code->number != m_code(1);
    const bool returns = execution.statement.of(ModalGroup::subprogram) != nullptr;
    const bool inside = execution.state.frames.size() > 1;
    if (inside && (ends || returns)) {
        return_to_caller(execution.state, execution.result, execution.column);
        return {};
    }
    if (returns) {
        end_main_program(execution.state, execution.result, execution.column, "M17");
        return {};
    }
    return stop(execution);
}

/// ADIS, ADISPOS or CTOL.
core::Result<void> take_tolerance(Execution& execution, const SiemensKeywordUse& use) {
    FEELER_TRY(const double value, value_of_argument(flow_step_of(execution), use.value));
    SiemensState& siemens = writable_siemens(execution.state);
    double& taken = use.keyword->name == "ADIS"      ? siemens.feed_rounding
                    : use.keyword->name == "ADISPOS" ? siemens.rapid_rounding
                                                     : siemens.contour_tolerance;
    taken = std::max(0.0, to_mm(value, execution.modal().unit));
    return {};
}

/// CYCLE832(TOLERANCE, ...): a tolerance of the contour with G645 or G642 and a compressor, as the
/// machine builder has set it up. Without a tolerance, the machine's settings are restored.
core::Result<void> take_smoothing(Execution& execution) {
    const auto& arguments = siemens_of(execution.block).arguments;
    double value = 0.0;
    if (!arguments.empty() && arguments[0].kind == SiemensArgument::Kind::value) {
        FEELER_TRY(value, value_of_argument(flow_step_of(execution), arguments[0]));
    }
    SiemensState& siemens = writable_siemens(execution.state);
    siemens.contour_tolerance = std::max(0.0, to_mm(value, execution.modal().unit));
    siemens.compresses = siemens.contour_tolerance > 0.0;
    siemens.path_code = siemens.compresses ? 645 : 0;
    return {};
}

/// Notes a code of this block by which the control leaves the path by a distance that neither the
/// program nor the set-up states.
void note_unstated_tolerance(Execution& execution) {
    const SiemensState& siemens = siemens_of(execution.state);
    if (siemens.contour_tolerance > 0.0) return;
    const auto say_so = [&](core::SourceSpan where, std::string_view code) {
        execution.warn(where,
                       fmt::format("{}: the program states no tolerance (CTOL or CYCLE832), so how "
                                   "far the control leaves the path is set at the machine; "
                                   "`corner_tolerance` of the machine is assumed",
                                   code),
                       Severity::note);
    };
    const CodeWord* entry = execution.statement.of(ModalGroup::path_control);
    if (entry && siemens.path_code > 641) say_so(entry->word->span, written(*entry->word));
    const SiemensKeywordUse* use = use_of(execution, compressor_on);
    if (use) say_so(use->span, use->keyword->name);
}

/// G60, G64 and G641 to G645 with their tolerances.
core::Result<void> set_siemens_path(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::path_control);
    bool changes = entry != nullptr;
    if (entry) {
        writable_siemens(execution.state).path_code = static_cast<int>(entry->word->value);
        execution.column = entry->word->span.column;
    }
    for (const SiemensKeywordUse& use : siemens_of(execution.block).keywords) {
        const SiemensAction action = use.keyword->action;
        if (action != tolerance && action != smoothing && action != compressor_on
            && action != compressor_off)
            continue;
        if (!changes) execution.column = use.span.column;
        changes = true;
        if (action == tolerance) {
            if (auto taken = take_tolerance(execution, use); !taken) return taken;
        } else if (action == smoothing) {
            if (auto taken = take_smoothing(execution); !taken) return taken;
        } else {
            writable_siemens(execution.state).compresses = action == compressor_on;
        }
    }
    if (!changes) return {};
    note_unstated_tolerance(execution);
    set_corner_tolerances(siemens_of(execution.state), execution.modal());
    execution.emit(path_mode_of(execution.modal()));
    return {};
}

/// G290 and G291.
core::Result<void> switch_language(Execution& execution) {
    for (const CodeWord& entry : execution.statement.codes()) {
        if (entry.code->number != g_code(291)) continue;
        if (execution.modal().offsets.has_frame)
            return core::fail(ErrorCode::unsupported,
                              "G291 while TRANS, ROT, SCALE or MIRROR is active is not supported "
                              "yet: cancel them with TRANS first",
                              entry.word->span);
        execution.state.is_iso_mode = true;
    }
    return {};
}

constexpr SiemensStep siemens_steps[] = {
    use_siemens_words,    note_keywords,        say,
    use_siemens_tool,     turn_spindle,         set_coolant,
    dwell_in_siemens,     select_siemens_plane, select_siemens_offset,
    change_siemens_frame, set_siemens_radius,   use_siemens_edge,
    set_siemens_path,     set_distance_mode,    act_in_siemens,
    set_modal_call,       move_in_siemens,      run_cycles,
    call_modal,           switch_language,      end_block,
};

} // namespace

/// Source: SINUMERIK 840D sl Basic Functions, B1. G641 rounds within ADIS and ADISPOS of the
/// corner; where only one motion is a rapid, the smaller applies. G642 to G645 keep a tolerance of
/// the path, or these distances, as machine data MD20480 says: both are taken. Without a value, as
/// with G64.
void set_corner_tolerances(const SiemensState& siemens, ModalState& modal) {
    modal.path_tolerance = modal.naive_tolerance = 0.0;
    modal.corner_tolerances = {};
    modal.path = siemens.path_code == 60 ? PathMode::exact_stop : PathMode::continuous;
    if (siemens.path_code < 641) return;
    CornerTolerances& corners = modal.corner_tolerances;
    if (siemens.feed_rounding > 0.0) corners.distance = siemens.feed_rounding;
    if (siemens.rapid_rounding > 0.0) corners.rapid_distance = siemens.rapid_rounding;
    corners.between_kinds = true;
    if (siemens.path_code == 641 || siemens.contour_tolerance == 0.0) return;
    modal.path_tolerance = siemens.contour_tolerance;
    corners.rapid_tolerance = siemens.contour_tolerance;
    if (siemens.compresses) modal.naive_tolerance = siemens.contour_tolerance;
}

const SiemensKeywordUse* use_of(const Execution& execution, SiemensAction action) {
    for (const SiemensKeywordUse& use : siemens_of(execution.block).keywords)
        if (use.keyword->action == action) return &use;
    return nullptr;
}

FlowStep flow_step_of(Execution& execution) {
    return {execution.library, execution.environment, execution.dialect,
            execution.block,   execution.state,       execution.result};
}

bool changes_levels_in_siemens(const Statement& statement, const InterpreterState& state) {
    return (state.frames.size() > 1 && statement.of(ModalGroup::stopping))
           || siemens_of(state).modal_call.has_value();
}

void turn_siemens_spindle(Execution& execution, int code) {
    using core::SpindleDirection;
    ModalState& modal = execution.modal();
    modal.spindle = code == 3   ? SpindleDirection::clockwise
                    : code == 4 ? SpindleDirection::counterclockwise
                                : SpindleDirection::stopped;
    const bool stopped = modal.spindle == SpindleDirection::stopped;
    execution.emit(Spindle{modal.spindle, stopped ? 0.0 : modal.speed});
}

core::Result<void> run_siemens(Execution& execution, const ModalState&) {
    for (const SiemensStep step : siemens_steps)
        if (auto done = step(execution); !done) return done;
    return {};
}

std::optional<Value> siemens_variable(const InterpreterState& state, std::string_view name) {
    const ModalState& modal = state.modal;
    if (name == "$p_toolno" || name == "$p_tool")
        return Value(name == "$p_tool" ? siemens_of(state).edge
                     : modal.tool      ? value_of(*modal.tool)
                                       : 0);
    if (name == "$p_f") return Value(from_mm(modal.feed.value_or(0.0), modal.unit));
    if (name == "$p_s" || name == "$p_s[1]") return Value(modal.speed);
    // $AA_IM is in machine coordinates; $AA_IW and $P_EP are in program coordinates.
    const bool machine = name.starts_with("$aa_im[") || name.starts_with("$aa_mm[");
    const bool program =
        name.starts_with("$aa_iw[") || name.starts_with("$p_ep[") || name.starts_with("$aa_mw[");
    const size_t bracket = name.find('[');
    if (!(machine || program) || name.size() != bracket + 3) return std::nullopt;
    const char letter = upper(name[bracket + 1]);
    const size_t axis = axis_letters.find(letter);
    if (axis == std::string_view::npos) return std::nullopt;
    const Position position =
        machine ? machine_from_program(modal.offsets, modal.position) : modal.position;
    if (!position[axis]) return std::nullopt;
    return Value(is_rotary(axis) ? *position[axis] : from_mm(*position[axis], modal.unit));
}

namespace {

using core::OffsetNumber;
using core::ToolNumber;

/// The axis along which the tool length acts. With diameters the tool is that of a lathe.
size_t length_axis(const Execution& execution) {
    constexpr size_t z = 2;
    const ModalState& modal = execution.modal();
    const bool follows = modal.diameter_mode || siemens_of(execution.state).length_follows_plane;
    return follows ? axes_of(modal.plane).normal : z;
}

/// Activates the length of the active edge.
void use_length(Execution& execution, core::SourceSpan where) {
    ModalState& modal = execution.modal();
    const int edge = siemens_of(execution.state).edge;
    const int tool = modal.tool ? value_of(*modal.tool) : 0;
    Offsets offsets = modal.offsets;
    offsets.tool = {};
    modal.doubt &= static_cast<uint8_t>(~edge_is_in_doubt);
    std::optional<OffsetNumber> number;
    if (edge != 0 && tool != 0) {
        number = OffsetNumber(tool);
        const auto length = length_under(*execution.state.tables, tool);
        if (!length)
            execution.warn(where,
                           fmt::format("D{}: the length of tool {} is unknown and assumed to be 0",
                                       edge, tool));
        if (edge > 1) {
            modal.doubt |= edge_is_in_doubt;
            execution.result.warnings.push_back(
                {Severity::warning, where,
                 fmt::format("D{}: only the first cutting edge of tool {} is known; its length and "
                             "radius are used, and motions with them are not proven clear",
                             edge, tool),
                 core::rule_id("undecided"),
                 "Program D1, or check with a set-up in which the tool has the length of this "
                 "edge."});
        }
        offsets.tool[length_axis(execution)] = length.value_or(0.0);
    }
    if (offsets == modal.offsets && modal.length_number == number) return;
    change_siemens_offsets(execution, offsets, modal.length_travel);
    modal.length_number = number;
    execution.emit(UseToolLengthOffset{number, offsets.tool, offsets.follows_tip,
                                       lacks_length(*execution.state.tables, number)});
}

void change(Execution& execution, core::SourceSpan where) {
    ModalState& modal = execution.modal();
    modal.tool = modal.selected_tool;
    if (modal.spindle != core::SpindleDirection::stopped) turn_siemens_spindle(execution, 5);
    move_to_tool_change(execution);
    const bool empty = *modal.tool == ToolNumber(0);
    execution.emit(ChangeTool{empty ? std::nullopt : modal.tool});
    // MD20270: the first edge is active after a tool change, or none.
    const Word* edge = execution.statement.word('D');
    SiemensState& siemens = writable_siemens(execution.state);
    siemens.edge = 1;
    siemens.edge_is_assumed = !edge && !empty;
    if (!edge) use_length(execution, where);
}

/// Whether the block moves one of these axes, given as a bit for each.
bool moves_along(const Execution& execution, unsigned axes) {
    const Statement& statement = execution.statement;
    const bool mixes = mixes_axes(execution.modal().offsets) || statement.polar_radius
                       || statement.polar_angle || execution.result.is_cycle;
    for (size_t axis = 0; axis < 3; ++axis)
        if (statement.word(axis_letters[axis]) && (mixes || (axes >> axis & 1u) != 0)) return true;
    return mixes && (statement.polar_radius || statement.polar_angle || execution.result.is_cycle);
}

bool has_length(const Execution& execution) {
    const AxisValues& tool = execution.modal().offsets.tool;
    return tool[0] != 0.0 || tool[1] != 0.0 || tool[2] != 0.0;
}

/// Finds out whether the edge that a tool change without D selects is active.
void settle_edge(Execution& execution) {
    if (!siemens_of(execution.state).edge_is_assumed) return;
    writable_siemens(execution.state).edge_is_assumed = false;
    if (answer_to(execution.state, execution.environment, ControlQuestion::change_selects_edge,
                  execution.block.line))
        return;
    writable_siemens(execution.state).edge = 0;
    use_length(execution, {.line = execution.block.line, .column = 1});
}

/// Finds out along which axis the length acts in G18 and G19.
///
/// Source: SINUMERIK Function Manual W1, 11/2006, "Activating the tool compensations": a change of
///         the length must be travelled in a straight move. Where the first move in the plane is an
///         arc, the length cannot have changed.
void settle_length_axis(Execution& execution, bool straight) {
    const ModalState& modal = execution.modal();
    const SiemensState& siemens = siemens_of(execution.state);
    const size_t normal = axes_of(modal.plane).normal;
    if (normal == 2 || siemens.length_axis_is_settled || modal.diameter_mode
        || !has_length(execution) || !moves_along(execution, 1u << normal | 1u << 2))
        return;
    writable_siemens(execution.state).length_axis_is_settled = true;
    if (!straight
        || answer_to(execution.state, execution.environment, ControlQuestion::length_keeps_axis,
                     execution.block.line))
        return;
    writable_siemens(execution.state).length_follows_plane = true;
    use_length(execution, {.line = execution.block.line, .column = 1});
}

/// Whether a line has M6 or M1=6 outside comments and texts.
bool has_tool_change(std::string_view line) {
    const auto digits_from = [&](size_t& at) {
        const size_t begin = at;
        while (at < line.size() && is_digit(line[at])) ++at;
        size_t first = begin;
        while (first + 1 < at && line[first] == '0') ++first;
        return line.substr(first, at - first);
    };
    bool quoted = false;
    for (size_t at = 0; at < line.size(); ++at) {
        if (line[at] == '"') quoted = !quoted;
        if (quoted) continue;
        if (line[at] == ';') return false;
        if (upper(line[at]) != 'M'
            || (at > 0 && is_name_part(line[at - 1]) && !is_digit(line[at - 1])))
            continue;
        size_t end = at + 1;
        while (end < line.size() && line[end] == ' ') ++end;
        std::string_view number = digits_from(end);
        if (end < line.size() && line[end] == '=') {
            while (++end < line.size() && line[end] == ' ') {
            }
            number = digits_from(end);
        }
        if (number == "6" && (end >= line.size() || !is_name_part(line[end]))) return true;
    }
    return false;
}

/// Whether one of these lines has M6.
bool has_tool_change(const Program& program, size_t from, size_t end) {
    for (size_t line = from; line < end; ++line) {
        const auto text = program.find_line(line);
        if (!text || !*text) return false;
        if (has_tool_change(**text)) return true;
    }
    return false;
}

/// Whether the program that is running, or the main program, has M6.
bool has_tool_change(const Execution& execution) {
    const uint32_t source = execution.state.next.source;
    const Program& program = execution.library.program(source);
    const size_t here = execution.block.line;
    return has_tool_change(program, here, SIZE_MAX) || has_tool_change(program, 1, here)
           || (source != 0 && has_tool_change(execution.library.program(0), 1, SIZE_MAX));
}

/// Finds out at the first T which word changes the tool. A program with M6 is for a machine that
/// needs it, unless the set-up states otherwise.
///
/// Source: SINUMERIK 840D sl, Programming Manual Fundamentals, "Tool change with M6" and "Tool
///         change without M6"; MD22550 TOOL_CHANGE_MODE.
void settle_tool_change(Execution& execution, core::SourceSpan where) {
    if (siemens_of(execution.state).tool_change != SiemensToolChange::not_known_yet) return;
    constexpr ControlQuestion question = ControlQuestion::tool_changes_with_t;
    const ControlSettings& control = execution.environment.control;
    const bool is_stated = control.number(question).has_value();
    const bool with_t =
        (is_stated || !has_tool_change(execution))
        && answer_to(execution.state, execution.environment, question, execution.block.line);
    writable_siemens(execution.state).tool_change =
        with_t ? SiemensToolChange::with_t : SiemensToolChange::with_m6;
    if (with_t && !is_stated && !control.reports_premises)
        execution.warn(where,
                       "the program has no M6: the tool is assumed to be changed by T alone, which "
                       "depends on the machine data of the control (MD22550)",
                       Severity::note);
}

core::Result<void> select(Execution& execution, int number, core::SourceSpan where) {
    settle_tool_change(execution, where);
    execution.modal().selected_tool = ToolNumber(number);
    execution.column = where.column;
    execution.emit(SelectTool{ToolNumber(number)});
    if (siemens_of(execution.state).tool_change == SiemensToolChange::with_t)
        change(execution, where);
    return {};
}

} // namespace

void change_siemens_offsets(Execution& execution, const Offsets& offsets, AxisValues& travel) {
    const Position before = execution.modal().position;
    change_offsets(execution, offsets);
    const Position& after = execution.modal().position;
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (before[axis] && after[axis]) travel[axis] += *before[axis] - *after[axis];
}

void forget_travel(Execution& execution, size_t axis) {
    ModalState& modal = execution.modal();
    modal.offset_travel[axis] = modal.length_travel[axis] = 0.0;
}

void settle_length(Execution& execution, bool straight) {
    const size_t along = length_axis(execution);
    if (has_length(execution) && moves_along(execution, 1u << along)) settle_edge(execution);
    settle_length_axis(execution, straight);
}

core::Result<void> select_siemens_plane(Execution& execution) {
    if (!execution.statement.of(ModalGroup::plane)) return {};
    if (auto done = select_plane(execution); !done) return done;
    if (siemens_of(execution.state).length_follows_plane && has_length(execution))
        use_length(execution, {.line = execution.block.line, .column = 1});
    return {};
}

core::Result<void> use_siemens_tool(Execution& execution) {
    const SiemensArgument& name = siemens_of(execution.block).tool_name;
    if (const Word* word = execution.statement.word('T')) {
        FEELER_TRY(const int number, whole_number(*word, 0, 99999999));
        if (auto done = select(execution, number, word->span); !done) return done;
    } else if (name.kind == SiemensArgument::Kind::text) {
        const ToolNumber number = tool_of_name(execution, name.text, name.span);
        if (auto done = select(execution, value_of(number), name.span); !done) return done;
    }
    const CodeWord* entry = execution.statement.of(ModalGroup::tool_change);
    if (!entry) return {};
    execution.column = entry->word->span.column;
    if (!execution.modal().selected_tool)
        return core::fail(ErrorCode::missing_value,
                          "M6 has no tool to change to: no T word has been programmed yet",
                          entry->word->span);
    if (siemens_of(execution.state).tool_change == SiemensToolChange::with_t) return {};
    change(execution, entry->word->span);
    return {};
}

core::Result<void> use_siemens_edge(Execution& execution) {
    const Word* word = execution.statement.word('D');
    if (!word) return {};
    FEELER_TRY(const int edge, whole_number(*word, 0, 32000));
    execution.column = word->span.column;
    writable_siemens(execution.state).edge = edge;
    writable_siemens(execution.state).edge_is_assumed = false;
    use_length(execution, word->span);
    return {};
}

namespace {

/// G450, G451 and DISC.
core::Result<void> note_corner_style(Execution& execution) {
    for (const CodeWord& entry : execution.statement.codes())
        if (entry.code->number == g_code(450))
            writable_siemens(execution.state).corner_code =
                static_cast<int>(core::round_to_integer(entry.word->value));
    const SiemensKeywordUse* use = use_of(execution, corner_shape);
    if (!use) return {};
    FEELER_TRY(const double shape, value_of_argument(flow_step_of(execution), use->value));
    writable_siemens(execution.state).corner_shape = shape;
    if (shape != 0.0)
        execution.result.warnings.push_back(
            {Severity::warning, use->span,
             fmt::format("DISC={:g}: the shape of this path around corners is not modelled: with "
                         "G450 an arc is followed, and motions with cutter radius compensation are "
                         "not proven clear",
                         shape),
             core::rule_id("undecided"), "Program DISC=0, or G451."});
    return {};
}

/// How the tool passes the outside corners of the contour that is active after this block.
///
/// Source: SINUMERIK 840D sl, Programming Manual Fundamentals, "Compensation at the outside corners
///         (G450, G451, DISC)": an arc about the corner, or the intersection of the offset paths;
///         a corner sharper than MD20210 has the arc in both cases.
void use_corner_style(Execution& execution) {
    ModalState& modal = execution.modal();
    modal.doubt &= static_cast<uint8_t>(~corner_is_in_doubt);
    if (modal.compensation == Side::none) return;
    InterpreterState& state = execution.state;
    const uint32_t line = execution.block.line;
    if (siemens_of(state).corner_code == 0)
        writable_siemens(state).corner_code =
            answer_to(state, execution.environment, ControlQuestion::corners_are_met, line) ? 451
                                                                                            : 450;
    const bool met = siemens_of(state).corner_code == 451;
    if (!met && siemens_of(state).corner_shape != 0.0) modal.doubt |= corner_is_in_doubt;
    const double limit_deg =
        met ? number_for(state, execution.environment, ControlQuestion::corner_limit, line) : 0.0;
    const OutsideCorners corners{met ? OutsideCorner::met : OutsideCorner::rounded,
                                 limit_deg * core::radians_per_degree};
    const Contour& now = *state.contour;
    if (now.outside == corners && (!now.path || now.path->outside == corners)) return;
    Contour& contour = state.contour.write();
    contour.outside = corners;
    if (contour.path) contour.path->outside = corners;
}

} // namespace

core::Result<void> set_siemens_radius(Execution& execution) {
    if (auto noted = note_corner_style(execution); !noted) return noted;
    const CodeWord* entry = execution.statement.of(ModalGroup::cutter_radius);
    if (!entry) execution.modal().doubt &= static_cast<uint8_t>(~corner_is_in_doubt);
    if (!entry && execution.modal().compensation == Side::none) return {};
    // D is the cutting edge here, not an offset number.
    Statement without = execution.statement;
    without.words['D' - 'A'] = nullptr;
    Execution shared{execution.library, execution.environment, execution.dialect, execution.block,
                     without,           execution.state,       execution.result,  execution.column};
    if (auto done = set_cutter_radius(shared); !done) return done;
    use_corner_style(execution);
    if (entry && execution.modal().compensation != Side::none) settle_edge(execution);
    if (!entry || execution.modal().compensation == Side::none) return {};
    if (siemens_of(execution.state).edge == 0) {
        execution.modal().compensation_radius = 0.0;
        execution.warn(entry->word->span,
                       fmt::format("{}: D0 is active, so the control compensates no radius: the "
                                   "centre of the tool follows the contour",
                                   written(*entry->word)));
    }
    const core::Mat3& linear = siemens_of(execution.state).frame.linear;
    const auto first = static_cast<int>(axes_of(execution.modal().plane).first);
    const double stretch = glm::length(linear[first]);
    execution.modal().compensation_radius /= stretch;
    return {};
}

namespace {

void add(Digest& digest, const SiemensDrilling& cycle) {
    digest.add(number_of(cycle.number));
    for (const double value : {cycle.retract,
                               cycle.reference,
                               cycle.safety,
                               cycle.bottom,
                               cycle.dwell_below,
                               cycle.first_depth,
                               cycle.degression,
                               cycle.dwell_above,
                               cycle.feed_factor,
                               double(cycle.clears_chips),
                               cycle.least_peck,
                               cycle.break_back,
                               cycle.dwell_final,
                               cycle.near,
                               cycle.pitch,
                               cycle.speed_in,
                               cycle.speed_out,
                               double(cycle.direction_after),
                               cycle.feed_in,
                               cycle.feed_out,
                               double(cycle.direction)})
        digest.add(value);
    add_all(digest, cycle.aside);
}

} // namespace

void add(Digest& digest, const SiemensState& siemens) {
    add_all(digest, siemens.pole);
    digest.add(siemens.radius);
    digest.add(siemens.angle_deg);
    digest.add(uint64_t{siemens.modal_cycle.has_value()});
    if (siemens.modal_cycle) add(digest, *siemens.modal_cycle);
    digest.add(uint64_t{siemens.modal_call.has_value()});
    if (siemens.modal_call) add(digest, *siemens.modal_call);
    digest.add(number_of(siemens.edge));
    digest.add(number_of(int(siemens.tool_change) + 4 * int(siemens.feeds_in_inches)
                         + 8 * int(siemens.compresses) + 16 * int(siemens.edge_is_assumed)
                         + 32 * int(siemens.length_follows_plane)
                         + 64 * int(siemens.length_axis_is_settled)));
    digest.add(uint64_t{siemens.swivels});
    digest.add(siemens.swivel_data);
    digest.add(uint64_t(8 * siemens.smooths_turning + 4 * siemens.turns_by_axes
                        + 2 * siemens.turns_in_machine + siemens.turns_otherwise
                        + 16 * siemens.turns_along_path + 32 * siemens.turns_to_path
                        + 64 * siemens.turns_with_tool + 128 * int(siemens.angles)));
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row) digest.add(siemens.swivel.linear[column][row]);
    for (int axis = 0; axis < 3; ++axis) digest.add(siemens.swivel.shift[axis]);
    digest.add(number_of(siemens.path_code));
    digest.add(number_of(siemens.corner_code));
    for (const double value : {siemens.feed_rounding, siemens.rapid_rounding,
                               siemens.contour_tolerance, siemens.corner_shape})
        digest.add(value);
}

namespace {

std::shared_ptr<LanguageState> begin_siemens(const Environment& environment) {
    auto state = std::make_shared<StateOf<SiemensState>>();
    state->value.feeds_in_inches = environment.units_at_start == LengthUnit::inch; // as G700
    return state;
}

} // namespace

const LanguageFunctions siemens_language = {.parse = parse_siemens,
                                            .index = siemens_index,
                                            .execute = run_siemens,
                                            .run_flow = run_siemens_flow,
                                            .begin = begin_siemens,
                                            .changes_level = changes_levels_in_siemens,
                                            .variable = siemens_variable};

} // namespace gcode
