#pragma once

#include <string>
#include <vector>

namespace app::viewer {

struct TabTitle;
struct ViewModel;

/// The titles of the open programs, as tabs show them. Programs of the same name are told apart by
/// their folders.
std::vector<TabTitle> tab_titles(const std::vector<const ViewModel*>& programs);

/// Shows `to` in place of `from`: settings, files and comments belong to the window and move along.
void show_in_place(ViewModel& to, ViewModel& from);

} // namespace app::viewer
