#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace app {

/// A line of a program taken apart: what the control reads, and what it does not.
struct LineParts {
    std::string code; // in capitals, without blanks
    std::vector<std::string> comments;
};

/// Comments in round brackets, behind a semicolon, and, where no word with a number can stand, in
/// square ones.
LineParts parts_of_line(std::string_view line);

} // namespace app
