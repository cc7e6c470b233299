#include "gcode/exec/interpreter.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/base/rule_table.h"
#include "core/motion/machine.h"
#include "gcode/contour/contour.h"
#include "gcode/contour/spline.h"
#include "gcode/exec/assignments.h"
#include "gcode/exec/execution.h"
#include "gcode/exec/fanuc_parameters.h"
#include "gcode/exec/flow.h"
#include "gcode/exec/following.h"
#include "gcode/exec/frame_codes.h"
#include "gcode/exec/linuxcnc_parameters.h"
#include "gcode/exec/loop_detector.h"
#include "gcode/exec/modes.h"
#include "gcode/exec/probing.h"
#include "gcode/exec/program_parameters.h"
#include "gcode/exec/quick_move.h"
#include "gcode/exec/readings.h"
#include "gcode/exec/startup.h"
#include "gcode/exec/statement.h"
#include "gcode/exec/subprogram.h"
#include "gcode/language/codes.h"
#include "gcode/language/control.h"
#include "gcode/language/language.h"
#include "gcode/text/program_text.h"
#include "gcode/text/source.h"

namespace gcode {

/// The parts of the state that a block may change, saved until the block has succeeded.
struct BeforeBlock {
    ModalState modal;
    ProgramLine next;
    uint32_t next_block;
    bool tape_open, said_unit, said_home;
    ProgramStatus ending;
    bool after_end, said_time;
    DecimalPoints points;
    RuleState rules;
    Shared<Tables> tables;
    Shared<SplineState> spline;
    SharedLanguageState language;
    Shared<UnknownValues> unknown;
    bool is_iso_mode;
    // Only saved for blocks that call or return.
    bool has_calls = false;
    std::vector<Frame> frames;
    std::vector<ModalMacro> modal_macros;
};

void keep(const InterpreterState& state, BeforeBlock& before);
void restore(InterpreterState& state, const BeforeBlock& before);

/// Call levels are large, so they are saved separately and only for the few blocks that change
/// them.
void keep_calls(const InterpreterState& state, BeforeBlock& before);
void restore_calls(InterpreterState& state, const BeforeBlock& before); // if they were kept

/// Warns once if a program writes some lengths with a decimal point and some without: controls that
/// count least increments read the latter as a thousandth.
void note_points(const Block& block, InterpreterState& state, BlockCommands& result);

/// Whether a block has a length without a decimal point that is not 0.
bool lacks_point(const Block& block);

/// Whether the control reads the lengths of a block without a decimal point as least increments.
bool counts_steps(const Block& block, InterpreterState& state, const Environment& environment);

/// Scales lengths and angles without a decimal point to least increments: 0.001 mm, 0.0001 inch,
/// 0.001 degrees, or `scale` times as much. F, P and counts are not changed.
void count_smallest_steps(Block& block, const ModalState& modal, DialectId dialect, double scale);

/// The least increment of the control, as a multiple of 0.001 mm.
double increment_scale(InterpreterState& state, const Environment& environment, uint32_t line);

/// Settles which modes the control starts with, as far as a block relies on them.
void ask_for_first_modes(Execution& execution);

/// G500: the work offset has no effect.
void leave_work_offset(ModalState& modal);

/// The modes that the control is stated to start with.
void begin_modes(ModalState& modal, const Environment& environment);

namespace {

using core::ErrorCode;

static_assert(rule_of_remarks == core::rule_id("program"));

bool has_rotary_word(const Block& block) {
    return std::any_of(block.words.begin(), block.words.end(), [](const Word& word) {
        return word.letter == 'A' || word.letter == 'B' || word.letter == 'C';
    });
}

/// Whether a flow statement may change the call level.
bool changes_level(FlowKind kind) {
    return kind == FlowKind::call || kind == FlowKind::return_value || kind == FlowKind::end_sub
           || kind == FlowKind::call_program || is_siemens_statement(kind);
}

/// The switch that skips a line without parsing: its words may be for another machine. Empty: none.
std::optional<int> switch_before(std::string_view line, BlockDelete switches) {
    const size_t first = line.find_first_not_of(" \t");
    if (first == std::string_view::npos || line[first] != '/') return std::nullopt;
    const int plain = number_of_plain_slash(switches);
    const char next = first + 1 < line.size() ? line[first + 1] : ' ';
    const bool is_number = next >= '0' && next <= '9' && next - '0' >= plain;
    return is_number ? next - '0' : plain;
}

} // namespace

struct Interpreter::Scratch {
    ProgramLibrary& library;
    const Environment& environment;
    const Dialect& dialect;
    const LanguageFunctions& language = functions_of(dialect.language);
    // Whether absolute positions of rotary axes need more than adding and comparing.
    const bool may_roll_over = environment.machine && environment.machine->has_rotary()
                               && find_parameter(ControlQuestion::rotary_rolls_over, dialect.id);
    Block block{};
    Statement statement{};
    BlockCommands result{};
    std::string line_text{};
    std::vector<uint32_t> sources_with_known_lines{}; // see check_returns
    BeforeBlock before{};
    std::vector<AssignmentUndo> undos{};
    std::vector<Value> values{};
    std::optional<Word> remapped{}; // a code of the block whose subprogram is not followed
    std::unique_ptr<Environment> iso_environment{}; // Siemens, after G291
    std::unique_ptr<Scratch> iso{};

