#pragma once

#include <string>
#include <string_view>

namespace app {

/// The text of a block without its number and blanks, in capitals: they mean nothing.
std::string without_number(std::string_view block);

/// What a block says, whatever its number: the same without a comment behind a semicolon.
std::string numberless(std::string_view block);

} // namespace app
