#pragma once

#include <filesystem>

namespace app {

/// The folder of the files that come with this program, where it holds a file with this path:
/// share/feeler of an installed program, or assets of the sources from which it was built. Empty if
/// neither has it.
std::filesystem::path shipped_files_with(const std::filesystem::path& file);

} // namespace app
