#include "app/base/sha256.h"

#include <array>
#include <fstream>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <openssl/evp.h>

#include "core/base/file_reads.h"

namespace app {
namespace {

/// An incremental SHA-256.
class TextDigest {
public:
    TextDigest() : context_(EVP_MD_CTX_new(), &EVP_MD_CTX_free) {
        is_good_ = context_ && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1;
    }

    void add(std::string_view bytes) {
        is_good_ = is_good_ && EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()) == 1;
    }

    /// The digest; empty if the library fails.
    std::string finish() && {
        std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
        unsigned int length = 0;
        if (!is_good_ || EVP_DigestFinal_ex(context_.get(), digest.data(), &length) != 1) return {};
        std::string text;
        for (unsigned int i = 0; i < length; ++i) text += fmt::format("{:02x}", digest[i]);
        return text;
    }

private:
    std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
    bool is_good_ = false;
};

} // namespace

std::string sha256_of(std::string_view bytes) {
    TextDigest digest;
    digest.add(bytes);
    return std::move(digest).finish();
}

std::string sha256_of_file(const std::string& path) {
    if (!core::is_file(path)) return {};
    std::ifstream file(path, std::ios::binary);
    if (!file) return {};
    TextDigest digest;
    std::array<char, 65536> chunk;
    while (file.read(chunk.data(), chunk.size()) || file.gcount() > 0)
        digest.add({chunk.data(), static_cast<size_t>(file.gcount())});
    if (file.bad()) return {};
    return std::move(digest).finish();
}

} // namespace app
