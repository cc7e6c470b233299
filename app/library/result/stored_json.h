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

/// JSON that was kept in a file or a database, which anybody can have edited since. Its readers are
/// stricter than the library's, which takes 0.7 for 0 and an object for a list. Like the library's,
/// they throw exceptions of the standard; their callers make errors of them.
using StoredJson = nlohmann::ordered_json;

/// Whether brackets stand in brackets deeper than anything that is kept: what walks through such
/// JSON calls itself that often.
bool is_nested_too_deep(std::string_view text);

/// Errors: throws for text that is no JSON, or nested too deep.
StoredJson kept_json(const std::string& text);

/// A number without a fraction that fits.
template <typename Whole>
Whole whole_from(const StoredJson& json) {
    if (!json.is_number_unsigned()
        || json.get<uint64_t>() > static_cast<uint64_t>(std::numeric_limits<Whole>::max()))
        throw std::invalid_argument("a whole number is none, or too large");
    return json.get<Whole>();
}

/// A finite number, and at least as large as `least`.
double number_from(const StoredJson& json, double least = std::numeric_limits<double>::lowest());

/// A list, and of so many entries if `count` is given.
const StoredJson& list_from(const StoredJson& json, std::optional<size_t> count = {});

/// The two texts of a list.
std::array<std::string, 2> pair_from(const StoredJson& json);

/// An object with a list of bytes for each text.
StoredJson json_of(const FileBytes& bytes);

/// The same read in again; throws, as the reader of JSON does.
FileBytes file_bytes_from(const StoredJson& json);

} // namespace app
