#include "app/session/value_text.h"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

namespace app {

std::string number_text(double value) {
    std::string text = fmt::format("{:.4f}", value);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    return text == "-0" ? "0" : text;
}

InspectedValue quantity(std::optional<double> value, std::string_view unit) {
    if (!value) return {std::nullopt, "unknown"};
    return {value, number_text(*value) + (unit.empty() ? "" : " ") + std::string(unit)};
}

InspectedValue axis_quantity(size_t axis, std::optional<double> value) {
    return quantity(value, gcode::is_rotary(axis) ? "deg" : "mm");
}

std::string lowered(std::string_view text) {
    std::string small(text);
    std::transform(small.begin(), small.end(), small.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return small;
}

} // namespace app
