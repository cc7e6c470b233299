#pragma once

#include <array>
#include <initializer_list>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <toml++/toml.h>

#include "core/base/result.h"
#include "core/base/vec.h"

namespace app {

/// Reads a TOML table key by key and refuses what nobody asked for.
///
/// The first mistake is kept, with its place, and every later reading gives nothing; so a caller
/// reads what it needs and looks at the error once, at the end.
class TableReader {
public:
    /// `name` is how messages call the table: `[stock]`. `error` outlives the reader.
    TableReader(const toml::table& table, std::string name, std::optional<core::Error>& error)
        : table_(table), name_(std::move(name)), error_(error) {}

    bool has(const char* key) const { return table_.contains(key); }
    bool is_list(const char* key) const { return table_.get(key) && table_.get(key)->is_array(); }
    bool is_text(const char* key) const { return table_.get(key) && table_.get(key)->is_string(); }

    /// How long the first row of a list of rows is; 0 when there is none.
    size_t row_length(const char* key) const;

    std::optional<double> number(const char* key);
    double number_or(const char* key, double otherwise) { return number(key).value_or(otherwise); }
    std::optional<int> integer(const char* key);
    std::optional<std::string> string(const char* key);
    std::optional<bool> boolean(const char* key);

    /// One of a few words.
    std::optional<std::string> word(const char* key, std::span<const char* const> words);
    std::optional<std::string> word(const char* key, std::initializer_list<const char*> words) {
        return word(key, std::span(words.begin(), words.size()));
    }

    /// A list of texts, of a fixed length unless `length` is 0.
    std::optional<std::vector<std::string>> strings(const char* key, size_t length);

    /// A list of numbers, of a fixed length unless `length` is 0.
    std::optional<std::vector<double>> numbers(const char* key, size_t length);
    std::optional<core::Vec3> vector(const char* key);

    /// A list of rows of numbers, each of the given length.
    std::vector<std::vector<double>> rows(const char* key, size_t length);

    /// A table in the table; empty when it is absent.
    std::optional<TableReader> table(const char* key, const std::string& name);

    /// The tables of a list of tables, as in `[[fixture]]`.
    std::vector<TableReader> tables(const char* key, const std::string& name);

    /// Names of all keys, none of which counts as read by this.
    std::vector<std::string> keys() const;

    /// Notes a mistake in the value of a key, unless there was one before.
    void refuse(const char* key, const std::string& why);

    /// Notes a mistake of the table as a whole.
    void refuse_whole(const std::string& why) { refuse_at(table_.source(), why); }

    /// Notes a mistake in another file that this one names.
    void refuse_with(const core::Error& error);

    /// Notes that a key is missing.
    void need(const char* key);

    /// Refuses the first key that was never asked for.
    void finish();

    const std::string& name() const { return name_; }

    /// Where the table begins in its file.
    uint32_t line() const { return table_.source().begin.line; }

private:
    const toml::node* node(const char* key);
    void refuse_at(const toml::source_region& where, const std::string& why);

    const toml::table& table_;
    std::string name_;
    std::optional<core::Error>& error_;
    std::set<std::string> known_;
};

} // namespace app
