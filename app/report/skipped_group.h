#pragma once

#include <string>
#include <vector>

#include "app/batch/folder_walk.h"

namespace app {

/// Files that were skipped for one reason.
struct SkippedGroup {
    std::string why;
    std::vector<std::string> files; // in their order
};

/// The reasons for which files were skipped: that of most files first.
std::vector<SkippedGroup> skipped_groups(const std::vector<SkippedFile>& skipped);

} // namespace app
