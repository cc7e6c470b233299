#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>

namespace core {
enum class FileAccessKind : uint8_t;
}

namespace app {

/// A file access that affects the result of a check: the content of a file, or the fact that it
/// does not exist.
struct InputFile {
    core::FileAccessKind question{};
    std::string path;                  // of the file, or of the folder that was searched
    std::string name;                  // name searched for in the folder
    std::optional<std::string> answer; // for content: its SHA-256

    auto operator<=>(const InputFile&) const = default;
};

} // namespace app
