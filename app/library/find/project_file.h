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

/// What a project says of programs; empty where it says nothing.
struct ProgramTerms {
    std::string setup; // its path
    std::optional<gcode::DialectId> dialect;
    std::optional<double> allowance, mesh_size; // mm
    core::RuleSeverities rules;

    bool operator==(const ProgramTerms&) const = default;
};

/// Both together; what `over` says wins.
ProgramTerms overlaid(ProgramTerms terms, const ProgramTerms& over);

/// One `[[program]]`: files, folders and patterns, and what counts for them.
struct ProjectEntry {
    std::vector<std::string> files; // as the project has them, relative to its folder
    ProgramTerms terms;
    uint32_t line = 0;
};

/// A shop's programs, each with what it is checked against.
struct Project {
    std::string path;
    ProgramTerms terms; // of all programs
    std::vector<ProjectEntry> entries;
};

/// Reads a project file (TOML). The paths of set-ups come out relative to the working folder.
///
/// Errors: with file, line and column: no file, no TOML, an unknown key, a wrong value.
core::Result<Project> read_project(const std::string& path);

/// Finds the project that has a say in a folder.
class ProjectOwners {
public:
    /// The project file in this folder, else in the nearest above it, no higher than `top`; empty
    /// when there is none. What has its name counts, be it a link that leads nowhere.
    std::string of(const std::filesystem::path& folder, const std::filesystem::path& top);

private:
    bool holds_project(const std::filesystem::path& folder);

    std::map<std::string, bool> known_; // folders
};

} // namespace app
