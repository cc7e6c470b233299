#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace core {

/// The edit distance of two words: letters to change, insert or delete.
size_t letters_apart(std::string_view a, std::string_view b);

/// The name with the least edit distance, the first of several; empty if `names` is empty.
std::string nearest_name(std::string_view name, const std::vector<std::string>& names);

} // namespace core
