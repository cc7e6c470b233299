#include "core/geom/mesh_words.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace core {
namespace {

constexpr std::string_view blanks = " \t\r\v\f";

template <typename Number>
std::optional<Number> number_of(std::string_view word) {
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    Number value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
    return value;
}

} // namespace

bool LineReader::next(Words& words, char comment) {
    words.clear();
    if (rest_.empty()) return false;
    ++line_;
    const size_t end = rest_.find('\n');
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    line = line.substr(0, line.find(comment));
    for (;;) {
        line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
        if (line.empty()) return true;
        words.push_back(line.substr(0, line.find_first_of(blanks)));
        line.remove_prefix(words.back().size());
    }
}

std::optional<double> coordinate_of(std::string_view word) {
    const auto value = number_of<double>(word);
    if (!value || !(std::abs(*value) <= double{std::numeric_limits<float>::max()}))
        return std::nullopt;
    return value;
}

std::optional<int64_t> integer_of(std::string_view word) { return number_of<int64_t>(word); }

bool equals_ignoring_case(std::string_view a, std::string_view b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
        return std::tolower(static_cast<unsigned char>(x))
               == std::tolower(static_cast<unsigned char>(y));
    });
}

tl::unexpected<Error> fail_in_line(uint32_t line, const std::string& message) {
    return fail(ErrorCode::syntax, fmt::format("line {}: {}", line, message), {.line = line});
}

Result<FloatPoint> append_point(const Words& words, size_t first, uint32_t line,
                                std::string& text) {
    FloatPoint point{};
    for (size_t i = 0; i < 3; ++i) {
        if (first + i >= words.size())
            return fail_in_line(line, fmt::format("a vertex has {} coordinates", i));
        const auto value = coordinate_of(words[first + i]);
        if (!value)
            return fail_in_line(line, fmt::format("'{}' is not a coordinate", words[first + i]));
        point[i] = static_cast<float>(*value);
        text += ' ';
        text += words[first + i].substr(words[first + i].front() == '+' ? 1 : 0);
    }
    text += '\n';
    return point;
}

} // namespace core
