#pragma once

#include <map>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace app {

/// The bytes of names of files that are no UTF-8, by the texts that stand for them in results.
using FileBytes = std::map<std::string, std::string>;

/// The text that stands for a name, whose bytes are kept where they are others.
std::string shown_name(const std::string& path, FileBytes& bytes);

/// The name that a text stands for.
const std::string& name_shown_as(const std::string& text, const FileBytes& bytes);

/// An object with a list of bytes for each text.
nlohmann::ordered_json json_of(const FileBytes& bytes);

/// The same read in again; throws, as the reader of JSON does.
FileBytes file_bytes_from(const nlohmann::ordered_json& json);

} // namespace app
