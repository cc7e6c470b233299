#include "app/batch/file_place.h"

namespace app {

std::filesystem::path place_of(const std::filesystem::path& path) {
    constexpr int most_links = 40; // as the system
    std::error_code ignored;
    std::filesystem::path place = std::filesystem::absolute(path, ignored);
    for (int i = 0; i < most_links && std::filesystem::is_symlink(place, ignored); ++i)
        place = place.parent_path() / std::filesystem::read_symlink(place, ignored);
    return std::filesystem::weakly_canonical(place, ignored);
}

} // namespace app
