#pragma once

#include <string>
#include <vector>

namespace app {

/// Whether a word is a pattern of file names: it has `*`, `?` or `[`.
bool is_glob(const std::string& word);

/// The files that a pattern names, sorted. `**` stands for any number of folders, none as well.
/// What begins with a dot is named only by a pattern that begins with one. Links are followed, and
/// below `**` every folder is entered once, so that a loop of links ends.
std::vector<std::string> files_of_glob(const std::string& pattern);

} // namespace app
