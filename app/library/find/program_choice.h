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

/// A program, and what projects say of it.
struct ChosenProgram {
    std::string path;
    ProgramTerms general, special; // what its projects say of all, and of it by their tables
    bool is_at_home = false;       // the nearest project above it says so
};

/// Programs, each once in the order in which they came, whatever the spelling of their paths; the
/// first one stays. Of what several projects say of one the nearest above it counts alone, else
/// what comes later replaces what came before.
class ProgramChoice {
public:
    void add(const ChosenProgram& program);
    void skip(const SkippedFile& file);
    void fail(const core::Error& error);

    const std::vector<ChosenProgram>& programs() const { return programs_; }
    const ChosenProgram* find(const std::string& path) const;

    /// But what came as a program, too.
    std::vector<SkippedFile> skipped() const;
    const std::vector<core::Error>& failures() const { return failures_; }

private:
    std::vector<ChosenProgram> programs_;
    std::vector<SkippedFile> skipped_;
    std::vector<core::Error> failures_;
    std::map<std::string, size_t> places_; // of programs
    std::set<std::string> told_;           // of skipped files and failures
    mutable FileIdentities identities_;
};

/// Chooses programs by words of a command line and by projects, also by those that words lead to.
class Chooser {
public:
    void take_words(const std::vector<std::string>& words);

    /// Errors: those of read_project.
    core::Result<void> take_project(const std::string& path);

    ProgramChoice finish() && { return std::move(choice_); }

private:
    using Chosen = std::shared_ptr<const core::Result<ProgramChoice>>;

    Chosen chosen_by(const std::string& project);
    core::Result<ProgramChoice> read_choice(const std::string& project);
    /// Who names programs: a project by one of its tables, or nobody.
    struct Sayer {
        std::string project;
        ProgramTerms general, special;
    };

    void take(ProgramChoice& choice, const FoundPrograms& found, const Sayer& sayer);
    bool is_nearest(const std::string& project, const std::string& program);
    void take_found(ProgramChoice& choice, const FoundProgram& found, ChosenProgram as_named);

    ProgramChoice choice_;
    std::map<std::string, Chosen> projects_; // empty while one is being read
    FileIdentities identities_;
    ProjectOwners owners_;
};

} // namespace app
