#include "app/report/json_line.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace app {
namespace {

/// Whether a text stands in JSON as it is.
bool is_plain(std::string_view text) {
    return std::all_of(text.begin(), text.end(),
                       [](char c) { return c >= ' ' && c < 0x7F && c != '"' && c != '\\'; });
}

} // namespace

void JsonLine::begin(std::string_view key) {
    if (!is_first_) text_ += ',';
    is_first_ = false;
    text_ += '"';
    text_ += key;
    text_ += "\":";
}

void JsonLine::append(double value) {
    if (!std::isfinite(value)) {
        text_ += "null";
        return;
    }
    fmt::format_to(std::back_inserter(text_), "{}", value);
}

void JsonLine::add(std::string_view key, double value) {
    begin(key);
    append(value);
}

void JsonLine::add(std::string_view key, int64_t value) {
    begin(key);
    fmt::format_to(std::back_inserter(text_), "{}", value);
}

void JsonLine::add(std::string_view key, bool value) {
    begin(key);
    text_ += value ? "true" : "false";
}

void JsonLine::add(std::string_view key, std::string_view value) {
    begin(key);
    if (is_plain(value)) {
        text_ += '"';
        text_ += value;
        text_ += '"';
        return;
    }
    using Json = nlohmann::json;
    text_ += Json(std::string(value)).dump(-1, ' ', false, Json::error_handler_t::replace);
}

void JsonLine::add_null(std::string_view key) {
    begin(key);
    text_ += "null";
}

void JsonLine::add_numbers(std::string_view key, const double* values, size_t count) {
    begin(key);
    for (size_t i = 0; i < count; ++i) {
        text_ += i == 0 ? '[' : ',';
        append(values[i]);
    }
    text_ += ']';
}

void JsonLine::add_position(std::string_view key, const gcode::Position& position) {
    begin(key);
    for (size_t axis = 0; axis < gcode::axis_count; ++axis) {
        text_ += axis == 0 ? '[' : ',';
        if (position[axis])
            append(*position[axis]);
        else
            text_ += "null";
    }
    text_ += ']';
}

} // namespace app