    Scratch& speaking(const InterpreterState& state);
    core::Result<bool> read_line(InterpreterState& state);
    core::Result<bool> end_of_text(InterpreterState& state);
    bool begins_another_program(const InterpreterState& state) const;
    void remember_words(InterpreterState& state) const;
    core::Result<void> run_block(InterpreterState& state);
    core::Result<void> become_call(const InterpreterState& state);
    void take_back(InterpreterState& state);
    void begin_result(const InterpreterState& state, ProgramLine here);
    core::Result<bool> try_next(InterpreterState& state);
    core::Result<bool> read_next(InterpreterState& state);
    bool try_quick_move(InterpreterState& state);
    bool asks_for_stop(const InterpreterState& state) const {
        return state.next_block % 1024 == 0 && environment.limits.is_stopped;
    }
    bool has_known_lines(uint32_t source) const {
        return std::find(sources_with_known_lines.begin(), sources_with_known_lines.end(), source)
               != sources_with_known_lines.end();
    }
    core::SourceSpan span_in_file(core::SourceSpan where) const;
    void position_in_lines();
};

/// Whether a program is known to have the lines that the control sees. Grbl ends a line at CR.
/// LinuxCNC takes it for a blank and reads on in the same line. Of other controls it is not known,
/// unless all lines of the file end so.
core::Result<void> check_returns(const Program& program, DialectId dialect) {
    if (dialect == DialectId::grbl || program.windows) return {};
    if (dialect != DialectId::linuxcnc && program.text.find('\n') == std::string::npos) return {};
    const auto at = lone_return(program.text);
    if (!at) return {};
    const auto after =
        std::upper_bound(program.line_starts.begin(), program.line_starts.end(), *at);
    core::Error error{core::ErrorCode::syntax, {}, {}, program.file};
    error.where.line = static_cast<uint32_t>(after - program.line_starts.begin());
    error.where.column = static_cast<uint32_t>(*at - *(after - 1) + 1);
    error.message = fmt::format(
        "the line ends at a carriage return without a line feed, and {}; save the program with the "
        "same end of line everywhere",
        dialect == DialectId::linuxcnc ? "LinuxCNC takes the next line for a part of it"
                                       : "controls may take the next line for a part of it");
    return tl::unexpected(std::move(error));
}

/// Notes whether LinuxCNC holds back the last straight feed, to join it with the next. Commands
/// that it carries out at once do not make it.
void note_held_feed(ModalState& modal, const BlockCommands& block) {
    for (const CanonicalCommand& command : block.commands) {
        if (std::holds_alternative<StraightFeed>(command))
            modal.holds_feed = true;
        else if (!std::holds_alternative<NameTool>(command)
                 && !std::holds_alternative<SelectPlane>(command)
                 && !std::holds_alternative<SetPathMode>(command)
                 && !std::holds_alternative<EnableOverride>(command)
                 && !std::holds_alternative<UseSpindleMode>(command)
                 && !std::holds_alternative<Message>(command))
            modal.holds_feed = false;
    }
}

/// The scratch data for the active language. Siemens controls have two languages.
Interpreter::Scratch& Interpreter::Scratch::speaking(const InterpreterState& state) {
    if (!state.is_iso_mode) return *this;
    if (!iso) {
        iso_environment = std::make_unique<Environment>(environment);
        iso_environment->dialect = dialect.iso_mode.value();
        iso.reset(new Scratch{library, *iso_environment, gcode::dialect(iso_environment->dialect)});
    }
    return *iso;
}

/// Reads the next line with something to execute; false at the end of the text.
core::Result<bool> Interpreter::Scratch::read_line(InterpreterState& state) {
    while (true) {
        if (const auto& repeated = state.frames.back().repeated;
            !repeated.empty() && state.next.line == repeated.back().last + 1)
            state.next.line = repeated.back().statement;
        const Program& program = library.program(state.next.source);
        if (!has_known_lines(state.next.source)) {
            if (auto known = check_returns(program, dialect.id); !known)
                return tl::unexpected(std::move(known).error());
            sources_with_known_lines.push_back(state.next.source);
        }
        FEELER_TRY(const auto found, program.find_line(state.next.line));
        if (!found) return false;
        const uint32_t number = state.next.line++;
        std::string_view text = language.block_at ? language.block_at(program, number) : *found;
        if (language.lines_of) state.next.line = number + language.lines_of(text);
        if (program.windows) text = line_text.assign(text); // flow statements read other lines
        const auto is_skipped = [&](int at) {
            return deletes_blocks(state, environment, at, number);
        };
        if (const auto at = switch_before(text, dialect.block_delete); at && is_skipped(*at))
            continue;
        if (auto parsed = parse_line(text, number, dialect, block); !parsed)
            return tl::unexpected(std::move(parsed).error());
        const bool inside = state.frames.size() > 1;
        if (block.tape_mark && inside && !dialect.has_o_words) return false;
        if (block.tape_mark && state.next.source == 0 && !dialect.runs_on_after_end
            && (state.tape_open || state.next_block > 0)) {
            state.ending = ProgramStatus::tape_mark;
            return false;
        }
        if (begins_another_program(state)) return false;
        if (state.next.source == 0) state.tape_open |= block.tape_mark;
        if (block.words_before_slash && is_skipped(number_of_plain_slash(dialect.block_delete)))
            block.words.erase(block.words.begin()
                                  + static_cast<std::ptrdiff_t>(*block.words_before_slash),
                              block.words.end());
        if (block.is_empty() || (block.block_delete && is_skipped(*block.block_delete))) continue;
        return true;
    }
}

/// Where O numbers begin separate programs, a program ends where the next begins.
bool Interpreter::Scratch::begins_another_program(const InterpreterState& state) const {
    const bool numbered = !block.words.empty() && block.words.front().letter == 'O';
    return numbered && dialect.has_fanuc_flow && (state.frames.size() > 1 || state.next_block > 0);
}

/// Stores the words of the last block, which macros can read, and advances the timers.
void Interpreter::Scratch::remember_words(InterpreterState& state) const {
    if (!remembers_words(dialect.system_parameters)) return;
    advance_timers(state);
    for (const Word& word : block.words)
        if (const size_t number = argument_number(word.letter)) state.said[number] = word.value;
}

/// Handles the end of a text: ends the run, or returns from a subprogram where the control does so.
/// Otherwise an error in a subprogram. Returns whether there is more to read.
core::Result<bool> Interpreter::Scratch::end_of_text(InterpreterState& state) {
    if (state.ending == ProgramStatus::running && state.frames.size() > 1
        && dialect.text_end_returns) {
        keep_calls(state, before);
        leave(state);
        return true;
    }
    if (state.ending == ProgramStatus::running && state.frames.size() > 1)
        return core::fail(
            ErrorCode::syntax,
            fmt::format("subprogram {} ends here without {}: the control stops with an alarm",
                        state.frames.back().name, dialect.has_o_words ? "endsub or M99" : "M99"),
            {.line = state.next.line - 1});
    if (state.ending == ProgramStatus::running)
        state.ending = state.after_end ? ProgramStatus::program_end : ProgramStatus::text_end;
    return false;
}

void Interpreter::Scratch::begin_result(const InterpreterState& state, ProgramLine here) {
    result.block = core::BlockIndex(state.next_block);
    result.line = block.line;
    result.text = block.text;
    result.own_text.reset();
    result.file = here.source == 0 ? std::string_view() : library.program(here.source).file;
    result.calls.clear();
    for (size_t level = 1; level < state.frames.size(); ++level)
        result.calls.push_back(state.frames[level].called_from.line);
    result.is_cycle = result.goes_home = result.in_machine = false;
    result.path = core::PathCertainty::known;
    result.commands.clear();
    result.columns.clear();
    result.settled.clear();
    result.warnings.clear();
}

/// Restores the state after a block that failed. Parameters are undone one by one: a copy of them
/// in `before` would share them, and the first change in each block would copy them all.
void Interpreter::Scratch::take_back(InterpreterState& state) {
    restore_calls(state, before);
    ProgramParameters parameters(state, environment);
    take_back_assignments(undos, parameters);
    undos.clear();
    if (state.parameters->has_changes()) state.parameters.write().take_back_changes();
    restore(state, before);
}

/// A line that is only a code which LinuxCNC's ini file remaps, such as M428: a call of the
/// subprogram that runs in its place. Elsewhere, the moves of that subprogram are not followed.
core::Result<void> Interpreter::Scratch::become_call(const InterpreterState& state) {
    remapped.reset();
    if (block.flow.kind != FlowKind::none) return {};
    for (const Word& word : block.words) {
        if (word.letter != 'M' && word.letter != 'G') continue;
        const auto remap = environment.remaps.find(written(word));
        if (remap == environment.remaps.end()) continue;
        // Within its own subprogram, the code is that of LinuxCNC.
        const auto runs = [&](const Frame& frame) { return frame.name == remap->second; };
        if (std::any_of(state.frames.begin(), state.frames.end(), runs)) continue;
        FEELER_TRY(const auto file, library.find({remap->second + ".ngc", remap->second + ".NGC"}));
        if (block.words.size() > 1 || !file) {
            remapped = word;
            return {};
        }
        const core::SourceSpan span = word.span;
        block.words.clear();
        block.flow = {.kind = FlowKind::call,
                      .span = span,
                      .label_name = static_cast<uint32_t>(block.pool.names.size()),
                      .has_label = true};
        block.pool.names.push_back(remap->second);
        return {};
    }
    return {};
}

core::Result<void> Interpreter::Scratch::run_block(InterpreterState& state) {
    if (!environment.remaps.empty())
        if (auto done = become_call(state); !done) return done;
    ProgramParameters parameters(state, environment);
    const bool is_plain = block.flow.kind == FlowKind::none && block.pool.instructions.empty()
                          && block.assignments.empty();
    undos.clear();
    if (!is_plain) {
        if (block.flow.kind == FlowKind::if_then) {
            FEELER_TRY(const bool holds, condition_holds(state, block, parameters, dialect));
            if (!holds) return {};
        }
        const bool inch = state.modal.unit == LengthUnit::inch;
        const Assigning assigning{block, dialect, parameters, undos, values, result, inch};
        if (auto done = evaluate_block(assigning); !done) return done;
        for (const AssignmentUndo& set : undos)
            note_written(state, set.is_named ? key_of(set.name) : key_of(set.number));
        if (!block.assignments.empty()) announce_offsets(before.modal.offsets, state.modal, result);
        if (remembers_words(dialect.system_parameters)) note_clock(block, state, result);
        if (changes_level(block.flow.kind)) keep_calls(state, before);
        if (block.flow.kind != FlowKind::none && block.flow.kind != FlowKind::if_then)
            return run_flow({library, environment, dialect, block, state, result});
    }
    if (dialect.decimal_points_matter) {
        if (counts_steps(block, state, environment))
            count_smallest_steps(block, state.modal, dialect.id,
                                 increment_scale(state, environment, block.line));
        else
            note_points(block, state, result);
    }
    if (auto checked = look_up(block, dialect, environment, statement, blocks_are_arguments(state));
        !checked)
        return checked;
    if (!block.pool.instructions.empty()
        && (statement.of(ModalGroup::subprogram) || statement.of(ModalGroup::macro)))
        note_computed_target(state);
    if (statement.of(ModalGroup::subprogram) || statement.of(ModalGroup::macro)
        || !state.modal_macros.empty()
        || (language.changes_level && language.changes_level(statement, state)))
        keep_calls(state, before);
    Execution execution{library, environment, dialect, block, statement, state, result};
    ask_for_first_modes(execution);
    result.in_machine = in_machine_coordinates(execution);
    if (auto done = language.execute(execution, before.modal); !done) return done;
    if (auto done = check_dynamic_offset(execution, before.modal); !done) return done;
    if (auto done = check_plane_is_complete(execution, before.modal); !done) return done;
    mark_uncertain_motions(execution, before.modal);
    if (remapped) lose_remapped(execution, *remapped);
    return {};
}

core::Result<bool> Interpreter::Scratch::try_next(InterpreterState& state) {
    if (!dialect.supported)
        return core::fail(ErrorCode::unsupported,
                          fmt::format("the dialect {} is not supported yet", dialect.name));
    FEELER_TRY(bool found, read_line(state));
    const bool returns = !found;
    while (!found) {
        FEELER_TRY(const bool goes_on, end_of_text(state));
        if (!goes_on) return false;
        FEELER_TRY(found, read_line(state));
    }
    const ProgramLine here{state.next.source, block.line};
    begin_result(state, here);
    if (returns) announce_modes(result, 1, before.modal, state.modal);
    const bool names_axis =
        std::any_of(block.words.begin(), block.words.end(),
                    [](const Word& word) { return word.letter >= 'X' && word.letter <= 'Z'; });
    if (names_axis && std::exchange(state.after_end, false))
        result.warnings.push_back(
            {Severity::warning,
             {.line = block.line, .column = 1},
             "the program goes on after its end: Grbl runs this block and the "
             "next ones, too, after G1, G17, G90, G94, G54, M5 and M9; some "
             "senders stop"});
    if (state.next_block >= environment.limits.blocks)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("the program was stopped after {} blocks; if it really is "
                                      "that long, raise the limit with --max-blocks",
                                      environment.limits.blocks),
                          {.line = block.line, .column = 1});
    if (asks_for_stop(state) && environment.limits.is_stopped())
        return core::fail(ErrorCode::io, "the program was stopped", {.line = block.line});
    if (auto done = run_block(state); !done) return tl::unexpected(std::move(done).error());
    ++state.next_block;
    if (dialect.id == DialectId::linuxcnc) note_held_feed(state.modal, result);
    if (std::any_of(result.commands.begin(), result.commands.end(), is_motion)) note_motion(state);
    if (auto checked = detect_endless_loop(state, here, dialect); !checked)
        return tl::unexpected(std::move(checked).error());
    return true;
}

