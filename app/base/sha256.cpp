#include "app/base/sha256.h"

#include <array>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include "core/base/file_reads.h"

namespace app {
namespace {

std::string text_of(Sha256& digest) {
    std::string text;
    if (const auto bytes = digest.finish())
        for (const unsigned char byte : *bytes) text += fmt::format("{:02x}", byte);
    return text;
}

} // namespace

std::string sha256_of(std::string_view bytes) {
    Sha256 digest;
    digest.add(bytes);
    return text_of(digest);
}

std::string sha256_of_file(const std::string& path) {
    if (!core::is_file(path)) return {};
    std::ifstream file(std::filesystem::path(path), std::ios::binary);
    if (!file) return {};
    Sha256 digest;
    std::array<char, 65536> chunk;
    while (file.read(chunk.data(), chunk.size()) || file.gcount() > 0)
        digest.add({chunk.data(), static_cast<size_t>(file.gcount())});
    if (file.bad()) return {};
    return text_of(digest);
}

} // namespace app
