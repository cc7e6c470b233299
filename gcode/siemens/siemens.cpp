#include "gcode/siemens/siemens.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "gcode/exec/flow.h"
#include "gcode/exec/state_digest.h"
#include "gcode/language/language.h"
#include "gcode/language/lexer.h"
#include "gcode/siemens/siemens_parser.h"

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
        FEELER_TRY(const double value, value_of_argument(flow_step_of(execution), part));
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
            writable_siemens(execution.state).follows_tool = true;
            say_so("not modelled: rotary axes are followed in program coordinates, without the "
                   "machine's moves that keep the tip in place");
            break;
        case transformation_off:
            if (siemens_of(execution.state).follows_tool)
                writable_siemens(execution.state).follows_tool = false;
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
        leave(execution.state);
        return {};
    }
    if (returns) {
        execution.state.ending = ProgramStatus::main_return;
        return {};
    }
    return stop(execution);
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
    use_siemens_words,    note_keywords,      say,
    use_siemens_tool,     turn_spindle,       set_coolant,
    dwell_in_siemens,     select_plane,       select_siemens_offset,
    change_siemens_frame, set_siemens_radius, use_siemens_edge,
    set_path_mode,        set_distance_mode,  act_in_siemens,
    set_modal_call,       move_in_siemens,    run_cycles,
    call_modal,           switch_language,    end_block,
};

} // namespace

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

/// The number of T="NAME": the name itself if it is a number, else a number assigned in order of
/// appearance.
int number_of_name(Execution& execution, const SiemensArgument& name) {
    int number = 0;
    const char* end = name.text.data() + name.text.size();
    const auto read = std::from_chars(name.text.data(), end, number);
    if (read.ec == std::errc() && read.ptr == end && number >= 0) return number;
    const auto& known = siemens_of(execution.state).tool_names;
    const auto found = std::find(known.begin(), known.end(), name.text);
    if (found != known.end()) return static_cast<int>(found - known.begin()) + 1;
    auto& names = writable_siemens(execution.state).tool_names;
    names.emplace_back(name.text);
    number = static_cast<int>(names.size());
    execution.warn(name.span,
                   fmt::format("T=\"{}\" is tool {} here: tool names are numbered in order of "
                               "appearance, as the set-up has numbers",
                               name.text, number),
                   Severity::note);
    return number;
}

/// Activates the length of the active edge along the normal of the plane.
void use_length(Execution& execution, core::SourceSpan where) {
    ModalState& modal = execution.modal();
    const int edge = siemens_of(execution.state).edge;
    const int tool = modal.tool ? value_of(*modal.tool) : 0;
    Offsets offsets = modal.offsets;
    offsets.tool = {};
    std::optional<OffsetNumber> number;
    if (edge != 0 && tool != 0) {
        number = OffsetNumber(tool);
        const auto length = length_under(*execution.state.tables, tool);
        if (!length)
            execution.warn(where,
                           fmt::format("D{}: the length of tool {} is unknown and assumed to be 0",
                                       edge, tool));
        else if (edge != 1)
            execution.warn(
                where, fmt::format(
                           "D{}: only one cutting edge of tool {} is known, and its length is used",
                           edge, tool));
        offsets.tool[axes_of(modal.plane).normal] = length.value_or(0.0);
    }
    if (offsets == modal.offsets && modal.length_number == number) return;
    change_offsets(execution, offsets);
    modal.length_number = number;
    execution.emit(UseToolLengthOffset{number, offsets.tool, offsets.follows_tip});
}

void change(Execution& execution, core::SourceSpan where, bool stops_spindle) {
    ModalState& modal = execution.modal();
    modal.tool = modal.selected_tool;
    if (stops_spindle && modal.spindle != core::SpindleDirection::stopped)
        turn_siemens_spindle(execution, 5);
    const bool empty = *modal.tool == ToolNumber(0);
    execution.emit(ChangeTool{empty ? std::nullopt : modal.tool});
    // Default MD20270: the first edge is active after a tool change.
    const Word* edge = execution.statement.word('D');
    writable_siemens(execution.state).edge = 1;
    if (!edge) use_length(execution, where);
}

