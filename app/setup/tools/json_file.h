#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "core/base/result.h"

namespace app {

/// Reads a JSON file.
///
/// Errors: io and syntax, with the file.
core::Result<nlohmann::json> read_json(const std::filesystem::path& path);

/// JSON that has been read. `path`: for errors.
///
/// Errors: syntax, with the file.
core::Result<nlohmann::json> parse_json(const std::string& text, const std::filesystem::path& path);

/// A text or number of an object; empty or 0 if it is missing or has another type.
std::string text_at(const nlohmann::json& object, const char* key);
double number_at(const nlohmann::json& object, const char* key);

/// A member of an object; null if there is none.
const nlohmann::json& member_at(const nlohmann::json& object, const char* key);

} // namespace app
