#include "app/setup/tools/json_file.h"

#include "core/base/file_reads.h"

namespace app {

core::Result<nlohmann::json> read_json(const std::filesystem::path& path) {
    if (std::string why = core::why_no_file(path); !why.empty())
        return tl::unexpected(
            core::Error{core::ErrorCode::io, {}, std::move(why), path.generic_string()});
    const std::optional<std::string> bytes = core::file_bytes(path);
    if (!bytes)
        return tl::unexpected(
            core::Error{core::ErrorCode::io, {}, "cannot be read", path.generic_string()});
    return parse_json(*bytes, path);
}

core::Result<nlohmann::json> parse_json(const std::string& text,
                                        const std::filesystem::path& path) {
    nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
    if (json.is_discarded())
        return tl::unexpected(
            core::Error{core::ErrorCode::syntax, {}, "is not valid JSON", path.generic_string()});
    return json;
}

std::string text_at(const nlohmann::json& object, const char* key) {
    const nlohmann::json& member = member_at(object, key);
    return member.is_string() ? member.get<std::string>() : std::string();
}

double number_at(const nlohmann::json& object, const char* key) {
    const nlohmann::json& member = member_at(object, key);
    return member.is_number() ? member.get<double>() : 0.0;
}

const nlohmann::json& member_at(const nlohmann::json& object, const char* key) {
    static const nlohmann::json none;
    if (!object.is_object()) return none;
    const auto found = object.find(key);
    return found == object.end() ? none : *found;
}

} // namespace app
