#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace app {

/// A file or folder that was passed over, and why: as it ends "skipped: FILE: ...".
struct SkippedFile {
    std::string path, why;

    bool operator==(const SkippedFile&) const = default;
};

/// What is in a folder and in those below it, without what begins with a dot.
struct FolderWalk {
    std::vector<std::string> files;      // sorted; regular ones, also by links
    std::vector<SkippedFile> skipped;    // that are no files, as broken links and pipes
    std::vector<core::Error> unreadable; // folders
};

/// Links to folders are followed once: a folder that was seen, by device and number, is not entered
/// again. Real folders come before links to them.
FolderWalk walk_folder(const std::string& folder);

/// The folders below one, each once, as walk_folder enters them.
std::vector<std::filesystem::path> folders_below(const std::filesystem::path& folder);

} // namespace app
