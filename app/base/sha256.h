#pragma once

#include <string>
#include <string_view>

namespace app {

/// The SHA-256 of bytes as 64 hexadecimal digits.
std::string sha256_of(std::string_view bytes);

/// The SHA-256 of a file; empty if it cannot be read or is a pipe.
std::string sha256_of_file(const std::string& path);

} // namespace app
