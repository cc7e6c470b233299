#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "gcode/exec/interpreter.h"
#include "gcode/language/modal_state.h"

namespace app {

/// Appends the commands of a block, one a line: `6: straight_feed x=20 y=10 feed=150`.
void append_trace_text(const gcode::BlockCommands& block, std::string& text);

/// Appends the commands of a block as JSON, one a line, keys as the design of the command line has
/// them. Lengths and angles to the last bit; bytes that are no UTF-8 are replaced.
void append_trace_json(const gcode::BlockCommands& block, std::string& text);

/// Writes one JSON object at the end of a text, on one line, key by key. For what comes by the
/// million: nothing is kept but the text.
class JsonLine {
public:
    explicit JsonLine(std::string& text) : text_(text) { text_ += '{'; }

    void add(std::string_view key, double value);
    void add(std::string_view key, int64_t value);
    void add(std::string_view key, bool value);
    void add(std::string_view key, std::string_view value);
    void add_null(std::string_view key);
    void add_numbers(std::string_view key, const double* values, size_t count);
    void add_position(std::string_view key, const gcode::Position& position);

    /// A key whose value the caller appends to the text.
    void begin(std::string_view key);

    /// Appends a number, null where it is not finite, as JSON has none such.
    void append(double value);

    void finish() { text_ += "}\n"; }

private:
    std::string& text_;
    bool is_first_ = true;
};

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
