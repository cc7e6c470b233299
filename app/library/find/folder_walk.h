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

/// What a search in folders found.
struct FolderWalk {
    std::vector<std::string> files;             // sorted; regular ones, also by links
    std::vector<SkippedFile> skipped;           // that are no files, as broken links and pipes
    std::vector<core::Error> unreadable;        // folders, and what cannot be looked at
    std::vector<std::filesystem::path> folders; // that were entered, sorted

    /// Takes in what has a name: a file, or why it is none; folders are left to the caller. Tells
    /// of a look at what is no file: it may become one.
    void sort_in(const std::filesystem::path& path);
};

/// That a folder could not be searched.
core::Error unreadable_folder(const std::filesystem::path& folder, const std::error_code& failure);

/// What is in a folder and in those below it, without what begins with a dot. Links to folders are
/// followed once: a folder that was seen, by device and number, is not entered again. Real folders
/// come before links to them.
FolderWalk walk_folder(const std::string& folder);

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
