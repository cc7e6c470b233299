#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/base/result.h"

namespace app {

/// The place of a value in a TOML file: keys, and indices of the elements of lists, from the root.
class TomlPath {
public:
    using Step = std::variant<std::string, size_t>;

    TomlPath() = default;
    TomlPath(std::initializer_list<Step> steps) : steps_(steps) {}
    TomlPath(const char* key) : steps_{std::string(key)} {}

    const std::vector<Step>& steps() const { return steps_; }
    bool empty() const { return steps_.empty(); }
    /// The path of a value inside this one.
    TomlPath operator/(Step step) const;
    /// The path without its last step; not for an empty path.
    TomlPath parent() const;
    /// The last key; empty for an element of a list.
    std::string key() const;

    bool operator==(const TomlPath&) const = default;

private:
    std::vector<Step> steps_;
};

/// The path in words: `fixture[1].at`.
std::string text_of(const TomlPath& path);

/// Functions that edit the text of a TOML file. They change only the lines of the edited value: all
/// other lines stay as they are, with their comments, order, indentation and line ends. The result
/// is parsed again and compared with the intended values.
///
/// Errors of all of them: syntax of the text, with line and column; invalid_value if a new value is
/// not TOML; unsupported, with the line, if the file has a form that cannot be edited in this way.

/// Sets a value. Replaces the old one; otherwise adds a line at the end of its table, and the table
/// at the end of the file if it is missing. Of an old value with the same lists and tables and as
/// many scalars, only the scalars change that differ: comments, line breaks and the spelling of the
/// others stay, such as 1.50 for 1.5.
///
/// `value`: as TOML, such as "2.5", "\"G54\"" or "{ X = 1 }".
core::Result<std::string> toml_with_value(const std::string& text, const TomlPath& path,
                                          const std::string& value);

/// Removes a value, a table or an element of a list of tables, with the comments that belong to it:
/// those in its lines, and those directly above a table. Text without this value is returned as it
/// is.
core::Result<std::string> toml_without(const std::string& text, const TomlPath& path);

/// Adds a table to the end of a list of tables, such as `[[fixture]]`.
///
/// `body`: the lines of the table without its header.
core::Result<std::string> toml_with_table(const std::string& text, const std::string& list,
                                          const std::string& body);

/// The lines of an element of a list of tables, without its header, as an argument of
/// toml_with_table; with its nested tables. Empty if there is no such element.
core::Result<std::string> toml_body_of(const std::string& text, const std::string& list,
                                       size_t index);

/// Whether a text has a value; false if it is not TOML.
bool toml_has(const std::string& text, const TomlPath& path);

/// The line of a value, and its column and length if it is on one line; all 0 if there is none.
core::SourceSpan toml_span(const std::string& text, const TomlPath& path);

} // namespace app
