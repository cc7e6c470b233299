#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace app {

/// The SHA-256 of bytes as 64 hexadecimal digits; empty if the library for it fails.
std::string sha256_of(std::string_view bytes);

/// The SHA-256 of a file; also empty if it cannot be read or is a pipe.
std::string sha256_of_file(const std::string& path);

/// An incremental SHA-256, with the library that each system has for it.
class Sha256 {
public:
    Sha256();
    ~Sha256();
    Sha256(const Sha256&) = delete;
    Sha256& operator=(const Sha256&) = delete;

    void add(std::string_view bytes);

    /// The digest; empty if the library fails. Nothing can be added afterwards.
    std::optional<std::array<unsigned char, 32>> finish();

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace app
