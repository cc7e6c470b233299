#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "app/base/file_stamp.h"
#include "app/library/find/folder_walk.h"
#include "app/library/find/program_finder.h"
#include "app/library/find/project_file.h"

namespace app {

/// A program and the settings that project files give it.
struct ChosenProgram {
    std::string path;
    ProgramTerms general, special; // `general`: for all programs; `special`: from tables naming it
    bool named_by_nearest_project = false; // named by the nearest project file above it
};

/// Programs in the order of their first addition, each once however its path is written. If several
/// projects name a program, the nearest project above it decides, otherwise the last one.
class ProgramChoice {
public:
    void add(const ChosenProgram& program);
    void skip(const SkippedFile& file);
    void fail(const core::Error& error);

    const std::vector<ChosenProgram>& programs() const { return programs_; }
    const ChosenProgram* find(const std::string& path) const;

    /// The skipped files, except those that were also added as programs.
    std::vector<SkippedFile> skipped() const;
    const std::vector<core::Error>& failures() const { return failures_; }

private:
    std::vector<ChosenProgram> programs_;
    std::vector<SkippedFile> skipped_;
    std::vector<core::Error> failures_;
    std::map<std::string, size_t> index_; // index in programs_, by file identity
    std::set<std::string> recorded_;      // skipped files and failures already recorded
    mutable FileIdentities identities_;
};

/// Chooses programs from arguments of a command line and from project files, including project
/// files found in the folders that arguments name.
class ProgramChooser {
public:
    void add_words(const std::vector<std::string>& words);

    /// Errors: those of read_project.
    core::Result<void> add_project(const std::string& path);

    ProgramChoice finish() && { return std::move(choice_); }

private:
    using Chosen = std::shared_ptr<const core::Result<ProgramChoice>>;

    Chosen chosen_by(const std::string& project);
    core::Result<ProgramChoice> read_choice(const std::string& project);
    /// The project and table that name programs; an empty project if the command line does.
    struct SelectionSource {
        std::string project;
        ProgramTerms general, special;
    };

    void take(ProgramChoice& choice, const FoundPrograms& found, const SelectionSource& sayer);
    bool is_nearest(const std::string& project, const std::string& program);
    void add_found(ProgramChoice& choice, const FoundProgram& found, ChosenProgram as_named);

    ProgramChoice choice_;
    std::map<std::string, Chosen> projects_; // null while the project is being read
    FileIdentities identities_;
    ProjectOwners owners_;
};

} // namespace app
