#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace core {

/// A letter in upper or lower case. Only the letters A to Z change, whatever the locale.
constexpr char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }
constexpr char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// A text in upper or lower case, letter by letter.
std::string upper_case(std::string_view text);
std::string lower_case(std::string_view text);

/// The text without blanks and tabs at its ends.
std::string_view stripped(std::string_view text);

/// The edit distance of two words: letters to change, insert or delete.
size_t edit_distance(std::string_view a, std::string_view b);

/// The name with the least edit distance, the first of several; empty if `names` is empty.
std::string nearest_name(std::string_view name, const std::vector<std::string>& names);

/// A decimal number without zeros at the end of its fraction: "1.5" for "1.500", "2" for "2.000".
std::string without_trailing_zeros(std::string number);

/// A number rounded to this many decimals, without trailing zeros and never "-0".
std::string number_text(double value, int decimals);

/// Appends number_text(value, decimals).
///
/// Cost:    some 15 ns for usual coordinates.
void append_number(std::string& text, double value, int decimals);

/// The names of enumerators, in their order, as `name_of` gives them.
template <typename Enum, size_t Count>
std::vector<std::string_view> names_of(const std::array<Enum, Count>& all) {
    std::vector<std::string_view> names;
    for (const Enum each : all) names.emplace_back(name_of(each));
    return names;
}

/// The enumerator with this name; empty if there is none.
template <typename Enum, size_t Count>
std::optional<Enum> find_named(const std::array<Enum, Count>& all, std::string_view name) {
    const auto found =
        std::find_if(all.begin(), all.end(), [&](Enum each) { return name == name_of(each); });
    return found == all.end() ? std::nullopt : std::optional(*found);
}

} // namespace core
