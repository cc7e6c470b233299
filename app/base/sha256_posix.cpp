#include <openssl/evp.h>

#include "app/base/sha256.h"

namespace app {

struct Sha256::State {
    EVP_MD_CTX* context = EVP_MD_CTX_new();
    bool is_good = context && EVP_DigestInit_ex(context, EVP_sha256(), nullptr) == 1;

    State() = default;
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() { EVP_MD_CTX_free(context); }
};

Sha256::Sha256() : state_(std::make_unique<State>()) {}
Sha256::~Sha256() = default;

void Sha256::add(std::string_view bytes) {
    State& state = *state_;
    state.is_good =
        state.is_good && EVP_DigestUpdate(state.context, bytes.data(), bytes.size()) == 1;
}

std::optional<std::array<unsigned char, 32>> Sha256::finish() {
    std::array<unsigned char, 32> digest{};
    if (!state_->is_good || EVP_DigestFinal_ex(state_->context, digest.data(), nullptr) != 1)
        return std::nullopt;
    return digest;
}

} // namespace app
