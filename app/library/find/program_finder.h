#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/library/find/folder_walk.h"
#include "core/base/result.h"

namespace app {

/// A program that a word stands for.
struct FoundProgram {
    std::string path;
    std::string project;   // the project file that has a say in its folder; empty: nobody's
    bool is_named = false; // by its own name, or by a search that began below the project
};

/// What words of a command line, or of a project, stand for.
struct FoundPrograms {
    std::vector<FoundProgram> programs; // in the order of the words, each once
    std::vector<std::string> projects;  // project files in folders that were searched as a whole
    std::vector<SkippedFile> skipped;   // found, but no NC programs
    std::vector<core::Error> failures;  // words that stand for nothing, files that cannot be read
};

/// The programs that words stand for, relative to a folder (empty: the working folder): a file is
/// taken as it is; a folder is searched with all folders in it; a pattern names files. What was
/// searched for is looked into, and skipped when it is no NC program. It belongs to the nearest
/// project file above it, as far up as the search that reached highest began.
FoundPrograms find_programs(const std::vector<std::string>& words,
                            const std::filesystem::path& folder = {});

/// Why a file that nobody named is not taken for an NC program: "is a mesh"; empty for a program.
///
/// Nobody who listens is told.
///
/// Errors: io when it cannot be read.
/// Cost:   its first 64 KB are read at most; nothing where the name's ending tells.
core::Result<std::optional<std::string>> why_no_program(const std::string& path);

/// The same by the first part of a text alone.
std::optional<std::string> why_no_program_text(std::string_view text);

} // namespace app
