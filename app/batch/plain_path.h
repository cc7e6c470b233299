#pragma once

#include <filesystem>
#include <string>

namespace app {

/// A path without the parts that lead nowhere: `./a//b` is `a/b`. Unlike lexically_normal it leaves
/// `..`, as `link/..` is not the folder of the link.
std::string plain_path(const std::filesystem::path& path);

} // namespace app
