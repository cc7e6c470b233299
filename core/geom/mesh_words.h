#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace core {

using Words = std::vector<std::string_view>;
using FloatPoint = std::array<float, 3>;

/// Walks through the lines of a text; gives each as its words.
class LineReader {
public:
    explicit LineReader(std::string_view text) : rest_(text) {}

    /// The words of the next line (perhaps none), cut off at `comment`; false at the end.
    bool next(Words& words, char comment);
    uint32_t line() const { return line_; }
    std::string_view rest() const { return rest_; }

private:
    std::string_view rest_;
    uint32_t line_ = 0;
};

/// The word as a finite coordinate that single precision can hold.
std::optional<double> coordinate_of(std::string_view word);
std::optional<int64_t> integer_of(std::string_view word);
bool equals_ignoring_case(std::string_view a, std::string_view b);

/// The error that something is wrong with a line; says its number in the message too.
tl::unexpected<Error> fail_in_line(uint32_t line, const std::string& message);

/// Appends the words `first` .. `first` + 2 to `text` as the coordinates that end a line, and
/// returns them. Errors: name the word that is no coordinate.
Result<FloatPoint> append_point(const Words& words, size_t first, uint32_t line, std::string& text);

} // namespace core
