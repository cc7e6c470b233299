#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/library/find/folder_walk.h"
#include "core/base/result.h"

namespace app {

/// A program found for an argument of the command line.
struct FoundProgram {
    std::string path;
    std::string project;   // the project file that applies to its folder; empty: none
    bool is_named = false; // by its own path, or by a search that began below the project
};

/// The programs found for arguments of a command line or entries of a project file.
struct FoundPrograms {
    std::vector<FoundProgram> programs; // in the order of the arguments, each once
    std::vector<std::string> projects;  // project files in folders that were searched as a whole
    std::vector<SkippedFile> skipped;   // found, but not NC programs
    std::vector<core::Error> failures;  // arguments without a match, files that cannot be read
};

/// Finds programs for arguments, relative to a folder (empty: the working folder). A file is always
/// accepted, a folder is searched with its subfolders, and a pattern matches files. Files found by
/// a search are read and skipped if they are not NC programs. A found program belongs to the
/// nearest project file above it, up to the folder where the search began.
FoundPrograms find_programs(const std::vector<std::string>& words,
                            const std::filesystem::path& folder = {});

/// Why a file that was found by a search is not an NC program, such as "is a mesh"; empty for a
/// program. The access is not reported to a FileAccessObserver.
///
/// Errors: io if it cannot be read.
/// Cost:   reads at most the first 64 KB; nothing if the extension decides.
core::Result<std::optional<std::string>> why_no_program(const std::string& path);

/// What a file is whose extension NC programs never have, such as "is a mesh"; empty otherwise.
std::string foreign_kind(const std::string& path);

/// As why_no_program, for the beginning of a text.
std::optional<std::string> why_no_program_text(std::string_view text);

} // namespace app
