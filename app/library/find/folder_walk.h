#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace app {

/// A file or folder that was skipped, and the reason, as in "skipped: FILE: is a mesh".
struct SkippedFile {
    std::string path, why;

    bool operator==(const SkippedFile&) const = default;
};

/// What a search in folders found.
struct FolderWalk {
    std::vector<std::string> files;             // sorted; regular files and links to them
    std::vector<SkippedFile> skipped;           // not regular files: broken links, pipes ...
    std::vector<core::Error> unreadable;        // folders and files
    std::vector<std::filesystem::path> folders; // searched, sorted

    /// Adds a path as a file or as skipped; ignores folders. Reports the access to a path that is
    /// not a file, because it may become one.
    void sort_in(const std::filesystem::path& path);
};

/// The error for a folder that could not be searched.
core::Error unreadable_folder(const std::filesystem::path& folder, const std::error_code& failure);

/// The contents of a folder and its subfolders, except names that begin with a dot. A folder,
/// identified by device and inode, is entered once; real folders come before links to them.
FolderWalk walk_folder(const std::string& folder);

/// Whether a word is a pattern of file names: contains `*`, `?` or `[`.
bool is_glob(const std::string& word);

/// The files in a folder that match a pattern, sorted, and what was skipped or could not be read.
/// The name of the folder is taken literally; empty means the working folder. `**` matches any
/// number of folders, including none. A name that begins with a dot is matched only by a pattern
/// that begins with a dot. Links are followed; below `**` each folder is entered once, so loops of
/// links end.
FolderWalk files_of_glob(const std::filesystem::path& folder, const std::string& pattern);

/// The folder where the search for a pattern begins: the parts before the first wildcard.
std::filesystem::path folder_of_glob(const std::filesystem::path& folder,
                                     const std::string& pattern);

} // namespace app
