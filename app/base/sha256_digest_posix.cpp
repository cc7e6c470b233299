#include <array>

#include <fmt/format.h>
#include <openssl/evp.h>

#include "app/base/sha256_digest.h"

namespace app {

struct Sha256Digest::State {
    EVP_MD_CTX* context = EVP_MD_CTX_new();
    bool is_good = context && EVP_DigestInit_ex(context, EVP_sha256(), nullptr) == 1;

    State() = default;
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() { EVP_MD_CTX_free(context); }
};

Sha256Digest::Sha256Digest() : state_(std::make_unique<State>()) {}
Sha256Digest::~Sha256Digest() = default;

void Sha256Digest::add(std::string_view bytes) {
    State& state = *state_;
    state.is_good =
        state.is_good && EVP_DigestUpdate(state.context, bytes.data(), bytes.size()) == 1;
}

std::string Sha256Digest::finish() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned int length = 0;
    if (!state_->is_good || EVP_DigestFinal_ex(state_->context, digest.data(), &length) != 1)
        return {};
    std::string text;
    for (unsigned int i = 0; i < length; ++i) text += fmt::format("{:02x}", digest[i]);
    return text;
}

} // namespace app
