#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "gcode/interpreter.h"

namespace app {

/// What is said about the warnings of a run, so that one that comes at every line does not bury
/// the others: the first ten places of each message, and how many more there were.
class WarningLog {
public:
    /// The line to print for a warning: `file:line:column: message`. Empty when it is only counted.
    std::string line_for(const gcode::Warning& warning, std::string_view file);

    /// The lines to print at the end; empty when everything was said.
    std::string rest() const;

private:
    std::map<std::string, uint64_t, std::less<>> counts_; // by message
    uint64_t others_ = 0; // whose messages were too many to remember
};

} // namespace app
