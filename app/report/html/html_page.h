#pragma once

#include <map>
#include <string>
#include <string_view>

namespace app {

/// Replacements for the {{name}}s of a page.
using PageFillings = std::map<std::string, std::string, std::less<>>;

/// The page with each {{name}} replaced. Inserted text is not scanned for names.
std::string filled_page(std::string_view page, const PageFillings& fillings);

/// The colours of the window as CSS variables, light and dark: `--violation` and so on. The
/// attribute `data-theme` of the page overrides the preference of the browser; printing uses the
/// light colours.
std::string html_palette();

/// The parts of a report page that do not depend on the check.
struct PageAssets {
    std::string_view page;   // with {{name}}s to be replaced
    std::string_view style;  // CSS
    std::string_view script; // all but the 3D view
};

/// For one program.
PageAssets page_assets();

/// For many programs.
PageAssets batch_page_assets();

/// The script of the 3D view with its libraries; empty if it could not be bundled when Feeler was
/// built.
std::string_view view_bundle();

} // namespace app
