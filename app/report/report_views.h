#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace app {

/// What a report shows of one block.
struct BlockView {
    size_t block = 0;
    std::string picture; // a JPEG's bytes; empty: there is none
    std::string scene;   // a JSON object for the page's 3D view; empty: there is none
};

/// Everything that a report has to look at.
struct ReportViews {
    std::vector<BlockView> views;
    std::string meshes;      // a JSON array that the scenes refer to
    std::string no_pictures; // why there are none, in a sentence; else empty
};

} // namespace app