/// try_next. After a probing move that may have ended anywhere on its way, the block is also run
/// from the other end of that way, to see which axes it positions.
core::Result<bool> Interpreter::Scratch::read_next(InterpreterState& state) {
    if (!is_stopped_somewhere(state.modal)) return try_next(state);
    const InterpreterState here = state;
    InterpreterState elsewhere = here;
    start_elsewhere(elsewhere.modal);
    const auto found_there = try_next(elsewhere);
    const bool runs_there = found_there && *found_there;
    const BlockCommands there = result;
    undos.clear();
    auto found = try_next(state);
    if (!found || !*found) return found;
    if (runs_there && settle_positions(here.modal, state, result, elsewhere, there)) return found;
    state = here;
    forget_uncertain_axes(state.modal);
    undos.clear();
    return try_next(state);
}

/// Executes a line that is only a straight move; otherwise returns false and changes nothing. It
/// cannot fail, so nothing is saved.
bool Interpreter::Scratch::try_quick_move(InterpreterState& state) {
    if (!has_known_lines(state.next.source)) return false;
    if (!language.read_plain || environment.counts_smallest_steps || state.points.counts_steps
        || !environment.wrapped_axes.empty() || state.next_block >= environment.limits.blocks
        || asks_for_stop(state) || !moves_quickly(state))
        return false;
    const auto found = library.program(state.next.source).find_line(state.next.line);
    if (!found || !*found) return false;
    block.clear();
    block.line = state.next.line;
    block.text = **found;
    if (!language.read_plain(block.text, block.line, dialect, block)) return false;
    if (may_roll_over && has_rotary_word(block)) return false;
    if (lacks_point(block) && is_open(state, environment, ControlQuestion::point_is_implied))
        return false;
    begin_result(state, {state.next.source, block.line});
    if (!run_quick_move(block, state, result)) return false;
    if (dialect.decimal_points_matter) note_points(block, state, result);
    ++state.next.line;
    ++state.next_block;
    if (dialect.id == DialectId::linuxcnc) note_held_feed(state.modal, result);
    note_motion(state);
    remember_words(state);
    return true;
}

