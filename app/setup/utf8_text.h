#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace app {

/// A text in UTF-8. Programs and names of files hold bytes of any code page: what is no UTF-8 is
/// taken for Latin-1. What is UTF-8 stays as it is.
std::string utf8_text(std::string_view text);

/// How many characters it has then.
size_t characters_in(std::string_view text);

} // namespace app
