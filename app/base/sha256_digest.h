#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace app {

/// An incremental SHA-256, by the library for it on each system.
class Sha256Digest {
public:
    Sha256Digest();
    ~Sha256Digest();
    Sha256Digest(const Sha256Digest&) = delete;
    Sha256Digest& operator=(const Sha256Digest&) = delete;

    void add(std::string_view bytes);

    /// The digest as 64 hexadecimal digits; empty if the library fails. The last call.
    std::string finish();

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace app