/// Position in the file of a position in the block, which may have several lines.
core::SourceSpan Interpreter::Scratch::span_in_file(core::SourceSpan where) const {
    const bool several = language.position_in_file && where.line == block.line;
    return several ? language.position_in_file(block.text, where) : where;
}

void Interpreter::Scratch::position_in_lines() {
    for (Warning& warning : result.warnings) warning.where = span_in_file(warning.where);
}
namespace {

/// Gives a block that waits for later ones its own copy of its text.
void keep_text(BlockCommands& result) {
    result.own_text = std::make_shared<const std::string>(result.text);
    result.text = *result.own_text;
}

} // namespace

Interpreter::Interpreter(ProgramLibrary& library, const Environment& environment)
    : scratch_(new Scratch{library, environment, gcode::dialect(environment.dialect)}) {}

Interpreter::~Interpreter() = default;

core::Result<const BlockCommands*> Interpreter::next(InterpreterState& state) {
    while (true) {
        Scratch& scratch = scratch_->speaking(state);
        if (!state.contour->ready.empty()) {
            Contour& contour = state.contour.write();
            scratch.result = std::move(contour.ready.front());
            contour.ready.pop_front();
            return &scratch.result;
        }
        if (state.contour->failure) return tl::unexpected(*state.contour->failure);
        if (state.ending != ProgramStatus::running) return nullptr;
        if (scratch.try_quick_move(state)) return &scratch.result;
        keep(state, scratch.before);
        if (state.parameters->has_changes()) state.parameters.write().begin_changes();
        scratch.undos.clear();
        const uint32_t source = state.next.source;
        auto found = scratch.read_next(state);
        if (found)
            scratch.position_in_lines();
        else
            found.error().where = scratch.span_in_file(found.error().where);
        const bool is_block = found && *found;
        const bool straight_out =
            state.contour->is_idle() && state.modal.compensation == Side::none;
        if (is_block && straight_out) {
            scratch.remember_words(state);
            return &scratch.result;
        }
        core::Result<void> taken;
        if (is_block && scratch.library.program(source).windows) keep_text(scratch.result);
        if (is_block)
            taken = take_block(state.contour.write(), scratch.result, scratch.before.modal,
                               state.modal);
        else if (found)
            taken = end_contour(state.contour.write());
        if (is_block && taken) scratch.remember_words(state);
        if (found && taken) continue;
        core::Error error = found ? std::move(taken).error() : std::move(found).error();
        scratch.take_back(state);
        error.where = scratch.span_in_file(error.where);
        if (error.file.empty()) error.file = scratch.library.program(source).file;
        if (state.contour->is_idle()) return tl::unexpected(std::move(error));
        // Earlier blocks are complete except for moves that waited for this one.
        Contour& contour = state.contour.write();
        give_up(contour);
        contour.failure = std::move(error);
    }
}

