#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "gcode/language/dialect.h"
#include "gcode/language/environment.h"
#include "gcode/text/source.h"
#include "tests/support/whole_run.h"

namespace gcode {

/// Machine X0 Y0 Z0 at the first block, and all positions and lengths that the tests refer to.
inline Environment known_environment(DialectId dialect) {
    Environment environment;
    environment.dialect = dialect;
    environment.start = zero_position;
    environment.home = AxisValues{};
    environment.second_home = AxisValues{0.0, 0.0, -50.0};
    environment.fixed_point = environment.second_home;
    return environment;
}

/// A run together with its program.
struct Ran {
    Program program;
    Run run;
};

inline Ran run_text(std::string_view text, const Environment& environment) {
    Ran ran;
    auto program = program_from_text(text, "test.ngc");
    if (!program) {
        ran.run.error = program.error();
        return ran;
    }
    ran.program = *std::move(program);
    ran.run = gcode::run(ran.program, environment);
    return ran;
}

inline Ran run_text(std::string_view text, DialectId dialect = DialectId::fanuc) {
    return run_text(text, known_environment(dialect));
}

/// The commands, one on each line, without line numbers, warnings and the command that ends a
/// program.
inline std::string commands_of(const Run& run) {
    std::string text;
    for (const BlockCommands& block : run.blocks)
        for (const CanonicalCommand& command : block.commands)
            if (!std::holds_alternative<ProgramEnd>(command)) text += to_text(command) + "\n";
    return text;
}

inline std::string trace(std::string_view text, DialectId dialect = DialectId::fanuc) {
    const Ran ran = run_text(text, dialect);
    if (ran.run.error) return commands_of(ran.run) + "error: " + ran.run.error->message + "\n";
    return commands_of(ran.run);
}

/// "line:column: message" of the error that stopped a program; empty when there was none.
inline std::string error_of(std::string_view text, DialectId dialect = DialectId::fanuc) {
    const Ran ran = run_text(text, dialect);
    if (!ran.run.error) return {};
    const core::Error& error = *ran.run.error;
    return std::to_string(error.where.line) + ":" + std::to_string(error.where.column) + ": "
           + error.message;
}

/// All warnings and notes, one on each line.
inline std::string warnings_of(const Run& run) {
    std::string text;
    for (const BlockCommands& block : run.blocks)
        for (const Warning& warning : block.warnings) text += warning.message + "\n";
    if (run.ending) text += run.ending->message + "\n";
    return text;
}

inline std::string warnings_of(std::string_view text, DialectId dialect = DialectId::fanuc) {
    return warnings_of(run_text(text, dialect).run);
}

inline const std::filesystem::path source_dir = FEELER_SOURCE_DIR;

} // namespace gcode
