#include "app/setup/toml_file.h"

#include "core/base/file_reads.h"

namespace app {
namespace {

core::Error syntax_error(const toml::parse_error& error, const std::string& file) {
    const toml::source_position at = error.source().begin;
    return {
        core::ErrorCode::syntax, {at.line, at.column, 0}, std::string(error.description()), file};
}

} // namespace

core::Result<toml::table> parsed_toml(std::string_view text) {
    try {
        return toml::table(toml::parse(text));
    } catch (const toml::parse_error& error) {
        return tl::unexpected(syntax_error(error, ""));
    }
}

core::Result<toml::table> read_toml(const std::string& path) {
    using core::ErrorCode;
    if (std::string why = core::why_no_file(path); !why.empty())
        return tl::unexpected<core::Error>({ErrorCode::io, {}, std::move(why), path});
    const std::optional<std::string> bytes = core::file_bytes(path);
    if (!bytes) return tl::unexpected<core::Error>({ErrorCode::io, {}, "cannot be read", path});
    try {
        return toml::table(toml::parse(*bytes));
    } catch (const toml::parse_error& error) {
        return tl::unexpected(syntax_error(error, path));
    }
}

} // namespace app
