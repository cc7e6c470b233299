#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "gcode/exec/interpreter.h"
#include "gcode/language/modal_state.h"

namespace app {

/// Appends the commands of a block, one per line: `6: straight_feed x=20 y=10 feed=150`.
void append_trace_text(const gcode::BlockCommands& block, std::string& text);

/// Appends the commands of a block as JSON, one object per line. Lengths and angles are written to
/// the last bit; invalid UTF-8 is replaced.
void append_trace_json(const gcode::BlockCommands& block, std::string& text);

/// Appends one JSON object on one line to a text, key by key. Made for millions of objects: builds
/// no tree.
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

    /// Appends a number; null if it is not finite, because JSON has no such numbers.
    void append(double value);

    void finish() { text_ += "}\n"; }

private:
    std::string& text_;
    bool is_first_ = true;
};

/// Limits the printed warnings of a run, so that one repeated on every line does not bury the
/// others: prints the first ten of each message, then the number of the rest.
class WarningLog {
public:
    /// The line to print for a warning: `file:line:column: message`. Empty if it is only counted.
    std::string line_for(const gcode::Warning& warning, std::string_view file);

    /// The lines to print at the end; empty if no warning was suppressed.
    std::string rest() const;

private:
    std::map<std::string, uint64_t, std::less<>> counts_; // by message
    uint64_t others_ = 0; // warnings beyond the limit of distinct messages
};

} // namespace app
