#pragma once

#include <map>
#include <string>
#include <string_view>

namespace app {

/// What stands where in a page, by the names in its {{name}}s.
using PageFillings = std::map<std::string, std::string, std::less<>>;

/// The page with each {{name}} replaced. What is filled in is not looked at again.
std::string filled_page(std::string_view page, const PageFillings& fillings);

/// The colours of the window as variables of a style sheet, light and dark: `--violation` and so
/// on. The attribute `data-theme` of the page counts before what the browser prefers; paper is
/// light.
std::string html_palette();

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
