#include "app/library/find/project_file.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/base/file_stamp.h"
#include "app/setup/coverage.h"
#include "app/setup/program_settings.h"
#include "app/setup/setup_file.h"
#include "app/setup/table_reader.h"
#include "app/setup/toml_file.h"
#include "core/base/file_reads.h"
#include "core/sim/clearance.h"

namespace app {
namespace {

/// Reads the keys that are allowed both in `[[program]]` and at the top level.
ProgramTerms read_terms(TableReader& table, const std::filesystem::path& folder) {
    ProgramTerms terms;
    if (const auto setup = table.string("setup")) {
        if (setup->empty()) table.refuse("setup", "must name a file");
        terms.setup = plain_path(folder / *setup);
    }
    terms.dialect = read_dialect(table);
    terms.allowance = table.number("allowance", Measure::length);
    if (terms.allowance
        && !(*terms.allowance >= 0.0 && *terms.allowance <= core::largest_allowance))
        table.refuse("allowance", "must be between 0 and 1000 mm");
    terms.mesh_size = table.number("mesh_size", Measure::length);
    if (terms.mesh_size && !(*terms.mesh_size > 0.0)) table.refuse("mesh_size", "must be above 0");
    if (auto rules = table.table("rules", table.name() + " rules"))
        terms.rules = read_severities(*rules);
    for (const std::string& word :
         table.strings("require", 0).value_or(std::vector<std::string>{})) {
        const auto& words = required_words;
        if (std::find(words.begin(), words.end(), word) == words.end())
            table.refuse("require",
                         fmt::format("\"{}\" is not one of: {}", word, fmt::join(words, ", ")));
        else
            terms.rules[required_rule(word)] = core::Severity::error;
    }
    return terms;
}

std::vector<std::string> read_files(TableReader& table) {
    std::vector<std::string> names;
    if (table.is_list("files"))
        names = table.strings("files", 0).value_or(std::vector<std::string>{});
    else if (const auto name = table.string("files"))
        names = {*name};
    const bool has_blank = std::find(names.begin(), names.end(), "") != names.end();
    if (has_blank || (names.empty() && table.has("files")))
        table.refuse("files", "must name a file; \".\" is the folder of the project");
    return names;
}

void read_root(TableReader& root, const std::filesystem::path& folder, Project& project) {
    project.terms = read_terms(root, folder);
    for (TableReader& table : root.tables("program", "[[program]]")) {
        ProjectEntry entry{read_files(table), read_terms(table, folder), table.line()};
        table.finish(); // before need(): calls a misspelt `file` unknown, not `files` missing
        if (entry.files.empty()) table.need("files");
        project.entries.push_back(std::move(entry));
    }
    if (project.entries.empty()) root.need("[[program]]");
    root.finish();
}

} // namespace

ProgramTerms overlaid(ProgramTerms terms, const ProgramTerms& over) {
    if (!over.setup.empty()) terms.setup = over.setup;
    if (over.dialect) terms.dialect = over.dialect;
    if (over.allowance) terms.allowance = over.allowance;
    if (over.mesh_size) terms.mesh_size = over.mesh_size;
    for (const auto& [rule, severity] : over.rules) terms.rules[rule] = severity;
    return terms;
}

core::Result<Project> read_project(const std::string& path) {
    Project project{.path = path, .terms = {}, .entries = {}};
    std::optional<core::Error> error;
    const auto parsed = read_toml(path);
    if (parsed) {
        TableReader root(*parsed, "project", error);
        read_root(root, std::filesystem::path(path).parent_path(), project);
    } else {
        error = parsed.error();
    }
    if (!error) return project;
    if (error->file.empty()) error->file = path;
    return tl::unexpected(*error);
}

std::string ProjectOwners::of(const std::filesystem::path& folder,
                              const std::filesystem::path& top) {
    std::filesystem::path here = folder;
    while (!contains_project(here)) {
        const std::filesystem::path above = here.parent_path();
        if (here == top || above == here) return {};
        here = above;
    }
    return (here / project_file_name).generic_string();
}

bool ProjectOwners::contains_project(const std::filesystem::path& folder) {
    const auto [known, is_new] = known_.try_emplace(folder.generic_string());
    if (is_new) known->second = core::is_there(folder / project_file_name);
    return known->second;
}

} // namespace app
