#include "app/setup/table_reader.h"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/text.h"
#include "gcode/language/modal_state.h"

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

} // namespace

TableReader::TableReader(const toml::table& table, std::string name,
                         std::optional<core::Error>& error)
    : table_(table), name_(std::move(name)), error_(error), unit_(gcode::LengthUnit::mm) {}

gcode::LengthUnit TableReader::read_unit() {
    if (const auto unit = word(length_unit_key, {"mm", "inch"}))
        unit_ = *unit == "inch" ? gcode::LengthUnit::inch : gcode::LengthUnit::mm;
    return unit_;
}

std::string TableReader::shown(double mm, int decimals) const {
    const bool is_inch = unit_ == gcode::LengthUnit::inch;
    return core::number_text(gcode::from_mm(mm, unit_), decimals) + (is_inch ? " in" : " mm");
}

/// The value of a number, in mm if it is a length; empty for all that is not a finite number.
std::optional<double> TableReader::finite(const toml::node& node, Measure measure) const {
    const auto written = node.value<double>();
    if (!node.is_number() || !written) return std::nullopt;
    const double value = measure == Measure::length ? gcode::to_mm(*written, unit_) : *written;
    return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// The numbers of a list; fewer than it has items if it holds other things.
std::vector<double> TableReader::finite_items(const toml::node& list, Measure measure) const {
    std::vector<double> values;
    if (const toml::array* array = list.as_array())
        for (const toml::node& item : *array)
            if (const auto value = finite(item, measure)) values.push_back(*value);
    return values;
}

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

std::optional<double> TableReader::number(const char* key, Measure measure) {
    const toml::node* at = node(key);
    if (!at) return std::nullopt;
    const auto value = finite(*at, measure);
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

std::optional<std::vector<double>> TableReader::numbers(const char* key, Measure measure,
                                                        size_t length) {
    const toml::node* at = node(key);
    if (!at) return std::nullopt;
    std::vector<double> values = finite_items(*at, measure);
    const bool all = at->is_array() && values.size() == at->as_array()->size();
    if (!all || (length != 0 && values.size() != length)) {
        refuse(key, length == 0 ? std::string("must be a list of numbers")
                                : fmt::format("must be a list of {} numbers", length));
        return std::nullopt;
    }
    return values;
}

std::optional<core::Vec3> TableReader::vector(const char* key, Measure measure) {
    const auto values = numbers(key, measure, 3);
    if (!values) return std::nullopt;
    return core::Vec3((*values)[0], (*values)[1], (*values)[2]);
}

std::vector<std::vector<double>> TableReader::rows(const char* key, Measure measure,
                                                   size_t length) {
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
        std::vector<double> values = finite_items(row, measure);
        if (!row.is_array() || row.as_array()->size() != length || values.size() != length) {
            refuse(key, shape);
            return {};
        }
        result.push_back(std::move(values));
    }
    return result;
}

void TableReader::limit_numbers(const toml::node& value, std::string_view key) {
    if (key == "number" || key == "line") return;
    if (const toml::table* inner = value.as_table())
        for (const auto& [name, below] : *inner) limit_numbers(below, name.str());
    if (const toml::array* list = value.as_array())
        for (const toml::node& below : *list) limit_numbers(below, key);
    const auto number = finite(value, Measure::length);
    if (number && std::abs(*number) > largest_number)
        refuse_at(value.source(),
                  fmt::format("{} {:g} is out of range: lengths and coordinates are at most 1 km "
                              "either way, angles {:.0f} degrees",
                              key, value.value_or(0.0), largest_number));
}

void TableReader::limit_numbers() { limit_numbers(table_, ""); }

void TableReader::limit_numbers(const char* key) {
    if (const toml::node* value = table_.get(key)) limit_numbers(*value, key);
}

std::optional<TableReader> TableReader::table(const char* key, const std::string& name) {
    const toml::node* at = node(key);
    if (!at) return std::nullopt;
    if (const toml::table* inner = at->as_table()) {
        TableReader reader(*inner, name, error_);
        reader.use_unit(unit_);
        return reader;
    }
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
                result.emplace_back(*inner, fmt::format("{} {}", name, result.size() + 1), error_)
                    .use_unit(unit_);
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
        if (name == length_unit_key)
            return refuse_at(key.source(),
                             name + " holds for a whole file: write it before the first table");
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
