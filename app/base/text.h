#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/sim/verdict.h"

namespace app {

/// A text converted to UTF-8. Programs and file names contain bytes of any code page: invalid UTF-8
/// is read as Latin-1, valid UTF-8 stays unchanged.
std::string utf8_text(std::string_view text);

/// The number of characters of utf8_text(text).
size_t characters_in(std::string_view text);

/// The code points of a text; for a byte that is not UTF-8, a number above all of them, which no
/// other byte has.
std::u32string code_points(std::string_view text);

/// The lines of a small text file, without line ends.
///
/// Errors: io, with the file, if it cannot be read or is too large for a table.
core::Result<std::vector<std::string>> lines_of_file(const std::string& path);

/// The words of a line, separated by blanks.
std::vector<std::string> words_of_line(const std::string& line);

/// The number in a text; empty if it is not a finite number. A leading + is allowed.
std::optional<double> number_in(std::string_view text);

/// An error in a line of a file; lines are numbered from 1.
core::Error line_error(const std::string& path, size_t line, std::string message);

/// A path from the root, without `.` and `..`; as it is if it is empty or there is no current
/// folder.
std::string absolute_path(const std::string& path);

/// Without white space at both ends and without control characters, so on one line.
std::string trimmed(std::string_view text);

/// A text that is safe for a terminal: UTF-8, without control characters except line ends.
std::string printable(std::string_view text);

/// At most `width` bytes, with `...` if shortened; UTF-8 characters stay whole.
std::string clipped(const std::string& text, size_t width);

/// Lines of at most `width` characters, indented by `indent`, all but the first by `hang` more.
std::string wrapped(const std::string& text, size_t indent, size_t hang = 0, size_t width = 80);

/// "4, 7-9, 12"; after twelve ranges only the last number.
std::string line_ranges(std::vector<uint32_t> lines);

/// A text as a cell of comma-separated values: quoted if necessary, and with an apostrophe before
/// anything that a spreadsheet would execute as a formula. Not needed for numbers.
std::string csv_cell(const std::string& text);

/// "1 error", "2 errors".
std::string counted(size_t count, const std::string& noun);

/// "1 error, 2 warnings, 0 notes".
std::string counts_text(size_t errors, size_t warnings, size_t notes);

/// A time of at least 0 in whole seconds, or minutes from an hour on: "5 s", "4 min 05 s",
/// "2 h 05 min", "more than 1,000,000 h"; "unknown" if it is infinite.
std::string duration_text(double seconds);

/// The verdict on a program in capitals, with its meaning.
std::string verdict_text(core::Verdict verdict);

} // namespace app
