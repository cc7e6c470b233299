#pragma once

#include <string>

namespace app {

/// The colours of the window as variables of a style sheet, light and dark: `--violation` and so
/// on. The attribute `data-theme` of the page counts before what the browser prefers; paper is
/// light.
std::string html_palette();

} // namespace app
