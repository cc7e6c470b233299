#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/exec/interpreter.h"

namespace gcode {

enum class DialectId : uint8_t;

/// A program started in the middle.
struct Restart {
    InterpreterState state;           // of a control just switched on, at that line
    uint32_t line = 0;                // where the program starts
    std::vector<std::string> missing; // words set by earlier lines that the cut needs and that
                                      // later lines do not repeat
};

/// The line that a user means: its number in the file, as "120", or its block number, as "N210" (in
/// a Heidenhain program "210").
///
/// Errors: invalid_value when the program has no such line.
core::Result<uint32_t> line_meant(const Program& program, DialectId dialect, std::string_view text);

/// Prepares the start of a program at a line, with the control as after switching on and `tool` in
/// the spindle. Runs the program twice up to the first feed after that line, from the start and
/// from the line; words by which the two states differ are missing.
///
/// Errors: invalid_value when a run from the start of the program never reaches that line.
core::Result<Restart> restart_at(ProgramLibrary& library, const Environment& environment,
                                 uint32_t line, std::optional<core::ToolNumber> tool);

} // namespace gcode
