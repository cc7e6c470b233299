#pragma once

#include <filesystem>

namespace app {

/// Where a file is, or will be once it is written: whole, behind all links. Empty where nobody can
/// know, as behind a loop of links.
std::filesystem::path place_of(const std::filesystem::path& path);

} // namespace app
