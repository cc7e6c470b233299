#pragma once

#include <array>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "app/library/result/program_result.h"

namespace app {

/// JSON from a file or a database, which somebody may have edited. The readers below are stricter
/// than those of the library, which read 0.7 as 0 and an object as a list. Like those they throw
/// standard exceptions, which callers turn into errors.
using StoredJson = nlohmann::ordered_json;

/// Whether brackets are nested deeper than in any stored JSON. Parsers recurse once per level.
bool is_nested_too_deep(std::string_view text);

/// Errors: throws for text that is no JSON, or nested too deep.
StoredJson kept_json(const std::string& text);

/// A whole number that fits the type.
template <typename Whole>
Whole whole_from(const StoredJson& json) {
    if (!json.is_number_unsigned()
        || json.get<uint64_t>() > static_cast<uint64_t>(std::numeric_limits<Whole>::max()))
        throw std::invalid_argument("not a whole number, or too large");
    return json.get<Whole>();
}

/// A finite number, and at least as large as `least`.
double number_from(const StoredJson& json, double least = std::numeric_limits<double>::lowest());

/// A list, of `count` entries if given.
const StoredJson& list_from(const StoredJson& json, std::optional<size_t> count = {});

/// The two texts of a list.
std::array<std::string, 2> pair_from(const StoredJson& json);

/// An object with a list of bytes for each text.
StoredJson json_of(const FileBytes& bytes);

/// The same read in again; throws, as the reader of JSON does.
FileBytes file_bytes_from(const StoredJson& json);

} // namespace app
