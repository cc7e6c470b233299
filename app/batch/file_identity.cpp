#include "app/batch/file_identity.h"

#include "app/batch/plain_path.h"

namespace app {

std::string FileIdentities::of(const std::filesystem::path& path) {
    const std::filesystem::path plain = plain_path(path);
    const std::string folder = plain.has_parent_path() ? plain.parent_path().string() : ".";
    const auto [known, is_new] = folders_.try_emplace(folder);
    if (is_new) {
        std::error_code failure;
        known->second = std::filesystem::canonical(folder, failure);
        if (failure) known->second = folder;
    }
    return (known->second / plain.filename()).string();
}

} // namespace app
