#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/setup/setup_document.h"
#include "app/view/model/workspace.h"
#include "core/base/platform.h"

namespace app::viewer {

/// The text of a file that keeps an unsaved set-up: comments, then the set-up.
std::string text_of(const UnsavedSetup& unsaved);
/// Empty if the text is not from text_of().
std::optional<UnsavedSetup> unsaved_in(const std::string& text);

/// The files that keep unsaved set-ups, one for each program, set-up and session.
class UnsavedSetups {
public:
    UnsavedSetups() = default;
    /// `folder`: where they are kept; empty: nowhere.
    UnsavedSetups(std::filesystem::path folder, FileWriter write)
        : folder_(std::move(folder)), write_(std::move(write)) {}

    /// A file for the edits of a session, which no other session takes.
    struct File {
        std::filesystem::path path;
        std::optional<core::platform::FileLock> lock;
    };
    File free_file(const std::string& program, const std::string& setup) const;
    /// Keeps a text in a file, with what was in the set-up when it was edited. False if that is not
    /// possible: the user can still save.
    bool keep(const std::filesystem::path& file, const std::string& program,
              const std::string& setup, const std::string& text, const std::string& saved) const;
    static void forget(const std::filesystem::path& file);
    /// What sessions that have ended kept of this program and set-up, the latest last, without
    /// texts equal to the one in the file.
    std::vector<UnsavedSetup> find(const std::string& program, const std::string& setup,
                                   const std::string& saved) const;

private:
    std::filesystem::path file_of(const std::string& program, const std::string& setup,
                                  int number) const;

    std::filesystem::path folder_;
    FileWriter write_;
};

} // namespace app::viewer
