#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace app {

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

} // namespace app
