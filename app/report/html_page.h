#pragma once

#include <map>
#include <string>
#include <string_view>

namespace app {

/// What stands where in a page, by the names in its {{name}}s.
using PageFillings = std::map<std::string, std::string, std::less<>>;

/// The page with each {{name}} replaced. What is filled in is not looked at again.
std::string filled_page(std::string_view page, const PageFillings& fillings);

} // namespace app
