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

/// JSON from a file or database, which may have been edited. The readers below are stricter than
/// those of nlohmann_json, which accept 0.7 as 0 and an object as a list. Like those, they throw
/// standard exceptions, which callers turn into errors.
using StoredJson = nlohmann::ordered_json;

/// Whether brackets are nested deeper than in any stored JSON. Parsers recurse once per level.
bool is_nested_too_deep(std::string_view text);

/// Parses JSON. Throws if the text is not JSON or is nested too deeply.
StoredJson parsed_stored_json(const std::string& text);

/// JSON as text: on one line, or with this indentation. Invalid UTF-8 is replaced, because programs
/// contain bytes of any code page.
std::string json_text(const StoredJson& json, int indent = -1);

/// A whole number that fits the type.
template <typename Whole>
Whole whole_from(const StoredJson& json) {
    if (!json.is_number_unsigned()
        || json.get<uint64_t>() > static_cast<uint64_t>(std::numeric_limits<Whole>::max()))
        throw std::invalid_argument("not a whole number, or too large");
    return json.get<Whole>();
}

/// A finite number that is at least `least`.
double number_from(const StoredJson& json, double least = std::numeric_limits<double>::lowest());

/// A list; if `count` is given, of that many entries.
const StoredJson& list_from(const StoredJson& json, std::optional<size_t> count = {});

/// The two texts of a list.
std::array<std::string, 2> pair_from(const StoredJson& json);

/// An object with what is known of each item, and the tools without a holder.
StoredJson json_of(const Coverage& coverage);

/// Reads such an object back; throws if it is invalid.
Coverage coverage_from(const StoredJson& json);

/// An object with a list of bytes for each text.
StoredJson json_of(const FileBytes& bytes);

/// Reads such an object back; throws if it is invalid.
FileBytes file_bytes_from(const StoredJson& json);

} // namespace app
