#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/sim/finding.h"
#include "gcode/language/dialect.h"

namespace app {

/// Settings for programs in a project file; empty if not stated.
struct ProgramTerms {
    std::string setup; // path of the set-up
    std::optional<gcode::DialectId> dialect;
    std::optional<double> allowance, mesh_size; // mm
    core::RuleSeverities rules;

    bool operator==(const ProgramTerms&) const = default;
};

/// Combines settings; `over` takes precedence.
ProgramTerms overlaid(ProgramTerms terms, const ProgramTerms& over);

/// One `[[program]]` table: files, folders and patterns, and their settings.
struct ProjectEntry {
    std::vector<std::string> files; // as written, relative to the folder of the project file
    ProgramTerms terms;
    uint32_t line = 0;
};

/// A project file: programs, and what each is checked against.
struct Project {
    std::string path;
    ProgramTerms terms; // for all programs
    std::vector<ProjectEntry> entries;
};

/// Reads a project file (TOML). Paths of set-ups become relative to the working folder.
///
/// Errors: with file, line and column: no such file, invalid TOML, an unknown key, a wrong value.
core::Result<Project> read_project(const std::string& path);

/// Finds the project file that applies to a folder.
class ProjectOwners {
public:
    /// The project file in this folder, else in the nearest folder above it, up to `top`; empty
    /// if there is none. A broken link with its name counts.
    std::string of(const std::filesystem::path& folder, const std::filesystem::path& top);

private:
    bool contains_project(const std::filesystem::path& folder);

    std::map<std::string, bool> known_; // whether a folder has a project file
};

} // namespace app
