#pragma once

#include <string>

namespace app {

/// The SHA-256 of a file's bytes as 64 hexadecimal digits; empty when it cannot be read.
std::string sha256_of_file(const std::string& path);

} // namespace app
