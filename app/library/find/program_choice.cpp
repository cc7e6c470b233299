#include "app/library/find/program_choice.h"

#include <filesystem>

#include <fmt/format.h>

namespace app {
namespace {

void take_all(ProgramChoice& choice, const ProgramChoice& other) {
    for (const ChosenProgram& program : other.programs()) choice.add(program);
    for (const SkippedFile& file : other.skipped()) choice.skip(file);
    for (const core::Error& error : other.failures()) choice.fail(error);
}

} // namespace

void ProgramChoice::add(const ChosenProgram& program) {
    const auto [at, is_new] = index_.try_emplace(identities_.of(program.path), programs_.size());
    if (is_new) {
        programs_.push_back(program);
        return;
    }
    ChosenProgram& known = programs_[at->second];
    if (known.named_by_nearest_project && !program.named_by_nearest_project) return;
    if (program.named_by_nearest_project && !known.named_by_nearest_project) {
        known = {known.path, program.general, program.special, true};
        return;
    }
    known.general = overlaid(std::move(known.general), program.general);
    known.special = overlaid(std::move(known.special), program.special);
}

void ProgramChoice::skip(const SkippedFile& file) {
    if (recorded_.insert(identities_.of(file.path)).second) skipped_.push_back(file);
}

void ProgramChoice::fail(const core::Error& error) {
    const std::string text = fmt::format("{}\n{}\n{}", error.file, error.where.line, error.message);
    if (recorded_.insert(text).second) failures_.push_back(error);
}

const ChosenProgram* ProgramChoice::find(const std::string& path) const {
    const auto found = index_.find(identities_.of(path));
    return found == index_.end() ? nullptr : &programs_[found->second];
}

std::vector<SkippedFile> ProgramChoice::skipped() const {
    std::vector<SkippedFile> all;
    for (const SkippedFile& file : skipped_)
        if (!find(file.path)) all.push_back(file);
    return all;
}

void ProgramChooser::add_words(const std::vector<std::string>& words) {
    take(choice_, find_programs(words), {});
}

core::Result<void> ProgramChooser::add_project(const std::string& path) {
    const Chosen chosen = chosen_by(path);
    if (!*chosen) return tl::unexpected(chosen->error());
    take_all(choice_, **chosen);
    return {};
}

/// The choice of a project; null while it is being read, because its own search found it again.
ProgramChooser::Chosen ProgramChooser::chosen_by(const std::string& project) {
    const auto [known, is_new] = projects_.try_emplace(identities_.of(project));
    if (is_new) {
        auto choice = std::make_shared<core::Result<ProgramChoice>>(read_choice(project));
        known->second = std::move(choice);
    }
    return known->second;
}

core::Result<ProgramChoice> ProgramChooser::read_choice(const std::string& path) {
    FEELER_TRY(const Project project, read_project(path));
    ProgramChoice choice;
    for (const ProjectEntry& entry : project.entries) {
        FoundPrograms found = find_programs(entry.files, std::filesystem::path(path).parent_path());
        for (core::Error& error : found.failures)
            error = {error.code,
                     {entry.line, 0, 0},
                     fmt::format("{} {}", error.file, error.message),
                     path};
        take(choice, found, {path, project.terms, entry.terms});
    }
    return choice;
}

void ProgramChooser::take(ProgramChoice& choice, const FoundPrograms& found,
                          const SelectionSource& sayer) {
    for (const core::Error& error : found.failures) choice.fail(error);
    for (const SkippedFile& file : found.skipped) choice.skip(file);
    std::set<std::string> led_to;
    for (const FoundProgram& program : found.programs) {
        if (!program.project.empty()) led_to.insert(program.project);
        add_found(
            choice, program,
            {program.path, sayer.general, sayer.special, is_nearest(sayer.project, program.path)});
    }
    led_to.insert(found.projects.begin(), found.projects.end());
    for (const std::string& project : led_to) {
        const Chosen chosen = chosen_by(project);
        if (chosen && !*chosen) choice.fail(chosen->error());
        if (!chosen || !*chosen) continue;
        for (const core::Error& error : (*chosen)->failures()) choice.fail(error);
    }
    for (const std::string& project : found.projects)
        if (const Chosen chosen = chosen_by(project); chosen && *chosen) take_all(choice, **chosen);
}

bool ProgramChooser::is_nearest(const std::string& project, const std::string& program) {
    if (project.empty()) return false;
    std::error_code ignored;
    const auto folder = std::filesystem::absolute(program, ignored).parent_path();
    const std::string nearest = owners_.of(whole_path(folder, ignored), "/");
    return !nearest.empty() && identities_.of(nearest) == identities_.of(project);
}

/// Adds a found program with the settings of its own project, or skips it if the project does not
/// name it.
void ProgramChooser::add_found(ProgramChoice& choice, const FoundProgram& found,
                               ChosenProgram as_named) {
    const Chosen chosen = found.project.empty() ? nullptr : chosen_by(found.project);
    if (!chosen || found.is_named) choice.add(as_named);
    if (!chosen || !*chosen) return;
    if (const ChosenProgram* program = (*chosen)->find(found.path)) {
        choice.add(
            {found.path, program->general, program->special, program->named_by_nearest_project});
    } else if (!found.is_named) {
        choice.skip(
            {found.path, fmt::format("is not named in any [[program]] of {}", found.project)});
    }
}

} // namespace app
