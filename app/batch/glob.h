#pragma once

#include <filesystem>
#include <string>

#include "app/batch/folder_walk.h"

namespace app {

/// Whether a word is a pattern of file names: it has `*`, `?` or `[`.
bool is_glob(const std::string& word);

/// The files that a pattern in a folder names, sorted, and what on the way could be no file, or not
/// be read. The folder itself is no pattern, whatever its name; empty for the working folder. `**`
/// stands for any number of folders, none as well. What begins with a dot is named only by a
/// pattern that begins with one. Links are followed, and below `**` every folder is entered once,
/// so that a loop of links ends.
FolderWalk files_of_glob(const std::filesystem::path& folder, const std::string& pattern);

/// The folder in which a pattern begins to search: its parts before the first with a sign.
std::filesystem::path folder_of_glob(const std::filesystem::path& folder,
                                     const std::string& pattern);

} // namespace app
