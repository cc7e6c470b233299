#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace gcode {

/// The longest line that is read, in bytes.
constexpr size_t longest_line = 65536;

/// An NC program as text with an index of its lines. Keep it where it is while blocks refer to it.
struct Program {
    std::string file; // as the user gave it; may be empty
    std::string text; // without a byte-order mark
    std::vector<size_t> line_starts;

    size_t line_count() const { return line_starts.size(); }

    /// The text of a line, counted from 1, without its line end.
    std::string_view line(size_t number) const;
};

/// The program in a file.
///
/// Errors: io when it cannot be read (missing, a directory, no permission); syntax when it is not
///         an NC program (empty, binary, a line longer than `longest_line`).
/// Cost:   reads in chunks and stops at the first error, so a huge file of one line is cheap to
/// refuse.
core::Result<Program> read_program(const std::string& path);

/// The program in a text. `file` is the name that errors carry.
///
/// Errors: syntax, as read_program.
core::Result<Program> program_from_text(std::string_view text, std::string file = {});

} // namespace gcode
