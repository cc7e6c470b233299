#include "app/batch/file_bytes.h"

#include <nlohmann/json.hpp>

#include "app/batch/kept_json.h"
#include "app/setup/utf8_text.h"

namespace app {

std::string shown_name(const std::string& path, FileBytes& bytes) {
    std::string text = utf8_text(path);
    if (text != path) bytes[text] = path;
    return text;
}

const std::string& name_shown_as(const std::string& text, const FileBytes& bytes) {
    const auto found = bytes.find(text);
    return found == bytes.end() ? text : found->second;
}

nlohmann::ordered_json json_of(const FileBytes& bytes) {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    for (const auto& [text, name] : bytes) {
        auto& list = json[text] = nlohmann::ordered_json::array();
        for (const char byte : name) list.push_back(static_cast<uint8_t>(byte));
    }
    return json;
}

FileBytes file_bytes_from(const KeptJson& json) {
    FileBytes bytes;
    for (const auto& [text, list] : json.items())
        for (const KeptJson& byte : list_from(list))
            bytes[text] += static_cast<char>(whole_from<uint8_t>(byte));
    return bytes;
}

} // namespace app
