#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "gcode/exec/interpreter.h"

namespace gcode {

/// A program that is started in its middle.
struct Restart {
    InterpreterState state;           // of a control that was just switched on, at that line
    uint32_t line = 0;                // where it begins
    std::vector<std::string> missing; // words that the lines before have set, that the cut needs
                                      // and that the lines from here on do not repeat
};

/// The line that a user means by its number in the file, as "120", or by its block number, as
/// "N210" (of a Heidenhain program as "210").
///
/// Errors: invalid_value when the program has no such line.
core::Result<uint32_t> line_meant(const Program& program, const Dialect& dialect,
                                  std::string_view text);

/// The start of a program at a line, with the control in the state after switching on and `tool` in
/// its spindle. The program is run twice to its first feed after that line, from its own beginning
/// and from the line, and what then differs is missing.
///
/// Errors: invalid_value when a run from the start of the program never reaches that line.
core::Result<Restart> restart_at(ProgramLibrary& library, const Environment& environment,
                                 uint32_t line, std::optional<core::ToolNumber> tool);

} // namespace gcode
