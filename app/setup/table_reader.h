#pragma once

#include <array>
#include <initializer_list>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <toml++/toml.h>

#include "core/base/result.h"
#include "core/base/vec.h"

namespace gcode {
enum class LengthUnit : uint8_t;
}

namespace app {

/// The key for the unit of all lengths in a file. It stands before the first table.
inline constexpr const char* length_unit_key = "length_unit";

/// What the numbers of a key measure. It decides their unit: lengths, and speeds and accelerations
/// along lines, are in the unit of the file and are read as mm.
enum class Measure : uint8_t { length, angle, plain };

/// The largest coordinate or size in a set-up, 1 km in mm, and the largest angle in degrees. Larger
/// ones are slips; a body that far away would be lost without a word.
inline constexpr double largest_number = 1e6;

/// Reads a TOML table key by key, and refuses keys that the caller never reads.
///
/// Only the first error is kept, with its position; after it all reads return nothing. So a caller
/// can read everything and check for an error once, at the end.
class TableReader {
public:
    /// `name`: the table in messages, such as `[stock]`. `error` must outlive the reader.
    TableReader(const toml::table& table, std::string name, std::optional<core::Error>& error);

    /// Reads lengths in a unit, also in the tables below that are read from now on.
    void use_unit(gcode::LengthUnit unit) { unit_ = unit; }
    gcode::LengthUnit unit() const { return unit_; }

    /// Reads `length_unit`, the unit of the file, and uses it.
    gcode::LengthUnit read_unit();

    /// A length in the unit of the file, for messages: "1000 mm", "39.37 in".
    std::string shown(double mm, int decimals = 3) const;

    bool has(const char* key) const { return table_.contains(key); }
    bool is_list(const char* key) const { return table_.get(key) && table_.get(key)->is_array(); }
    bool is_table(const char* key) const { return table_.get(key) && table_.get(key)->is_table(); }
    bool is_text(const char* key) const { return table_.get(key) && table_.get(key)->is_string(); }

    /// The length of the first row of a list of rows; 0 if there is none.
    size_t row_length(const char* key) const;

    /// A number; a length is converted to mm.
    std::optional<double> number(const char* key, Measure measure);
    double number_or(const char* key, Measure measure, double otherwise) {
        return number(key, measure).value_or(otherwise);
    }
    std::optional<int> integer(const char* key);
    std::optional<std::string> string(const char* key);
    std::optional<bool> boolean(const char* key);

    /// A string that must be one of the given words.
    std::optional<std::string> word(const char* key, std::span<const std::string_view> words);
    std::optional<std::string> word(const char* key,
                                    std::initializer_list<std::string_view> words) {
        return word(key, std::span(words.begin(), words.size()));
    }

    /// A list of strings, of a fixed length unless `length` is 0.
    std::optional<std::vector<std::string>> strings(const char* key, size_t length);

    /// A list of numbers, of a fixed length unless `length` is 0.
    std::optional<std::vector<double>> numbers(const char* key, Measure measure, size_t length);
    std::optional<core::Vec3> vector(const char* key, Measure measure);

    /// A list of rows of numbers, each of the given length.
    std::vector<std::vector<double>> rows(const char* key, Measure measure, size_t length);

    /// Refuses numbers beyond `largest_number` either way, in all values of this table and of those
    /// in it, or in that of one key. The values `number` and `line` are not lengths and stay.
    void limit_numbers();
    void limit_numbers(const char* key);

    /// A nested table; empty if absent.
    std::optional<TableReader> table(const char* key, const std::string& name);

    /// The tables of a list of tables, as in `[[fixture]]`.
    std::vector<TableReader> tables(const char* key, const std::string& name);

    /// The names of all keys. Does not mark them as read.
    std::vector<std::string> keys() const;

    /// Marks a key as one that could have been given, for suggestions.
    void allow(const std::string& key) { known_.insert(key); }

    /// Records an error in the value of a key, unless there was one before.
    void refuse(const char* key, const std::string& why);

    /// Records an error of the table as a whole.
    void refuse_whole(const std::string& why) { refuse_at(table_.source(), why); }

    /// Records an error in another file that this one names.
    void refuse_with(const core::Error& error);

    /// Records that a key is missing.
    void need(const char* key);

    /// Refuses the first key that was never read.
    void finish();

    const std::string& name() const { return name_; }

    /// The line on which the table begins.
    uint32_t line() const { return table_.source().begin.line; }

private:
    const toml::node* node(const char* key);
    void refuse_at(const toml::source_region& where, const std::string& why);
    std::optional<double> finite(const toml::node& node, Measure measure) const;
    std::vector<double> finite_items(const toml::node& list, Measure measure) const;
    void limit_numbers(const toml::node& value, std::string_view key);

    const toml::table& table_;
    std::string name_;
    std::optional<core::Error>& error_;
    std::set<std::string> known_;
    gcode::LengthUnit unit_;
};

} // namespace app