core::Result<void> select(Execution& execution, int number, core::SourceSpan where) {
    execution.modal().selected_tool = ToolNumber(number);
    execution.column = where.column;
    execution.emit(SelectTool{ToolNumber(number)});
    if (siemens_of(execution.state).changes_with_t) change(execution, where, true);
    return {};
}

} // namespace

core::Result<void> use_siemens_tool(Execution& execution) {
    const SiemensArgument& name = siemens_of(execution.block).tool_name;
    if (const Word* word = execution.statement.word('T')) {
        FEELER_TRY(const int number, whole_number(*word, 0, 99999999));
        if (auto done = select(execution, number, word->span); !done) return done;
    } else if (name.kind == SiemensArgument::Kind::text) {
        if (auto done = select(execution, number_of_name(execution, name), name.span); !done)
            return done;
    }
    const CodeWord* entry = execution.statement.of(ModalGroup::tool_change);
    if (!entry) return {};
    execution.column = entry->word->span.column;
    if (!execution.modal().selected_tool)
        return core::fail(ErrorCode::missing_value,
                          "M6 has no tool to change to: no T word has been programmed yet",
                          entry->word->span);
    if (!siemens_of(execution.state).changes_with_m6)
        writable_siemens(execution.state).changes_with_m6 = true;
    if (siemens_of(execution.state).changes_with_t) return {};
    change(execution, entry->word->span, true);
    return {};
}

core::Result<void> use_siemens_edge(Execution& execution) {
    const Word* word = execution.statement.word('D');
    if (!word) return {};
    FEELER_TRY(const int edge, whole_number(*word, 0, 32000));
    execution.column = word->span.column;
    const ModalState& modal = execution.modal();
    const SiemensState& siemens = siemens_of(execution.state);
    // MD22550: on a machine without M6, T changes the tool.
    const bool with_t = edge > 0 && !siemens.changes_with_m6 && !siemens.changes_with_t
                        && modal.selected_tool && !modal.tool;
    if (with_t) {
        execution.warn(word->span,
                       "no M6 before this D: the tool is assumed to be changed by T alone, which "
                       "depends on the machine data of the control",
                       Severity::note);
        writable_siemens(execution.state).changes_with_t = true;
        change(execution, word->span, false);
    }
    writable_siemens(execution.state).edge = edge;
    use_length(execution, word->span);
    return {};
}

core::Result<void> set_siemens_radius(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::cutter_radius);
    if (!entry && execution.modal().compensation == Side::none) return {};
    // D is the cutting edge here, not an offset number.
    Statement without = execution.statement;
    without.words['D' - 'A'] = nullptr;
    Execution shared{execution.library, execution.environment, execution.dialect, execution.block,
                     without,           execution.state,       execution.result,  execution.column};
    if (auto done = set_cutter_radius(shared); !done) return done;
    if (!entry || execution.modal().compensation == Side::none) return {};
    if (siemens_of(execution.state).edge == 0)
        execution.warn(entry->word->span,
                       fmt::format("{}: D0 is active, so the control has no radius to compensate; "
                                   "the tool radius is used",
                                   written(*entry->word)));
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
    digest.add(number_of(int(siemens.changes_with_t) + 2 * int(siemens.changes_with_m6)
                         + 4 * int(siemens.feeds_in_inches) + 8 * int(siemens.follows_tool)));
    for (const std::string& name : siemens.tool_names) digest.add(name);
}

namespace {

std::shared_ptr<LanguageState> begin_siemens() { return std::make_shared<StateOf<SiemensState>>(); }

} // namespace

const LanguageFunctions siemens_language = {.parse = parse_siemens,
                                            .index = siemens_index,
                                            .execute = run_siemens,
                                            .run_flow = run_siemens_flow,
                                            .begin = begin_siemens,
                                            .changes_level = changes_levels_in_siemens,
                                            .variable = siemens_variable};

} // namespace gcode
