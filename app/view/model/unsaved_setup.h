#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "app/setup/setup_document.h"
#include "app/view/model/workspace.h"

namespace app::viewer {

/// The text of a file that keeps an unsaved set-up: comments, then the set-up.
std::string text_of(const UnsavedSetup& unsaved);
/// Empty if the text is not from text_of().
std::optional<UnsavedSetup> unsaved_in(const std::string& text);

/// The files that keep unsaved set-ups, one for each program and set-up.
class UnsavedSetups {
public:
    UnsavedSetups() = default;
    /// `folder`: where they are kept; empty: nowhere.
    UnsavedSetups(std::filesystem::path folder, FileWriter write)
        : folder_(std::move(folder)), write_(std::move(write)) {}

    /// Keeps a text, with what was in the file when it was edited. Errors are ignored: the user can
    /// still save.
    void keep(const std::string& program, const std::string& setup, const std::string& text,
              const std::string& saved) const;
    void forget(const std::string& program, const std::string& setup) const;
    /// What is kept of this program and set-up, unless it is the text in the file.
    std::optional<UnsavedSetup> find(const std::string& program, const std::string& setup,
                                     const std::string& saved) const;

private:
    std::filesystem::path file_of(const std::string& program, const std::string& setup) const;

    std::filesystem::path folder_;
    FileWriter write_;
};

} // namespace app::viewer
