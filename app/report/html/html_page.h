#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "app/report/html/html_text.h"
#include "core/base/text.h"

namespace app {

/// Replacements for the {{name}}s of a page.
using PageValues = std::map<std::string, std::string, std::less<>>;

/// The page with each {{name}} replaced. Inserted text is not scanned for names.
std::string filled_page(std::string_view page, const PageValues& fillings);

/// A statement of a script that lists the names of enumerators in their order, by which the data of
/// the page refers to them: `const verdicts=["clear",...];`.
template <typename Enum, size_t Count>
std::string script_names(std::string_view list, const std::array<Enum, Count>& all) {
    const std::vector<std::string_view> names = core::names_of(all);
    return fmt::format("const {}={};\n", list,
                       string_array(std::vector<std::string>(names.begin(), names.end())));
}

/// The colours of the window as CSS variables, light and dark: `--violation` and so on. The
/// attribute `data-theme` of the page overrides the preference of the browser; printing uses the
/// light colours.
std::string html_palette();

/// The parts of a report page that do not depend on the check.
struct PageAssets {
    std::string_view page;   // with {{name}}s to be replaced
    std::string_view style;  // CSS
    std::string_view script; // all but the 3D view and the names of enumerators
};

/// For one program.
PageAssets page_assets();

/// For many programs.
PageAssets batch_page_assets();

/// The script of the 3D view with its libraries; empty if it could not be bundled when Feeler was
/// built.
std::string_view view_bundle();

} // namespace app
