#include "app/batch/plain_path.h"

namespace app {

std::string plain_path(const std::filesystem::path& path) {
    std::filesystem::path plain;
    for (const std::filesystem::path& part : path)
        if (part != "." && !part.empty()) plain /= part;
    return plain.empty() ? "." : plain.string();
}

} // namespace app
