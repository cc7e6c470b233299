#include "gcode/interpreter.h"

#include <fmt/format.h>

#include "gcode/execution.h"
#include "gcode/parser.h"

namespace gcode {
namespace {

using core::ErrorCode;

using Step = core::Result<void> (*)(Execution&);

// NISTIR 6556, table 8: the order in which a block's words take effect, however they are written.
constexpr Step steps[] = {
    check_words,
    note_assumed_units,
    set_feed_mode,
    set_feed,
    set_speed,
    select_tool,
    change_tool,
    turn_spindle,
    set_coolant,
    dwell,
    select_plane,
    set_units,
    set_tool_length,
    select_offset,
    set_distance_mode,
    set_retract_mode,
    act,
    move,
    stop,
};

core::Result<BlockResult> execute(const Block& block, const Environment& environment,
                                  InterpreterState& state) {
    const Dialect& rules = dialect(environment.dialect);
    FEELER_TRY(const Statement statement, statement_from_block(block, rules));
    BlockResult result{
        .block = core::BlockIndex(state.next_block), .line = block.line, .text = block.text};
    Execution execution{environment, rules, block, statement, state, result};
    for (const Step step : steps)
        if (auto done = step(execution); !done) return tl::unexpected(std::move(done).error());
    ++state.next_block;
    return result;
}

/// Whether a line is skipped without a look at its words: they may be of another machine.
bool is_deleted(std::string_view line) {
    const size_t first = line.find_first_not_of(" \t");
    return first != std::string_view::npos && line[first] == '/';
}

/// The next block with words; empty at the end of the program.
core::Result<std::optional<Block>>
next_block(const Program& program, const Environment& environment, InterpreterState& state) {
    while (state.next_line <= program.line_count()) {
        const size_t number = state.next_line++;
        const std::string_view text = program.line(number);
        if (environment.block_delete && is_deleted(text)) continue;
        FEELER_TRY(Block block, parse_line(text, static_cast<uint32_t>(number)));
        if (block.tape_mark && (state.tape_open || state.next_block > 0)) {
            state.ending = Ending::tape_mark;
            return std::nullopt;
        }
        state.tape_open |= block.tape_mark;
        if (block.words.empty() || (environment.block_delete && block.block_delete)) continue;
        return block;
    }
    state.ending = Ending::text_end;
    return std::nullopt;
}

core::Result<std::optional<BlockResult>>
try_next(const Program& program, const Environment& environment, InterpreterState& state) {
    const Dialect& rules = dialect(environment.dialect);
    if (!rules.supported)
        return core::fail(ErrorCode::unsupported,
                          fmt::format("the dialect {} is not supported yet", rules.name));
    FEELER_TRY(const std::optional<Block> block, next_block(program, environment, state));
    if (!block) return std::nullopt;
    return execute(*block, environment, state);
}

} // namespace

InterpreterState initial_state(const Environment& environment) {
    InterpreterState state;
    ModalState& modal = state.modal;
    modal.unit = dialect(environment.dialect).unit;
    modal.retract = dialect(environment.dialect).retract;
    modal.offsets.work = environment.work_offsets;
    modal.position = program_from_machine(modal.offsets, environment.start);
    for (int axis = 0; axis < 3; ++axis) {
        if (environment.home) modal.home[axis] = (*environment.home)[axis];
        if (environment.second_home) modal.second_home[axis] = (*environment.second_home)[axis];
    }
    return state;
}

core::Result<std::optional<BlockResult>>
execute_next(const Program& program, const Environment& environment, InterpreterState& state) {
    if (state.ending != Ending::running) return std::nullopt;
    InterpreterState after = state;
    auto result = try_next(program, environment, after);
    if (result)
        state = after;
    else
        result.error().file = program.file;
    return result;
}

std::optional<Warning> ending_warning(const Environment& environment,
                                      const InterpreterState& state) {
    const core::SourceSpan where{.line = static_cast<uint32_t>(state.next_line - 1)};
    if (state.ending == Ending::main_return)
        return Warning{Severity::warning, where,
                       "M99 in a main program starts it again; one pass was looked at"};
    const bool proper_mark =
        state.ending == Ending::tape_mark && dialect(environment.dialect).tape_mark_ends_program;
    if (state.ending == Ending::text_end || (state.ending == Ending::tape_mark && !proper_mark))
        return Warning{Severity::warning, where, "the program has no M2 or M30 at its end"};
    return std::nullopt;
}

Run run(const Program& program, const Environment& environment) {
    Run whole;
    whole.state = initial_state(environment);
    while (true) {
        auto result = execute_next(program, environment, whole.state);
        if (!result) {
            whole.error = std::move(result).error();
            return whole;
        }
        if (!*result) break;
        whole.blocks.push_back(**std::move(result));
    }
    whole.ending = ending_warning(environment, whole.state);
    return whole;
}

} // namespace gcode
