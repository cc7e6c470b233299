#include "app/library/result/stored_json.h"

#include <cmath>

#include "core/base/text.h"

namespace app {
namespace {

constexpr size_t most_nested = 16; // the results of a shard need 7

} // namespace

bool is_nested_too_deep(std::string_view text) {
    size_t depth = 0;
    bool in_string = false;
    for (size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string && c == '\\')
            ++i;
        else if (c == '"')
            in_string = !in_string;
        else if (!in_string && (c == '[' || c == '{') && ++depth > most_nested)
            return true;
        else if (!in_string && (c == ']' || c == '}') && depth > 0)
            --depth;
    }
    return false;
}

StoredJson parsed_stored_json(const std::string& text) {
    if (is_nested_too_deep(text)) throw std::invalid_argument("nested too deeply");
    return StoredJson::parse(text);
}

std::string json_text(const StoredJson& json, int indent) {
    return json.dump(indent, ' ', false, StoredJson::error_handler_t::replace);
}

double number_from(const StoredJson& json, double least) {
    // get<double>() also accepts other types: true is 1.
    const double number = json.is_number() ? json.get<double>() : std::nan("");
    if (!std::isfinite(number) || number < least)
        throw std::invalid_argument("not a number, or out of range");
    return number;
}

const StoredJson& list_from(const StoredJson& json, std::optional<size_t> count) {
    if (!json.is_array() || (count && json.size() != *count))
        throw std::invalid_argument("not a list, or of the wrong length");
    return json;
}

std::array<std::string, 2> pair_from(const StoredJson& json) {
    list_from(json, 2);
    return {json[0].get<std::string>(), json[1].get<std::string>()};
}

StoredJson json_of(const Coverage& coverage) {
    StoredJson json = StoredJson::object();
    for (const CoverageItem& item : items_of(coverage)) json[item.key] = name_of(item.known);
    const auto put = [&](const char* key, const std::vector<core::ToolNumber>& tools) {
        json[key] = StoredJson::array();
        for (const core::ToolNumber tool : tools) json[key].push_back(core::value_of(tool));
    };
    put("tools_without_holder", coverage.tools_without_holder);
    put("tools_assumed", coverage.tools_assumed);
    json["moves"] = coverage.moves;
    json["limits_need_offsets"] = coverage.limits_need_offsets;
    json["stock_is_elsewhere"] = coverage.stock_is_elsewhere;
    json["complete"] = coverage.is_complete();
    return json;
}

Coverage coverage_from(const StoredJson& json) {
    const auto known = [&](const char* key) {
        const auto found = core::find_named(all_known, json.at(key).get<std::string>());
        if (!found) throw std::invalid_argument("unknown value");
        return *found;
    };
    Coverage coverage{.stock = known("stock"),
                      .holders = known("holders"),
                      .fixtures = known("fixtures"),
                      .offsets = known("offsets"),
                      .limits = known("limits"),
                      .start = known("start"),
                      .tools = json.contains("tools") ? known("tools") : Known::described};
    const auto take = [&](const char* key, std::vector<core::ToolNumber>& tools) {
        for (const StoredJson& tool : list_from(json.at(key)))
            tools.push_back(core::ToolNumber{whole_from<int>(tool)});
    };
    take("tools_without_holder", coverage.tools_without_holder);
    if (json.contains("tools_assumed")) take("tools_assumed", coverage.tools_assumed);
    if (!json.at("moves").is_boolean()) throw std::invalid_argument("neither true nor false");
    coverage.moves = json.at("moves").get<bool>();
    coverage.limits_need_offsets = json.value("limits_need_offsets", false);
    coverage.stock_is_elsewhere = json.value("stock_is_elsewhere", false);
    return coverage;
}

StoredJson json_of(const FileBytes& bytes) {
    StoredJson json = StoredJson::object();
    for (const auto& [text, name] : bytes) {
        auto& list = json[text] = StoredJson::array();
        for (const char byte : name) list.push_back(static_cast<uint8_t>(byte));
    }
    return json;
}

FileBytes file_bytes_from(const StoredJson& json) {
    FileBytes bytes;
    for (const auto& [text, list] : json.items())
        for (const StoredJson& byte : list_from(list))
            bytes[text] += static_cast<char>(whole_from<uint8_t>(byte));
    return bytes;
}

} // namespace app
