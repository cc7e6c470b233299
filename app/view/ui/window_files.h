#pragma once

#include <filesystem>
#include <optional>

#include "app/check/saved_setup.h"
#include "app/view/model/view_model.h"

namespace app::viewer {

/// Errors: io.
core::Result<std::string> read_text(const std::filesystem::path& path);

/// What is to be checked once files were dropped into the window: a program, a set-up, or both.
/// Another program comes without the set-up and the breakpoints of the one before. Empty when there
/// is nothing to be opened, of which a sentence tells.
std::optional<CheckJob> with_dropped(CheckJob check, const std::vector<std::string>& paths,
                                     ViewModel& model, double now);

/// Keeps the notes of the program that is open, and takes in those that others have kept of theirs.
void keep_notes(ViewModel& model, const std::filesystem::path& path, const FileWriter& write,
                double now);

} // namespace app::viewer
