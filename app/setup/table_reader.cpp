#include "app/setup/table_reader.h"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/text.h"

namespace app {
namespace {

std::string nearest(const std::string& word, const std::set<std::string>& known) {
    std::string best;
    size_t least = 3; // a suggestion must be closer than this
    for (const std::string& candidate : known) {
        const size_t apart = core::edit_distance(word, candidate);
        if (apart >= least) continue;
        least = apart;
        best = candidate;
    }
    return best;
}

std::optional<double> finite(const toml::node& node) {
    const auto value = node.value<double>();
    if (!node.is_number() || !value || !std::isfinite(*value)) return std::nullopt;
    return value;
}

} // namespace

const toml::node* TableReader::node(const char* key) {
    known_.insert(key);
    return error_ ? nullptr : table_.get(key);
}

void TableReader::refuse_at(const toml::source_region& where, const std::string& why) {
    if (error_) return;
    error_ = core::Error{core::ErrorCode::invalid_value,
                         {where.begin.line, where.begin.column, 0},
                         fmt::format("{}: {}", name_, why)};
}

void TableReader::refuse(const char* key, const std::string& why) {
    const toml::node* at = table_.get(key);
    refuse_at(at ? at->source() : table_.source(), fmt::format("{} {}", key, why));
}

void TableReader::refuse_with(const core::Error& error) {
    if (!error_) error_ = error;
}

size_t TableReader::row_length(const char* key) const {
    const toml::array* rows = table_.get(key) ? table_.get(key)->as_array() : nullptr;
    const toml::array* first = rows && !rows->empty() ? rows->get(0)->as_array() : nullptr;
    return first ? first->size() : 0;
}

void TableReader::need(const char* key) {
    refuse_at(table_.source(), fmt::format("{} is missing", key));
}

std::optional<double> TableReader::number(const char* key) {
    const toml::node* at = node(key);
    if (!at) return std::nullopt;
    const auto value = finite(*at);
    if (!value) refuse(key, "must be a number");
    return value;
}

std::optional<int> TableReader::integer(const char* key) {
    const toml::node* at = node(key);
    if (!at) return std::nullopt;
    const auto value = at->value<int>();
    if (!at->is_integer() || !value) {
        refuse(key, "must be a whole number");
        return std::nullopt;
    }
    return value;
}

std::optional<std::string> TableReader::string(const char* key) {
    const toml::node* at = node(key);
    if (!at) return std::nullopt;
    if (!at->is_string()) {
        refuse(key, "must be a text in quotes");
        return std::nullopt;
    }
    return at->value<std::string>();
}

std::optional<bool> TableReader::boolean(const char* key) {
    const toml::node* at = node(key);
    if (!at) return std::nullopt;
    if (!at->is_boolean()) {
        refuse(key, "must be true or false");
        return std::nullopt;
    }
    return at->value<bool>();
}

std::optional<std::string> TableReader::word(const char* key,
                                             std::span<const std::string_view> words) {
    const auto value = string(key);
    if (!value) return std::nullopt;
    for (const std::string_view word : words)
        if (*value == word) return value;
    refuse(key, fmt::format("is \"{}\", but must be one of: {}", *value, fmt::join(words, " ")));
    return std::nullopt;
}

std::optional<std::vector<std::string>> TableReader::strings(const char* key, size_t length) {
    const toml::node* at = node(key);
    if (!at) return std::nullopt;
    std::vector<std::string> values;
    if (const toml::array* array = at->as_array())
        for (const toml::node& item : *array)
            if (const auto value = item.value<std::string>()) values.push_back(*value);
    const bool all = at->is_array() && values.size() == at->as_array()->size();
    if (!all || (length != 0 && values.size() != length)) {
        refuse(key, length == 0 ? std::string("must be a list of texts in quotes")
                                : fmt::format("must be a list of {} texts in quotes", length));
        return std::nullopt;
    }
    return values;
}

std::optional<std::vector<double>> TableReader::numbers(const char* key, size_t length) {
    const toml::node* at = node(key);
    if (!at) return std::nullopt;
    std::vector<double> values;
    if (const toml::array* array = at->as_array())
        for (const toml::node& item : *array)
            if (const auto value = finite(item)) values.push_back(*value);
    const bool all = at->is_array() && values.size() == at->as_array()->size();
    if (!all || (length != 0 && values.size() != length)) {
        refuse(key, length == 0 ? std::string("must be a list of numbers")
                                : fmt::format("must be a list of {} numbers", length));
        return std::nullopt;
    }
    return values;
}

std::optional<core::Vec3> TableReader::vector(const char* key) {
    const auto values = numbers(key, 3);
    if (!values) return std::nullopt;
    return core::Vec3((*values)[0], (*values)[1], (*values)[2]);
}

std::vector<std::vector<double>> TableReader::rows(const char* key, size_t length) {
    std::vector<std::vector<double>> result;
    const toml::node* at = node(key);
    if (!at) return result;
    const std::string shape = fmt::format("must be a list of rows of {} numbers each, as in [[{}]]",
                                          length, length == 2 ? "0, 0], [5, 10" : "10, 10, 25");
    const toml::array* array = at->as_array();
    if (!array) {
        refuse(key, shape);
        return result;
    }
    for (const toml::node& row : *array) {
        std::vector<double> values;
        if (const toml::array* items = row.as_array())
            for (const toml::node& item : *items)
                if (const auto value = finite(item)) values.push_back(*value);
        if (!row.is_array() || row.as_array()->size() != length || values.size() != length) {
            refuse(key, shape);
            return {};
        }
        result.push_back(std::move(values));
    }
    return result;
}

std::optional<TableReader> TableReader::table(const char* key, const std::string& name) {
    const toml::node* at = node(key);
    if (!at) return std::nullopt;
    if (const toml::table* inner = at->as_table()) return TableReader(*inner, name, error_);
    refuse(key, "must be a table");
    return std::nullopt;
}

std::vector<TableReader> TableReader::tables(const char* key, const std::string& name) {
    std::vector<TableReader> result;
    const toml::node* at = node(key);
    if (!at) return result;
    if (const toml::array* array = at->as_array()) {
        for (const toml::node& item : *array)
            if (const toml::table* inner = item.as_table())
                result.emplace_back(*inner, fmt::format("{} {}", name, result.size() + 1), error_);
        if (result.size() == array->size()) return result;
    }
    refuse(key, fmt::format("must be a list of tables, written as {}", name));
    return {};
}

std::vector<std::string> TableReader::keys() const {
    std::vector<std::string> names;
    for (const auto& [key, value] : table_) names.emplace_back(key.str());
    return names;
}

void TableReader::finish() {
    for (const auto& [key, value] : table_) {
        const std::string name(key.str());
        if (known_.contains(name)) continue;
        const std::string meant = nearest(name, known_);
        refuse_at(
            key.source(),
            meant.empty()
                ? fmt::format("unknown key \"{}\"; known here: {}", name, fmt::join(known_, " "))
                : fmt::format("unknown key \"{}\"; did you mean \"{}\"?", name, meant));
        return;
    }
}

} // namespace app
