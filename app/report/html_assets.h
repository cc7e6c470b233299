#pragma once

#include <string_view>

namespace app {

/// The parts of the page of a report that are the same for all reports of a kind.
struct PageAssets {
    std::string_view page;   // with {{name}} where something is filled in
    std::string_view style;  // CSS
    std::string_view script; // what the page does, but for its 3D view
};

/// Of one program.
PageAssets page_assets();

/// Of many programs.
PageAssets batch_page_assets();

/// The script of the 3D view with all that it needs; empty if it could not be made when the program
/// was built.
std::string_view view_bundle();

} // namespace app
