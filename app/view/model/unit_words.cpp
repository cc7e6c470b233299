#include "app/view/model/unit_words.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "app/view/model/view_model.h"
#include "core/base/units.h"

namespace app::viewer {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

/// A decimal number in a text, without an exponent.
struct NumberAt {
    size_t begin = 0, end = 0;
    size_t decimals = 0;
};

/// The number that begins at a position, with its sign.
std::optional<NumberAt> number_at(std::string_view text, size_t begin) {
    NumberAt number{begin, begin};
    if (number.end < text.size() && (text[number.end] == '-' || text[number.end] == '+'))
        ++number.end;
    const size_t first = number.end;
    while (number.end < text.size() && is_digit(text[number.end])) ++number.end;
    if (number.end == first) return {};
    if (number.end + 1 < text.size() && text[number.end] == '.' && is_digit(text[number.end + 1])) {
        const size_t point = number.end++;
        while (number.end < text.size() && is_digit(text[number.end])) ++number.end;
        number.decimals = number.end - point - 1;
    }
    return number;
}

/// Whether a number may begin here: not within a name, a word of NC code or another number.
bool may_begin(std::string_view text, size_t at) {
    if (at == 0) return true;
    const char before = text[at - 1];
    return !is_digit(before) && !is_letter(before) && before != '.' && before != '#'
           && before != '_' && before != '-' && before != '+';
}

/// The text between two numbers of a list, if it is one.
std::optional<size_t> after_separator(std::string_view text, size_t at) {
    for (const std::string_view separator :
         {" to ", " x ", " and ", " or ", ", ", " \xE2\x80\xA6 "})
        if (text.substr(at).starts_with(separator)) return at + separator.size();
    return {};
}

/// Whether a unit of length or speed stands here: "mm", not "mm2" or "mm3".
bool has_unit(std::string_view text, size_t at) {
    if (!text.substr(at).starts_with(" mm")) return false;
    return at + 3 == text.size() || (!is_digit(text[at + 3]) && !is_letter(text[at + 3]));
}

/// The numbers from a position on that share one unit; empty if there is none.
std::vector<NumberAt> lengths_from(std::string_view text, size_t at) {
    std::vector<NumberAt> numbers;
    while (const auto number = number_at(text, at)) {
        numbers.push_back(*number);
        if (has_unit(text, number->end)) return numbers;
        const auto next = after_separator(text, number->end);
        if (!next) break;
        at = *next;
    }
    return {};
}

std::string in_inch(std::string_view text, const NumberAt& number) {
    const size_t begin = number.begin + (text[number.begin] == '+' ? 1 : 0);
    double mm = 0.0;
    std::from_chars(text.data() + begin, text.data() + number.end, mm);
    const double value = mm / core::mm_per_inch;
    const size_t decimals = std::min<size_t>(number.decimals + 2, 9);
    return fmt::format("{}{:.{}f}", begin > number.begin ? "+" : "", value == 0.0 ? 0.0 : value,
                       decimals);
}

} // namespace

std::string words_in_unit(const ViewModel& model, const std::string& words) {
    if (!model.settings.inch) return words;
    const std::string_view text = words;
    std::string changed;
    for (size_t at = 0; at < text.size();) {
        const std::vector<NumberAt> numbers =
            may_begin(text, at) ? lengths_from(text, at) : std::vector<NumberAt>();
        if (numbers.empty()) {
            changed += text[at++];
            continue;
        }
        for (const NumberAt& number : numbers) {
            changed += text.substr(at, number.begin - at);
            changed += in_inch(text, number);
            at = number.end;
        }
        changed += " in";
        at += 3; // " mm"
    }
    return changed;
}

std::string positions_in_unit(const ViewModel& model, const std::string& words) {
    if (!model.settings.inch) return words;
    constexpr std::string_view linear = "XYZUVW";
    const std::string_view text = words;
    std::string changed;
    for (size_t at = 0; at < text.size();) {
        changed += text[at++];
        const bool is_axis =
            linear.find(text[at - 1]) != std::string_view::npos && (at < 2 || text[at - 2] == ' ');
        const auto number = is_axis ? number_at(text, at) : std::nullopt;
        if (!number) continue;
        changed += in_inch(text, *number);
        at = number->end;
    }
    return changed;
}

} // namespace app::viewer
