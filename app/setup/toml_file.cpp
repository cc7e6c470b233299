#include "app/setup/toml_file.h"

#include <filesystem>

namespace app {

core::Result<toml::table> read_toml(const std::string& path) {
    std::error_code failure;
    if (std::filesystem::is_directory(path, failure))
        return core::fail(core::ErrorCode::io, "is a folder, not a file");
    if (!std::filesystem::exists(path, failure))
        return core::fail(core::ErrorCode::io, "there is no such file");
    try {
        return toml::parse_file(path);
    } catch (const toml::parse_error& error) {
        const toml::source_position at = error.source().begin;
        return core::fail(core::ErrorCode::syntax, std::string(error.description()),
                          {at.line, at.column, 0});
    }
}

} // namespace app
