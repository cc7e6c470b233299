#pragma once

#include <string>
#include <string_view>

namespace app {

/// What a block says, whatever its number: without block number, blanks and a comment behind a
/// semicolon, in capitals.
std::string numberless(std::string_view block);

} // namespace app
