#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace core {

/// The edit distance of two words: letters to change, insert or delete.
size_t letters_apart(std::string_view a, std::string_view b);

/// The name with the least edit distance, the first of several; empty if `names` is empty.
std::string nearest_name(std::string_view name, const std::vector<std::string>& names);

/// A decimal number without zeros at the end of its fraction: "1.5" for "1.500", "2" for "2.000".
std::string without_trailing_zeros(std::string number);

/// A number rounded to this many decimals, without trailing zeros and never "-0".
std::string number_text(double value, int decimals);

} // namespace core
