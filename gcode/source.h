#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "gcode/line_windows.h"

namespace gcode {

/// The longest line that is read, in bytes.
constexpr size_t longest_line = 65536;

/// An NC program: as text with an index of its lines, or read in windows from its file. Keep it
/// where it is while blocks refer to it.
struct Program {
    std::string file; // as the user gave it; may be empty
    std::string text; // without a byte-order mark; empty when it is read in windows
    std::vector<uint32_t> line_starts;
    std::shared_ptr<LineWindows> windows{};

    /// Of a program that is not read in windows.
    size_t line_count() const { return line_starts.size(); }

    /// Errors: when it is read in windows, those of read_program, found on the way.
    core::Result<bool> has_line(size_t number) const;

    /// The text of a line that it has, counted from 1, without its line end. When it is read in
    /// windows the text stands until the next look at a line.
    std::string_view line(size_t number) const;

    /// The same, or empty when there is no such line.
    ///
    /// Errors: as has_line.
    core::Result<std::optional<std::string_view>> find_line(size_t number) const;
};

/// The program in a file.
///
/// Errors: io when it cannot be read (missing, a directory, no permission); syntax when it is not
///         an NC program (empty, binary, a line longer than `longest_line`).
/// Cost:   reads in chunks and stops at the first error, so a huge file of one line is cheap to
/// refuse.
core::Result<Program> read_program(const std::string& path);

/// The program in a file, to be run from its beginning to its end: read in windows when it is long,
/// so that memory does not grow with it.
///
/// Errors: io and syntax as read_program, as far as they are in the first window; the others when
///         the line at fault is reached.
core::Result<Program> open_program(const std::string& path, size_t window = size_t(1) << 18);

/// The program in a text. `file` is the name that errors carry.
///
/// Errors: syntax, as read_program.
core::Result<Program> program_from_text(std::string_view text, std::string file = {});

} // namespace gcode
