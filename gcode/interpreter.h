#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/ids.h"
#include "core/base/result.h"
#include "gcode/canonical.h"
#include "gcode/environment.h"
#include "gcode/source.h"

namespace gcode {

enum class Severity : uint8_t { note, warning };

/// Something a person should know about a block that does not stop the program.
struct Warning {
    Severity severity;
    core::SourceSpan where;
    std::string message;
};

/// One block as executed.
struct BlockResult {
    core::BlockIndex block{};
    uint32_t line = 0;
    std::string_view text; // the line, as long as the program stays where it is
    bool is_cycle = false; // a canned cycle, G28 or G30: one block, several motions
    std::vector<CanonicalCommand> commands{};
    std::vector<Warning> warnings{};
};

/// Whether and how a program came to its end.
enum class Ending : uint8_t { running, program_end, main_return, tape_mark, text_end };

/// Everything between two blocks. A plain value: copy it to go back in time.
struct InterpreterState {
    ModalState modal;
    size_t next_line = 1;
    uint32_t next_block = 0;
    bool tape_open = false; // a % was seen
    bool said_unit = false; // the note that units were assumed
    bool said_home = false; // the warning that home was assumed
    Ending ending = Ending::running;

    bool operator==(const InterpreterState&) const = default;
};

/// The state before the first block.
InterpreterState initial_state(const Environment& environment);

/// Executes the next block that has words; empty when the program has ended (see `state.ending`).
///
/// Errors: those of parse_line and of the codes, with file, line, column and word. Nothing has
///         changed then: `state` is as before.
/// Source: NISTIR 6556 (RS274/NGC v3), 3.8, order of execution.
core::Result<std::optional<BlockResult>>
execute_next(const Program& program, const Environment& environment, InterpreterState& state);

/// What is to be said about the way the program ended: no M2 or M30.
std::optional<Warning> ending_warning(const Environment& environment,
                                      const InterpreterState& state);

/// A whole program, up to its end or its first error.
struct Run {
    std::vector<BlockResult> blocks;
    std::optional<Warning> ending; // as ending_warning
    std::optional<core::Error> error;
    InterpreterState state; // after the last good block
};

Run run(const Program& program, const Environment& environment);

} // namespace gcode
