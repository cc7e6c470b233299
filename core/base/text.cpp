#include "core/base/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <utility>

#include <fmt/format.h>

namespace core {

std::string upper_case(std::string_view text) {
    std::string result(text);
    for (char& c : result) c = upper(c);
    return result;
}

std::string lower_case(std::string_view text) {
    std::string result(text);
    for (char& c : result) c = lower(c);
    return result;
}

std::string_view stripped(std::string_view text) {
    const size_t first = text.find_first_not_of(" \t");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), size_t{0});
    for (size_t i = 0; i < a.size(); ++i) {
        size_t diagonal = std::exchange(row[0], i + 1);
        for (size_t j = 0; j < b.size(); ++j) {
            const size_t changed = diagonal + (a[i] == b[j] ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({changed, diagonal + 1, row[j] + 1});
        }
    }
    return row.back();
}

std::string nearest_name(std::string_view name, const std::vector<std::string>& names) {
    const auto nearest = std::min_element(names.begin(), names.end(), [&](auto& a, auto& b) {
        return edit_distance(name, a) < edit_distance(name, b);
    });
    return nearest == names.end() ? std::string() : *nearest;
}

std::string without_trailing_zeros(std::string number) {
    if (number.find('.') == std::string::npos) return number;
    number.erase(number.find_last_not_of('0') + 1);
    if (number.back() == '.') number.pop_back();
    return number;
}

namespace {

/// The value in units of its last decimal, rounded to the nearest, if that is certain: it is not
/// where the value is large, or half way between two such units up to rounding.
std::optional<int64_t> in_last_decimals(double value, int64_t per_unit) {
    constexpr double most = 1e12; // the product's error is below 1e-4
    const double scaled = value * static_cast<double>(per_unit);
    if (!(std::abs(scaled) < most)) return std::nullopt;
    const double rounded = std::nearbyint(scaled);
    if (std::abs(scaled - rounded) > 0.499) return std::nullopt;
    return static_cast<int64_t>(rounded);
}

} // namespace

void append_number(std::string& text, double value, int decimals) {
    constexpr std::array<int64_t, 10> powers = {
        1, 10, 100, 1000, 10'000, 100'000, 1'000'000, 10'000'000, 100'000'000, 1'000'000'000};
    const auto places = static_cast<size_t>(decimals);
    const auto units =
        places < powers.size() ? in_last_decimals(value, powers[places]) : std::nullopt;
    if (!units) {
        const std::string all = without_trailing_zeros(fmt::format("{:.{}f}", value, decimals));
        text += all == "-0" ? "0" : all;
        return;
    }
    if (*units < 0) text += '-';
    const int64_t size = std::abs(*units);
    text += fmt::format_int(size / powers[places]).c_str();
    int64_t fraction = size % powers[places];
    if (fraction == 0) return;
    text += '.';
    for (size_t left = places; fraction != 0 && left > 0;) {
        --left;
        text += static_cast<char>('0' + fraction / powers[left]);
        fraction %= powers[left];
    }
}

std::string number_text(double value, int decimals) {
    std::string text;
    append_number(text, value, decimals);
    return text;
}

} // namespace core
