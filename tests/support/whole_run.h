#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "gcode/exec/interpreter.h"
#include "gcode/language/dialect.h"
#include "gcode/language/environment.h"
#include "gcode/lower/trace.h"
#include "gcode/text/source.h"

namespace gcode {

/// The result of running a whole program, which is not read in windows, to its end or first error.
struct Run {
    std::shared_ptr<ProgramLibrary> library; // owns the texts that blocks refer to
    std::vector<BlockCommands> blocks;
    std::optional<Warning> ending; // as end_warning
    std::optional<core::Error> error;
    InterpreterState state; // after the last good block
};

inline Run run(const Program& program, const Environment& environment) {
    Run whole;
    whole.library = std::make_shared<ProgramLibrary>(program, dialect(environment.dialect),
                                                     environment.search_path);
    Interpreter interpreter(*whole.library, environment);
    whole.state = initial_state(environment);
    while (true) {
        auto result = interpreter.next(whole.state);
        if (!result) {
            whole.error = std::move(result).error();
            return whole;
        }
        if (!*result) break;
        whole.blocks.push_back(**result);
    }
    whole.ending = end_warning(environment, whole.state);
    return whole;
}

inline std::string to_text(const Warning& warning) {
    return fmt::format("{}:{}: {}: {}\n", warning.where.line, warning.where.column,
                       warning.severity == Severity::note ? "note" : "warning", warning.message);
}

/// The commands of a program, one per line after the line number, followed by the warnings of each
/// block and the error that stopped the program. This is the format of golden files.
inline std::string to_text(const Run& run) {
    std::string text;
    for (const BlockCommands& block : run.blocks) {
        for (const CanonicalCommand& command : block.commands)
            text += fmt::format("{}: {}\n", block.line, to_text(command));
        for (const Warning& warning : block.warnings) text += to_text(warning);
    }
    if (run.ending) text += to_text(*run.ending);
    if (run.error)
        text += fmt::format("{}:{}: error: {}\n", run.error->where.line, run.error->where.column,
                            run.error->message);
    return text;
}

} // namespace gcode
