#pragma once

#include <string>

#include "app/debug/prompt/prompt.h"
#include "gcode/text/source.h"

namespace app {

/// A line of the main program or of a subprogram file.
struct Location {
    uint32_t line = 0;
    std::string file = {}; // as CheckedBlock::file; empty: main program
};

/// Whether a text has the form of a location: 23 (a line, or a block number of Klartext), N210,
/// sub.nc:23.
bool is_location(const std::string& text);

/// The location that a text names.
///
/// Errors: no such line, or no such file.
core::Result<Location> location_in(PromptState& state, const std::string& text);

/// The first position before a block of a line, searched from the current position on, then from
/// the beginning.
///
/// Errors: the line is never executed.
core::Result<size_t> position_of(PromptState& state, const Location& location);

/// The text of a file: the main program, or a subprogram, which is read only once.
///
/// Errors: io.
core::Result<const gcode::Program*> program_of(PromptState& state, const std::string& file);

/// The whole number in a text.
///
/// Errors: invalid_value.
core::Result<size_t> number_in(const std::string& text);

} // namespace app
