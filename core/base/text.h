#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace core {

/// How many letters must be changed, put in or left out to make one word from the other.
size_t letters_apart(std::string_view a, std::string_view b);

/// The name that takes the fewest letters to make it from this one, the first of several; empty
/// when there are no names.
std::string nearest_name(std::string_view name, const std::vector<std::string>& names);

} // namespace core
