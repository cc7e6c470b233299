#include "app/batch/project_owner.h"

#include "app/setup/setup_beside.h"
#include "core/base/file_reads.h"

namespace app {

std::string ProjectOwners::of(const std::filesystem::path& folder,
                              const std::filesystem::path& top) {
    std::filesystem::path here = folder;
    while (!holds_project(here)) {
        const std::filesystem::path above = here.parent_path();
        if (here == top || above == here) return {};
        here = above;
    }
    return (here / project_file_name).string();
}

bool ProjectOwners::holds_project(const std::filesystem::path& folder) {
    const auto [known, is_new] = known_.try_emplace(folder.string());
    if (is_new) known->second = core::is_there(folder / project_file_name);
    return known->second;
}

} // namespace app
