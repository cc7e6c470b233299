#pragma once

#include <string>
#include <vector>

namespace app {

/// The folders in a list that ':' separates.
std::vector<std::string> split_search_path(const std::string& text);

} // namespace app
