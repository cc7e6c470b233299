#include "app/base/sha256.h"

#include <array>
#include <cstdio>
#include <memory>

#include <fmt/format.h>

#include "core/base/file_reads.h"
#include "core/base/platform.h"

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
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(
        core::platform::open_file(path, "rb"), std::fclose);
    if (!file) return {};
    Sha256 digest;
    std::array<char, 65536> chunk;
    while (const size_t count = std::fread(chunk.data(), 1, chunk.size(), file.get()))
        digest.add({chunk.data(), count});
    if (std::ferror(file.get()) != 0) return {};
    return text_of(digest);
}

} // namespace app