InterpreterState::InterpreterState() = default;

bool has_pending_blocks(const InterpreterState& state) { return !state.contour->is_idle(); }

InterpreterState initial_state(const Environment& environment) {
    InterpreterState state;
    ModalState& modal = state.modal;
    const Dialect& rules = dialect(environment.dialect);
    if (const auto begin = functions_of(rules.language).begin)
        state.language = SharedLanguageState(begin(environment));
    modal.unit = environment.units_at_start.value_or(
        rules.unit_is_machines ? environment.machine_unit : rules.unit);
    modal.unit_said = environment.units_at_start.has_value();
    modal.retract = dialect(environment.dialect).retract;
    begin_modes(modal, environment);
    Tables& tables = state.tables.write();
    for (size_t i = 0; i < plain_offset_count; ++i)
        tables.work[i].origin = environment.work_offsets[i];
    for (const auto& [index, origin] : environment.extended_offsets)
        writable_work_offset(tables, index).origin = origin;
    tables.lengths = environment.length_offsets;
    tables.tool_lengths = environment.tool_lengths;
    tables.tool_diameters = environment.tool_diameters;
    load_parameters(state, environment);
    modal.offsets.work = tables.work[0];
    if (environment.control.answer(ControlQuestion::starts_without_work) == true)
        leave_work_offset(modal);
    const auto is_there = [](const core::MachineAxis& axis) { return axis.present; };
    if (const core::Machine* machine = environment.machine.get();
        machine && std::any_of(machine->axes.begin() + 3, machine->axes.end(), is_there))
        modal.offsets.machine = machine;
    restore_offsets(state, environment);
    begin_kinematics(modal, environment);
    Position start = environment.start;
    // Axes beyond X, Y and Z without a given position are at zero, or absent.
    for (size_t axis = 3; axis < axis_count; ++axis)
        if (!start[axis]) start[axis] = 0.0;
    modal.position = program_from_machine(modal.offsets, start);
    for (size_t axis = 0; axis < axis_count; ++axis) {
        if (environment.home) modal.home[axis] = (*environment.home)[axis];
        if (environment.second_home) modal.second_home[axis] = (*environment.second_home)[axis];
    }
    // An error was reported when the code was read.
    (void)run_startup_code(state, environment);
    return state;
}

