#define WIN32_LEAN_AND_MEAN
#include <windows.h>

// After windows.h.
#include <algorithm>

#include <bcrypt.h>

#include "app/base/sha256.h"

namespace app {

struct Sha256::State {
    BCRYPT_ALG_HANDLE algorithm = nullptr;
    BCRYPT_HASH_HANDLE hash = nullptr;
    bool is_good = false;

    State() {
        is_good =
            ::BCryptOpenAlgorithmProvider(&algorithm, BCRYPT_SHA256_ALGORITHM, nullptr, 0) >= 0
            && ::BCryptCreateHash(algorithm, &hash, nullptr, 0, nullptr, 0, 0) >= 0;
    }
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() {
        if (hash) ::BCryptDestroyHash(hash);
        if (algorithm) ::BCryptCloseAlgorithmProvider(algorithm, 0);
    }
};

Sha256::Sha256() : state_(std::make_unique<State>()) {}
Sha256::~Sha256() = default;

void Sha256::add(std::string_view bytes) {
    constexpr size_t most = 1U << 30U; // of one call, whose size is a ULONG
    for (; state_->is_good && !bytes.empty(); bytes.remove_prefix(std::min(most, bytes.size()))) {
        auto* const first = reinterpret_cast<PUCHAR>(const_cast<char*>(bytes.data()));
        const auto size = static_cast<ULONG>(std::min(most, bytes.size()));
        state_->is_good = ::BCryptHashData(state_->hash, first, size, 0) >= 0;
    }
}

std::optional<std::array<unsigned char, 32>> Sha256::finish() {
    std::array<unsigned char, 32> digest{};
    const auto size = static_cast<ULONG>(digest.size());
    if (!state_->is_good || ::BCryptFinishHash(state_->hash, digest.data(), size, 0) < 0)
        return std::nullopt;
    return digest;
}

} // namespace app
