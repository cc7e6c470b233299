#include "app/library/result/stored_json.h"

#include <cmath>

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