std::optional<Warning> end_warning(const Environment& environment, const InterpreterState& state) {
    const core::SourceSpan where{.line = static_cast<uint32_t>(state.next.line - 1)};
    if (state.ending == ProgramStatus::main_return && state.passes.size() < most_passes)
        return Warning{Severity::warning, where,
                       fmt::format("M99 in a main program starts it again; {} passes were checked, "
                                   "and further ones do the same as the last",
                                   state.passes.size() + 1)};
    if (state.ending == ProgramStatus::main_return)
        return Warning{Severity::warning, where,
                       fmt::format("M99 in a main program starts it again; {} passes were checked, "
                                   "and each began in another state",
                                   most_passes),
                       core::rule_id("undecided"),
                       "End the program with M30, or set its variables at its beginning."};
    const bool proper_mark = state.ending == ProgramStatus::tape_mark
                             && dialect(environment.dialect).tape_mark_ends_program;
    if (state.ending == ProgramStatus::text_end
        || (state.ending == ProgramStatus::tape_mark && !proper_mark))
        return Warning{Severity::warning, where, "the program has no M2 or M30 at its end"};
    return std::nullopt;
}

void keep_calls(const InterpreterState& state, BeforeBlock& before) {
    if (before.has_calls) return; // a text has ended in this block, before it calls or returns
    before.has_calls = true;
    before.frames = state.frames;
    before.modal_macros = state.modal_macros;
}

void keep(const InterpreterState& state, BeforeBlock& before) {
    before.modal = state.modal;
    before.next = state.next;
    before.next_block = state.next_block;
    before.tape_open = state.tape_open;
    before.said_unit = state.said_unit;
    before.said_home = state.said_home;
    before.ending = state.ending;
    before.after_end = state.after_end;
    before.said_time = state.said_time;
    before.points = state.points;
    before.rules = state.rules;
    before.tables = state.tables;
    before.spline = state.spline;
    before.language = state.language;
    before.unknown = state.readings->unknown;
    before.is_iso_mode = state.is_iso_mode;
    before.has_calls = false;
}

void restore(InterpreterState& state, const BeforeBlock& before) {
    state.modal = before.modal;
    state.next = before.next;
    state.next_block = before.next_block;
    state.tape_open = before.tape_open;
    state.said_unit = before.said_unit;
    state.said_home = before.said_home;
    state.ending = before.ending;
    state.after_end = before.after_end;
    state.said_time = before.said_time;
    state.points = before.points;
    state.rules = before.rules;
    state.tables = before.tables;
    state.spline = before.spline;
    state.language = before.language;
    if (!(state.readings->unknown == before.unknown))
        state.readings.write().unknown = before.unknown;
    state.is_iso_mode = before.is_iso_mode;
}

void restore_calls(InterpreterState& state, const BeforeBlock& before) {
    if (!before.has_calls) return;
    state.frames = before.frames;
    state.modal_macros = before.modal_macros;
}

namespace {

template <typename Wanted>
bool has_code(const Block& block, char letter, Wanted wanted) {
    return std::any_of(block.words.begin(), block.words.end(), [&](const Word& word) {
        return word.letter == letter && !word.expression && wanted(word.value);
    });
}

/// Whether X, Y, Z, I and J of a block are not lengths.
bool has_other_meanings(const Block& block) {
    return has_code(block, 'G', [](double code) {
        return code == 4.0 || code == 10.0 || code == 65.0 || code == 66.0 || code == 66.1;
    });
}

/// Whether a block sets a tilted plane: its Q is a number of a block or an order, and its I, J and
/// K are angles or a direction.
bool sets_plane(const Block& block) {
    return has_code(block, 'G',
                    [](double code) { return code == 68.2 || code == 68.4 || code == 268.0; });
}

} // namespace

bool lacks_point(const Block& block) {
    return std::any_of(block.words.begin(), block.words.end(), [&](const Word& word) {
        return counts_increments(word.letter) && !word.has_point && !word.expression
               && word.value != 0.0 && !(word.letter == 'Q' && sets_plane(block));
    });
}

bool counts_steps(const Block& block, InterpreterState& state, const Environment& environment) {
    if (environment.counts_smallest_steps || state.points.counts_steps) return true;
    if (!environment.control.reports_premises || is_dwell(block) || !lacks_point(block))
        return false;
    state.points.counts_steps =
        !answer_to(state, environment, ControlQuestion::point_is_implied, block.line);
    return state.points.counts_steps;
}

