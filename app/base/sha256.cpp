#include "app/base/sha256.h"

#include <array>
#include <filesystem>
#include <fstream>

#include "app/base/sha256_digest.h"
#include "core/base/file_reads.h"

namespace app {
std::string sha256_of(std::string_view bytes) {
    Sha256Digest digest;
    digest.add(bytes);
    return digest.finish();
}

std::string sha256_of_file(const std::string& path) {
    if (!core::is_file(path)) return {};
    std::ifstream file(std::filesystem::path(path), std::ios::binary);
    if (!file) return {};
    Sha256Digest digest;
    std::array<char, 65536> chunk;
    while (file.read(chunk.data(), chunk.size()) || file.gcount() > 0)
        digest.add({chunk.data(), static_cast<size_t>(file.gcount())});
    if (file.bad()) return {};
    return digest.finish();
}

} // namespace app
