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

/// A text in UTF-8. Programs and names of files hold bytes of any code page: what is no UTF-8 is
/// taken for Latin-1. What is UTF-8 stays as it is.
std::string utf8_text(std::string_view text);

/// How many characters it has then.
size_t characters_in(std::string_view text);

/// The lines of a small text file, without their ends.
///
/// Errors: io, with the file, when it cannot be read or is larger than a table would be.
core::Result<std::vector<std::string>> lines_of_file(const std::string& path);

/// The words of a line between blanks.
std::vector<std::string> words_of_line(const std::string& line);

/// The number that a text is; empty when it is none, or not finite. A leading + is allowed.
std::optional<double> number_in(std::string_view text);

/// What is wrong in a line of a file, line counted from 1.
core::Error line_error(const std::string& path, size_t line, std::string message);

/// Without white space at both ends and with no control characters, and so in one line.
std::string trimmed(std::string_view text);

/// A report as it may reach a terminal: in UTF-8, and with no control characters but line ends.
std::string printable(std::string_view text);

/// At most `width` bytes, `...` where something is missing; characters of UTF-8 stay whole.
std::string clipped(const std::string& text, size_t width);

/// Lines of at most 80 characters, indented by `indent`, all but the first by `hang` more.
std::string wrapped(const std::string& text, size_t indent, size_t hang = 0);

/// "4, 7-9, 12"; after a dozen ranges, only where they end.
std::string line_ranges(std::vector<uint32_t> lines);

/// A text, such as a name or a block, as a cell of comma-separated values: quoted where it has to
/// be, and with an apostrophe before what a spreadsheet would take for a formula and carry out.
/// Numbers need none of that.
std::string csv_cell(const std::string& text);

/// "1 error", "2 errors".
std::string counted(size_t count, const std::string& noun);

/// "1 error, 2 warnings, 0 notes".
std::string counts_text(size_t errors, size_t warnings, size_t notes);

/// The bounds of a clearance in mm for a column: "1.900-1.999", or ">= 1.900" without an upper
/// bound. An upper bound below the allowance is never rounded up to it.
std::string clearance_text(double lower, std::optional<double> upper, double allowance);

/// "4 min 05 s".
std::string duration_text(double seconds);

/// The verdict on a program in capitals, with what it means.
std::string verdict_text(core::Verdict verdict);

} // namespace app
