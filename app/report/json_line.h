#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "gcode/axes.h"

namespace app {

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

} // namespace app