void note_points(const Block& block, InterpreterState& state, BlockCommands& result) {
    DecimalPoints& points = state.points;
    if (points.said || has_other_meanings(block)) return;
    for (const Word& word : block.words) {
        const bool is_length =
            std::string_view("XYZIJ").find(word.letter) != std::string_view::npos;
        if (!is_length || word.expression || word.value == 0.0) continue;
        (word.has_point ? points.present : points.missing) = true;
        if (!points.present || !points.missing) continue;
        points.said = true;
        result.warnings.push_back(
            {Severity::warning, word.span,
             fmt::format("{} has {} decimal point, earlier lengths have {}: lengths without a "
                         "point are read as whole units; a control set to count least increments "
                         "reads them as a thousandth or less",
                         written(word), word.has_point ? "a" : "no",
                         word.has_point ? "none" : "one"),
             core::rule_id("missing-decimal-point"), "Add a decimal point to every length."});
        return;
    }
}

double increment_scale(InterpreterState& state, const Environment& environment, uint32_t line) {
    if (environment.control.answer(ControlQuestion::increment_is_coarser) == true) return 10.0;
    return answer_to(state, environment, ControlQuestion::increment_is_finer, line) ? 0.1 : 1.0;
}

void begin_modes(ModalState& modal, const Environment& environment) {
    const ControlSettings& control = environment.control;
    const auto inches = control.answer(ControlQuestion::starts_in_inches);
    if (inches && !environment.units_at_start) {
        modal.unit = *inches ? LengthUnit::inch : LengthUnit::mm;
        modal.unit_said = true;
    }
    const double plane = control.number(ControlQuestion::starts_in_plane).value_or(17.0);
    if (plane == 18.0) modal.plane = Plane::zx;
    if (plane == 19.0 || control.answer(ControlQuestion::starts_in_yz) == true)
        modal.plane = Plane::yz;
    if (const auto tolerance = control.number(ControlQuestion::corner_tolerance))
        modal.path_tolerance = *tolerance;
    // emccanon.cc: it starts as if G64 without P had been programmed.
    modal.corner_tolerances.rapids_keep_speed =
        environment.dialect == DialectId::linuxcnc && control.follows_start;
    const ControlParameter* distance =
        find_parameter(ControlQuestion::starts_incremental, environment.dialect);
    // Without a description of anything that could be hit, what an earlier program left is ignored.
    modal.distance_said = !distance || (distance->key.empty() && !control.follows_start);
    modal.work_said = !find_parameter(ControlQuestion::starts_without_work, environment.dialect)
                      && !may_start_elsewhere(environment);
    modal.retract_said = !(control.follows_start && may_keep_modes(environment));
    modal.plane_said = !find_parameter(ControlQuestion::starts_in_plane, environment.dialect);
}

void leave_work_offset(ModalState& modal) {
    Offsets offsets = modal.offsets;
    offsets.active = no_work_offset;
    offsets.work = {};
    change_offsets(modal, offsets);
}

