#include "tests/fuzz/program_runs.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "gcode/exec/interpreter.h"
#include "gcode/language/environment.h"
#include "gcode/lower/lowering.h"
#include "gcode/text/source.h"
#include "tests/fuzz/chosen_program.h"
#include "tests/support/same_state.h"

namespace test_support {
namespace {

constexpr uint64_t most_blocks = 300;
constexpr size_t longest_text = 16384;

/// The running program, for the message when an assertion fails.
thread_local std::string_view program_text;
thread_local std::string_view dialect_name;

void require(bool holds, std::string_view what) {
    if (holds) return;
    std::fputs(fmt::format("broken promise: {}, with this program of the dialect {}:\n{}\n", what,
                           dialect_name, program_text)
                   .c_str(),
               stderr);
    std::abort();
}

bool is_finite(const gcode::Position& position) {
    for (const auto& value : position)
        if (value && !std::isfinite(*value)) return false;
    return true;
}

bool is_finite(const gcode::CanonicalCommand& command) {
    return std::visit(
        [](const auto& entry) {
            if constexpr (requires { entry.end; }) {
                if (!is_finite(entry.end)) return false;
            }
            if constexpr (requires { entry.centre; }) {
                if (!std::isfinite(entry.centre[0]) || !std::isfinite(entry.centre[1]))
                    return false;
            }
            if constexpr (requires { entry.feed; }) {
                if (!(std::isfinite(entry.feed) && entry.feed >= 0.0)) return false;
            }
            if constexpr (requires { entry.seconds; }) {
                if (!(std::isfinite(entry.seconds) && entry.seconds >= 0.0)) return false;
            }
            return true;
        },
        command);
}

bool is_finite(const core::Event& event) {
    const auto* motion = std::get_if<core::Motion>(&event);
    if (!motion) return true;
    for (const core::AxisPosition* position : {&motion->from, &motion->to})
        for (const auto& value : *position)
            if (value && !std::isfinite(*value)) return false;
    return !motion->arc || std::isfinite(motion->arc->angle);
}

void check_block(const gcode::BlockCommands& block, gcode::Lowering& lowering, size_t lines) {
    require(block.columns.size() == block.commands.size(), "every command has a column");
    require(block.file.empty() && block.line >= 1 && block.line <= lines,
            "a block is a line of its program");
    for (const auto& command : block.commands)
        require(is_finite(command), "commands are finite numbers");
    for (const core::Event& event : gcode::lower(block, lowering))
        require(is_finite(event), "motions are finite numbers");
    for (const gcode::Warning& warning : block.warnings)
        require(!warning.message.empty() && warning.where.line <= lines, "a warning has a place");
}

/// The outcome of a run, enough to compare two runs.
struct Outcome {
    uint64_t digest = 0;
    size_t blocks = 0, commands = 0;
    std::string error{};

    bool operator==(const Outcome&) const = default;
};

Outcome run_on(gcode::ProgramLibrary& library, const gcode::Environment& environment,
               gcode::InterpreterState& state, std::optional<gcode::InterpreterState>* half_way) {
    gcode::Interpreter interpreter(library, environment);
    gcode::Lowering lowering = gcode::initial_lowering(state);
    const size_t lines = library.program(0).line_count();
    Outcome outcome;
    while (true) {
        if (half_way && state.next_block == most_blocks / 20) *half_way = state;
        const bool may_fail_late = has_pending_blocks(state);
        const gcode::InterpreterState before = state;
        auto next = interpreter.next(state);
        if (!next) {
            const core::Error& error = next.error();
            require(!error.message.empty() && error.where.line <= lines, "an error has a place");
            if (!may_fail_late && !has_pending_blocks(state)) {
                require(continue_alike(state, before),
                        "an error leaves the state as it was before the block");
                require(gcode::digest_of(state) == gcode::digest_of(before),
                        "states that are equal have one digest");
            }
            outcome.error = error.message;
            break;
        }
        if (!*next) break;
        check_block(**next, lowering, lines);
        ++outcome.blocks;
        outcome.commands += (*next)->commands.size();
    }
    outcome.digest = gcode::digest_of(state);
    return outcome;
}

} // namespace

void run_any_program(std::string_view text, gcode::DialectId dialect, bool block_delete) {
    const auto program = gcode::program_from_text(text.substr(0, longest_text));
    if (!program) {
        require(!program.error().message.empty(), "a refusal says why");
        return;
    }
    program_text = program->text;
    dialect_name = gcode::dialect(dialect).name;
    gcode::Environment environment;
    environment.dialect = dialect;
    environment.block_delete = block_delete;
    environment.limits.blocks = most_blocks;
    environment.search_path = {"/nonexistent"};
    gcode::ProgramLibrary library(*program, gcode::dialect(dialect), environment.search_path);
    gcode::InterpreterState state = gcode::initial_state(environment);
    std::optional<gcode::InterpreterState> half_way;
    const Outcome whole = run_on(library, environment, state, &half_way);
    if (!half_way) return;
    const Outcome rest = run_on(library, environment, *half_way, nullptr);
    require(rest.digest == whole.digest && rest.error == whole.error
                && continue_alike(*half_way, state),
            "a copy of a state goes on as the state itself");
}

void run_any_bytes(std::span<const uint8_t> bytes) {
    if (bytes.empty()) return;
    constexpr uint8_t dialects = 6;
    const auto dialect = static_cast<gcode::DialectId>(bytes[0] % dialects);
    const bool block_delete = bytes[0] / dialects % 2 == 1;
    const auto text = bytes.subspan(1);
    run_any_program({reinterpret_cast<const char*>(text.data()), text.size()}, dialect,
                    block_delete);
}

void run_chosen_program(std::span<const uint8_t> choices) {
    const ChosenProgram chosen = chosen_program(choices);
    run_any_program(chosen.text, chosen.dialect, chosen.block_delete);
}

} // namespace test_support
