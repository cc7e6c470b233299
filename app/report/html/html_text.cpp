#include "app/report/html/html_text.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "app/base/text.h"
#include "core/base/math.h"
#include "core/sim/verdict.h"

namespace app {
namespace {

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }

} // namespace

std::string html_text(std::string_view text) {
    std::string safe;
    for (const char c : utf8_text(text)) {
        switch (c) {
        case '&':
            safe += "&amp;";
            break;
        case '<':
            safe += "&lt;";
            break;
        case '>':
            safe += "&gt;";
            break;
        case '"':
            safe += "&quot;";
            break;
        case '\'':
            safe += "&#39;";
            break;
        default:
            safe += is_control(c) ? ' ' : c;
        }
    }
    return safe;
}

std::string script_string(std::string_view text) {
    std::string safe = "\"";
    for (const char c : utf8_text(text)) {
        if (c == '"' || c == '\\')
            (safe += '\\') += c;
        else if (c == '<' || c == '>' || c == '&' || is_control(c))
            fmt::format_to(std::back_inserter(safe), "\\u{:04x}", static_cast<unsigned char>(c));
        else
            safe += c;
    }
    return safe += '"';
}

std::string base64(std::string_view bytes) {
    constexpr std::string_view letters =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t three = 0;
        for (size_t k = 0; k < 3; ++k)
            three = three << 8 | (i + k < bytes.size() ? static_cast<uint8_t>(bytes[i + k]) : 0U);
        for (size_t k = 0; k < 4; ++k)
            text += i + k <= bytes.size() ? letters[three >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

void NumberRuns::add(int64_t value) {
    if (runs_.empty() || runs_.back().value != value) runs_.push_back({value, 0});
    ++runs_.back().count;
}

std::string NumberRuns::json() const {
    std::string text = "[";
    for (const Run& run : runs_)
        fmt::format_to(std::back_inserter(text), "{}{},{}", text.size() > 1 ? "," : "", run.value,
                       run.count);
    return text += ']';
}

std::string number_array(std::span<const int64_t> numbers) {
    std::string text = "[";
    for (const int64_t number : numbers)
        fmt::format_to(std::back_inserter(text), "{}{}", text.size() > 1 ? "," : "", number);
    return text += ']';
}

std::string string_array(std::span<const std::string> texts) {
    std::string json = "[";
    for (const std::string& text : texts)
        (json += json.size() > 1 ? "," : "") += script_string(text);
    return json += ']';
}

int64_t TextTable::index_of(const std::string& text) {
    const auto [at, is_new] = known_.try_emplace(text, static_cast<int64_t>(texts_.size()));
    if (is_new) texts_.push_back(text);
    return at->second;
}

namespace {

/// The nearest whole number that a page holds exactly; 0 for what is not a number.
int64_t whole(double value) {
    constexpr double most = 9007199254740991.0; // 2^53 - 1
    return std::isnan(value) ? 0 : static_cast<int64_t>(std::clamp(value, -most, most));
}

} // namespace

int64_t um_below(double mm) { return whole(core::units_below(mm, 3)); }

int64_t clearance_um(double lower) { return std::max<int64_t>(um_below(lower), 0); }

int64_t um_above(double mm) { return whole(core::units_above(mm, 3)); }

int64_t steps_of(double value, double step) { return whole(core::round(value / step)); }

} // namespace app