namespace {

/// Whether the axis words of a block, if any, are positions or distances of the program.
bool has_coordinates(const Execution& execution) {
    const CodeWord* action = execution.statement.of(ModalGroup::action);
    const bool others = action
                        && (action->code->number == g_code(4) || action->code->number == g_code(92)
                            || action->code->number == g_code(10));
    return execution.statement.has_axis_word() && !others && !in_machine_coordinates(execution);
}

/// Whether the way of a block depends on the plane.
bool uses_plane(const Execution& execution) {
    const Statement& statement = execution.statement;
    const CodeWord* motion = statement.of(ModalGroup::motion);
    const bool is_arc_block =
        motion ? motion->code->number == g_code(2) || motion->code->number == g_code(3)
               : is_arc(execution.modal().motion) && has_coordinates(execution);
    const CodeWord* cycle = statement.of(ModalGroup::cycle);
    const CodeWord* radius = statement.of(ModalGroup::cutter_radius);
    return is_arc_block || (cycle && cycle->code->is_cycle())
           || (radius && radius->code->number != g_code(40)) || statement.of(ModalGroup::rotation);
}

/// Asks for the plane at the start where it matters.
void ask_for_plane(Execution& execution) {
    ModalState& modal = execution.modal();
    const auto asks = [&](ControlQuestion question) {
        return number_for(execution.state, execution.environment, question, execution.block.line);
    };
    if (execution.statement.of(ModalGroup::plane)) {
        modal.plane_said = true;
    } else if (uses_plane(execution)) {
        modal.plane_said = true;
        if (!execution.environment.control.follows_start) return;
        if (asks(ControlQuestion::starts_in_plane) == 18.0)
            modal.plane = Plane::zx;
        else if (find_parameter(ControlQuestion::starts_in_yz, execution.dialect.id)
                 && asks(ControlQuestion::starts_in_yz) != 0.0)
            modal.plane = Plane::yz;
        else if (asks(ControlQuestion::starts_in_plane) == 19.0)
            modal.plane = Plane::yz;
        if (modal.plane != Plane::xy) execution.emit(SelectPlane{modal.plane});
    }
}

/// Settles whether G91 is still active after its block.
void ask_for_distance(Execution& execution) {
    ModalState& modal = execution.modal();
    const Statement& statement = execution.statement;
    const bool relies = statement.letters & letter_bits("XYZABCUVWR");
    if (modal.incremental_stays || !relies || statement.of(ModalGroup::distance)
        || in_machine_coordinates(execution))
        return;
    if (answer_to(execution.state, execution.environment, ControlQuestion::incremental_acts_once,
                  execution.block.line))
        modal.distance = DistanceMode::absolute;
    modal.incremental_stays = true;
}

/// Settles to which level the first cycle retracts.
void ask_for_retract(Execution& execution) {
    ModalState& modal = execution.modal();
    if (modal.retract_said) return;
    const CodeWord* cycle = execution.statement.of(ModalGroup::cycle);
    const bool runs = cycle ? cycle->code->number != g_code(80) : modal.cycle.has_value();
    const bool is_said = execution.statement.of(ModalGroup::retract);
    if (!runs && !is_said) return;
    modal.retract_said = true;
    const Environment& environment = execution.environment;
    const uint32_t line = execution.block.line;
    if (!is_said && starts_with_left_modes(execution.state, environment, line)
        && answer_to(execution.state, environment, ControlQuestion::starts_at_r_level, line))
        modal.retract = RetractMode::r_level;
}

/// Whether the axis words of a block are distances, on which no work offset acts.
bool is_incremental(const Execution& execution) {
    const CodeWord* distance = execution.statement.of(ModalGroup::distance);
    return distance ? distance->code->number == g_code(91)
                    : execution.modal().distance == DistanceMode::incremental;
}

/// Settles which work offset is active where the program selects none, and whether any is.
void ask_for_work_offset(Execution& execution) {
    ModalState& modal = execution.modal();
    if (modal.work_said) return;
    const Environment& environment = execution.environment;
    const bool says_work = execution.statement.of(ModalGroup::work_offset);
    if (!find_parameter(ControlQuestion::starts_without_work, environment.dialect)) {
        const CodeWord* action = execution.statement.of(ModalGroup::action);
        const bool sets = action && action->code->number == g_code(92);
        const bool relies = has_coordinates(execution) && !is_incremental(execution);
        if (!says_work && !relies && !sets) return;
        modal.work_said = true;
        if (!says_work
            && starts_with_left_modes(execution.state, environment, execution.block.line))
            use_work_offset(execution,
                            first_work_offset(execution.state, environment, execution.block.line));
        return;
    }
    const bool matters = has_coordinates(execution) && modal.offsets.work != WorkOffset{};
    if (!matters && !says_work) return;
    if (!says_work
        && answer_to(execution.state, environment, ControlQuestion::starts_without_work,
                     execution.block.line)) {
        leave_work_offset(modal);
        execution.emit(SetOffset{modal.offsets});
    }
    modal.work_said = true;
}

} // namespace

void ask_for_first_modes(Execution& execution) {
    ModalState& modal = execution.modal();
    if (!modal.plane_said) ask_for_plane(execution);
    ask_for_distance(execution);
    ask_for_retract(execution);
    if (modal.distance_said && modal.work_said) return;
    const Statement& statement = execution.statement;
    const bool relies = has_coordinates(execution);
    const auto asks = [&](ControlQuestion question) {
        return answer_to(execution.state, execution.environment, question, execution.block.line);
    };
    const bool says_distance = statement.of(ModalGroup::distance);
    if (!modal.distance_said && (relies || says_distance)) {
        if (!says_distance && asks(ControlQuestion::starts_incremental))
            modal.distance = DistanceMode::incremental;
        modal.distance_said = true;
    }
    ask_for_work_offset(execution);
}

void count_smallest_steps(Block& block, const ModalState& modal, DialectId dialect, double scale) {
    if (is_dwell(block)) return; // X is a time; without a point it is in milliseconds anyway
    const bool to_inch = has_code(block, 'G', [](double code) { return code == 20.0; });
    const bool to_mm = has_code(block, 'G', [](double code) { return code == 21.0; });
    const bool inch = to_inch || (modal.unit == LengthUnit::inch && !to_mm);
    const bool cycle = modal.cycle || has_code(block, 'G', [&](double number) {
                           const Code* code = find_code('G', number, dialect);
                           return code && code->is_cycle();
                       });
    const bool calls = has_code(block, 'M', [](double code) { return code >= 96.0; });
    const bool turns = has_code(block, 'G', [](double code) { return code == 68.0; });
    const bool is_plane = sets_plane(block);
    for (Word& word : block.words) {
        if (word.has_point || word.expression || !counts_increments(word.letter)) continue;
        if ((word.letter == 'K' && cycle) || (word.letter == 'Q' && (calls || is_plane))) continue;
        const bool angle = (word.letter >= 'A' && word.letter <= 'C')
                           || (word.letter == 'R' && turns)
                           || (word.letter >= 'I' && word.letter <= 'K' && is_plane);
        word.value /= (inch && !angle ? 10000.0 : 1000.0) / scale;
    }
}

} // namespace gcode
