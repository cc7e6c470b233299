#pragma once

#include <string>
#include <vector>

#include "app/batch/folder_walk.h"

namespace app {

/// What words of a command line, or of a project, stand for.
struct FoundPrograms {
    std::vector<std::string> programs; // in the order of the words, each once
    std::vector<SkippedFile> skipped;  // found, but no NC programs
    std::vector<core::Error> failures; // words that stand for nothing, files that cannot be read
};

/// The programs that words stand for: a file is taken as it is; a folder is searched with all
/// folders in it; a pattern names files. What was searched for is looked into, and skipped when it
/// is no NC program.
FoundPrograms find_programs(const std::vector<std::string>& words);

} // namespace app
