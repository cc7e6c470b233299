#include "app/viewer/row_filter.h"

#include <algorithm>
#include <cctype>
#include <charconv>

namespace app::viewer {
namespace {

std::string small_letters(std::string_view text) {
    std::string small(text);
    for (char& c : small) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return small;
}

std::optional<double> number_in(std::string_view text) {
    double value = 0.0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failure != std::errc() || end != text.data() + text.size()) return {};
    return value;
}

bool compares(double a, std::string_view sign, double b) {
    if (sign == "<") return a < b;
    if (sign == "<=") return a <= b;
    if (sign == ">") return a > b;
    return a >= b;
}

/// What `clr<1` says of a row; empty when the word is no comparison of clearances.
std::optional<bool> comparison(std::string_view word, const BlockRow& row) {
    for (const std::string_view name : {"clearance", "clr"}) {
        if (!word.starts_with(name)) continue;
        word.remove_prefix(name.size());
        size_t signs = 0;
        while (signs < word.size()
               && (word[signs] == '<' || word[signs] == '>' || word[signs] == '='))
            ++signs;
        const auto limit = number_in(word.substr(signs));
        if (signs == 0 || !limit || word[0] == '=') return {};
        if (!row.lower) return false;
        return compares(*row.lower, word.substr(0, signs), *limit);
    }
    return {};
}

std::optional<bool> state(std::string_view word, const BlockRow& row) {
    if (word == "violation") return is_offending(row);
    if (word == "near") return is_near(row);
    if (word == "finding") return row.worst >= core::Severity::warning;
    if (word == "undecided") return row.verdict == core::Verdict::undecided;
    if (word == "clear") return row.is_known && moves(row) && !is_offending(row) && !is_near(row);
    for (const auto motion : {core::BlockMotion::rapid, core::BlockMotion::feed,
                              core::BlockMotion::arc, core::BlockMotion::cycle})
        if (word == core::name_of(motion)) return row.motion == motion;
    return {};
}

std::optional<bool> tool(std::string_view word, const BlockRow& row) {
    if (word.size() < 2 || word[0] != 't') return {};
    const auto number = number_in(word.substr(1));
    if (!number) return {};
    return row.tool && core::value_of(*row.tool) == static_cast<int32_t>(*number);
}

bool is_in(std::string_view word, const BlockRow& row) {
    for (const std::string& text : {row.text, row.part, row.body})
        if (small_letters(text).find(word) != std::string::npos) return true;
    return false;
}

bool is_true(std::string_view word, const BlockRow& row) {
    if (const auto said = comparison(word, row)) return *said;
    if (const auto said = state(word, row)) return *said;
    if (const auto said = tool(word, row)) return *said;
    return is_in(word, row);
}

} // namespace

RowFilter::RowFilter(std::string_view text) {
    std::string word;
    for (const char c : small_letters(text) + ' ') {
        if (c != ' ') {
            word += c;
            continue;
        }
        if (!word.empty() && word != "and") words_.push_back(word);
        word.clear();
    }
}

bool RowFilter::holds(const BlockRow& row) const {
    return std::all_of(words_.begin(), words_.end(),
                       [&](const std::string& word) { return is_true(word, row); });
}

} // namespace app::viewer
