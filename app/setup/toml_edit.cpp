#include "app/setup/toml_edit.h"

#include <algorithm>
#include <cassert>
#include <functional>
#include <memory>
#include <optional>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "app/setup/setup_text.h"
#include "app/setup/toml_file.h"

namespace app {
namespace {

using core::ErrorCode;
using Step = TomlPath::Step;

/// A range of bytes of the text.
struct TextRange {
    size_t begin = 0, end = 0;
};

bool is_key_step(const Step& step) { return std::holds_alternative<std::string>(step); }

/// The node at the first `count` steps of a path; null if there is none.
template <typename Node>
Node* node_at(Node& root, const std::vector<Step>& steps, size_t count) {
    Node* node = &root;
    for (size_t i = 0; i < count && node; ++i) {
        if (is_key_step(steps[i])) {
            auto* table = node->as_table();
            node = table ? table->get(std::get<std::string>(steps[i])) : nullptr;
        } else {
            auto* list = node->as_array();
            node = list ? list->get(std::get<size_t>(steps[i])) : nullptr;
        }
    }
    return node;
}

template <typename Node>
Node* node_at(Node& root, const TomlPath& path) {
    return node_at(root, path.steps(), path.steps().size());
}

/// A key as TOML: bare if it can be.
std::string toml_key(const std::string& key) {
    const auto is_bare = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9')
               || c == '_' || c == '-';
    };
    if (!key.empty() && std::all_of(key.begin(), key.end(), is_bare)) return key;
    return toml_text(key);
}

std::string dotted(const std::vector<Step>& steps, size_t first, size_t end) {
    std::string text;
    for (size_t i = first; i < end; ++i)
        text += (text.empty() ? "" : ".") + toml_key(std::get<std::string>(steps[i]));
    return text;
}

bool is_list_of_tables(const toml::array& list) {
    return !list.empty() && std::all_of(list.begin(), list.end(), [](const toml::node& node) {
        return node.is_table();
    });
}

/// A TOML file as text and as values.
class TomlText {
public:
    TomlText(std::string text, toml::table root) : text_(std::move(text)), root_(std::move(root)) {
        size_t at = 0;
        while (at != std::string::npos) {
            lines_.push_back(at);
            at = text_.find('\n', at);
            if (at != std::string::npos) ++at;
        }
    }

    const std::string& text() const { return text_; }
    const toml::table& root() const { return root_; }
    const char* line_end() const { return text_.find("\r\n") == std::string::npos ? "\n" : "\r\n"; }

    /// The byte of a position, whose columns count characters.
    size_t byte_of(const toml::source_position& at) const {
        if (at.line == 0 || at.line > lines_.size()) return text_.size();
        size_t byte = lines_[at.line - 1];
        if (at.line == 1 && text_.starts_with("\xEF\xBB\xBF")) byte += 3;
        for (uint32_t column = 1; column < at.column && byte < text_.size(); ++column) {
            ++byte;
            while (byte < text_.size() && (static_cast<unsigned char>(text_[byte]) & 0xC0U) == 0x80)
                ++byte;
        }
        return byte;
    }
    TextRange range_of(const toml::node& node) const {
        return {byte_of(node.source().begin), byte_of(node.source().end)};
    }

    /// The beginning of the line of a byte, and that of the next line.
    size_t line_start(size_t byte) const {
        const size_t before = byte == 0 ? std::string::npos : text_.rfind('\n', byte - 1);
        return before == std::string::npos ? 0 : before + 1;
    }
    size_t next_line(size_t byte) const {
        const size_t end = text_.find('\n', byte);
        return end == std::string::npos ? text_.size() : end + 1;
    }
    std::string_view line_at(size_t start) const {
        return std::string_view(text_).substr(start, next_line(start) - start);
    }
    /// The spaces at the beginning of a line.
    std::string indent_at(size_t byte) const {
        const size_t start = line_start(byte);
        size_t end = start;
        while (end < text_.size() && (text_[end] == ' ' || text_[end] == '\t')) ++end;
        return text_.substr(start, end - start);
    }

    /// Whether a table has a header of its own, `[name]` or `[[name]]`.
    bool has_header(const toml::table& table) const {
        if (&table == &root_ || table.is_inline()) return false;
        const size_t at = byte_of(table.source().begin);
        if (at >= text_.size() || text_[at] != '[') return false;
        for (const auto& [key, value] : table) { // the header of [a.b] is also the source of a
            const bool holds_tables =
                value.is_table() || (value.is_array() && is_list_of_tables(*value.as_array()));
            if (holds_tables && value.source().begin == table.source().begin) return false;
        }
        return true;
    }
    /// Whether a node is written with headers: a table, or a list of tables.
    bool is_block(const toml::node& node) const {
        if (const toml::table* table = node.as_table())
            return !table->is_inline() && byte_of(table->source().begin) < text_.size()
                   && text_[byte_of(table->source().begin)] == '[';
        const toml::array* list = node.as_array();
        return list && is_list_of_tables(*list) && is_block(*list->get(0));
    }

    /// The headers of a node: its own and those of the tables in it, in order.
    std::vector<size_t> headers_of(const toml::node& node) const {
        std::vector<size_t> headers;
        add_headers(node, headers);
        std::sort(headers.begin(), headers.end());
        return headers;
    }
    /// The lines of the table that begins with a header, to the last line with a value.
    TextRange block_at(size_t header) const {
        const std::vector<size_t> all = headers_of(root_);
        const auto next = std::upper_bound(all.begin(), all.end(), header);
        const size_t limit = next == all.end() ? text_.size() : line_start(*next);
        TextRange block{line_start(header), next_line(header)};
        for (size_t start = block.end; start < limit; start = next_line(start))
            if (!is_blank_or_comment(line_at(start))) block.end = next_line(start);
        block.end = std::min(std::max(block.end, values_end(header)), limit);
        return block;
    }
    /// The beginning of the comments directly above a line. Those at the beginning of the file
    /// belong to the file.
    size_t with_comments_above(size_t start) const {
        size_t first = start;
        while (first > 0) {
            const size_t above = line_start(first - 1);
            const std::string_view line = line_at(above);
            const size_t text = line.find_first_not_of(" \t");
            if (text == std::string_view::npos || line[text] != '#') break;
            first = above;
        }
        return first == 0 ? start : first;
    }

private:
    static bool is_blank_or_comment(std::string_view line) {
        const size_t at = line.find_first_not_of(" \t\r\n");
        return at == std::string_view::npos || line[at] == '#';
    }
    void add_headers(const toml::node& node, std::vector<size_t>& headers) const {
        if (const toml::table* table = node.as_table()) {
            if (table->is_inline()) return;
            if (has_header(*table)) headers.push_back(byte_of(table->source().begin));
            for (const auto& [key, value] : *table) add_headers(value, headers);
        } else if (const toml::array* list = node.as_array()) {
            for (const toml::node& value : *list) add_headers(value, headers);
        }
    }
    /// The end of the last line of the values of the table at a header: a comment may be inside a
    /// list that takes several lines.
    size_t values_end(size_t header) const {
        const toml::table* table = table_at(root_, header);
        size_t end = 0;
        if (table)
            visit_values(*table, [&](const toml::key&, const toml::node& value) {
                end = std::max(end, next_line(range_of(value).end - 1));
            });
        return end;
    }
    const toml::table* table_at(const toml::node& node, size_t header) const {
        if (const toml::table* table = node.as_table()) {
            if (has_header(*table) && byte_of(table->source().begin) == header) return table;
            for (const auto& [key, value] : *table)
                if (const toml::table* found = table_at(value, header)) return found;
        } else if (const toml::array* list = node.as_array()) {
            for (const toml::node& value : *list)
                if (const toml::table* found = table_at(value, header)) return found;
        }
        return nullptr;
    }

public:
    /// Visits the values that are written under the header of a table, with dotted keys too.
    template <typename See>
    void visit_values(const toml::table& table, const See& see) const {
        for (const auto& [key, value] : table) {
            if (is_block(value)) continue;
            const toml::table* inner = value.as_table();
            if (inner && !inner->is_inline())
                visit_values(*inner, see);
            else
                see(key, value);
        }
    }

private:
    std::string text_;
    toml::table root_;
    std::vector<size_t> lines_; // their first bytes
};

const toml::node* node_in(const TomlText& file, const std::vector<Step>& steps, size_t count) {
    return node_at<const toml::node>(file.root(), steps, count);
}

const toml::node* node_in(const TomlText& file, const TomlPath& path) {
    return node_in(file, path.steps(), path.steps().size());
}

core::Result<TomlText> read(const std::string& text) {
    FEELER_TRY(toml::table root, parsed_toml(text));
    return TomlText(text, std::move(root));
}

tl::unexpected<core::Error> cannot_edit(const TomlText& file, const TomlPath& path) {
    const std::vector<Step>& steps = path.steps();
    size_t known = steps.size();
    while (known > 0 && !node_in(file, steps, known)) --known;
    const toml::node* node = node_in(file, steps, known);
    return core::fail(
        ErrorCode::unsupported,
        fmt::format("{} is written in a form that cannot be edited here: edit the file by hand",
                    text_of(path)),
        {node ? node->source().begin.line : 0, 0, 0});
}

/// The new text, if it has the intended values.
core::Result<std::string> verified(const TomlText& before, const TomlPath& path, std::string text,
                                   const toml::table& wanted) {
    const auto read = parsed_toml(text);
    if (!read || !(*read == wanted)) return cannot_edit(before, path);
    return text;
}

/// A value from its text; null if it is not valid.
std::unique_ptr<toml::table> table_with(const std::string& value) {
    auto parsed = parsed_toml("value = " + value);
    return parsed && parsed->size() == 1 ? std::make_unique<toml::table>(*std::move(parsed))
                                         : nullptr;
}

/// Puts a value into the tree, with the missing tables on its way. Whether that was possible.
bool put(toml::table& root, const std::vector<Step>& steps, const toml::node& value) {
    toml::node* node = &root;
    for (size_t i = 0; i + 1 < steps.size(); ++i) {
        toml::node* next = nullptr;
        if (is_key_step(steps[i])) {
            toml::table* table = node->as_table();
            if (!table) return false;
            const std::string& key = std::get<std::string>(steps[i]);
            if (!table->contains(key)) table->insert(key, toml::table{});
            next = table->get(key);
        } else if (toml::array* list = node->as_array()) {
            next = list->get(std::get<size_t>(steps[i]));
        }
        if (!next) return false;
        node = next;
    }
    if (const auto* key = std::get_if<std::string>(&steps.back())) {
        toml::table* table = node->as_table();
        if (!table) return false;
        value.visit([&](const auto& v) { table->insert_or_assign(*key, v); });
        return true;
    }
    toml::array* list = node->as_array();
    const size_t index = std::get<size_t>(steps.back());
    if (!list || index >= list->size()) return false;
    value.visit([&](const auto& v) { list->replace(list->cbegin() + ptrdiff_t(index), v); });
    return true;
}

std::string inserted(const std::string& text, size_t at, const std::string& what) {
    return text.substr(0, at) + what + text.substr(at);
}

/// Inserts lines at the beginning of a line, or at the end of a text whose last line may have no
/// end.
std::string with_lines(const TomlText& file, size_t at, const std::string& lines) {
    const std::string& text = file.text();
    const bool needs_end = at == text.size() && !text.empty() && text.back() != '\n';
    return inserted(text, at, (needs_end ? file.line_end() : "") + lines);
}

/// The position for a new line of a table, and its indentation.
std::pair<size_t, std::string> end_of_values(const TomlText& file, const toml::table& table) {
    size_t end = 0;
    std::string indent;
    file.visit_values(table, [&](const toml::key& key, const toml::node& value) {
        const size_t after = file.next_line(file.range_of(value).end - 1);
        if (after < end) return;
        end = after;
        indent = file.indent_at(file.byte_of(key.source().begin));
    });
    if (end > 0) return {end, indent};
    if (file.has_header(table)) {
        const size_t header = file.byte_of(table.source().begin);
        return {file.next_line(header), file.indent_at(header)};
    }
    const std::vector<size_t> headers = file.headers_of(table);
    if (headers.empty()) return {file.text().size(), ""};
    const size_t first = file.line_start(headers.front());
    return {file.with_comments_above(first), ""};
}

/// Inserts a key into `{ ... }`.
std::string with_inline_key(const TomlText& file, const toml::table& table,
                            const std::string& line) {
    const std::string& text = file.text();
    size_t close = file.range_of(table).end - 1;
    while (close > 0 && (text[close - 1] == ' ' || text[close - 1] == '\t')) --close;
    return table.empty() ? inserted(text, close, " " + line + " ")
                         : inserted(text, close, ", " + line);
}

/// A table with a header at the end of the file, for its first value.
std::string with_new_header(const TomlText& file, const TomlPath& path, const std::string& value) {
    const std::vector<Step>& steps = path.steps();
    const std::string end = file.line_end();
    const std::string lines = "[" + dotted(steps, 0, steps.size() - 1) + "]" + end
                              + toml_key(path.key()) + " = " + value + end;
    return with_lines(file, file.text().size(), (file.text().empty() ? "" : end) + lines);
}

/// `beside`: the table after whose values the line goes.
std::string with_new_line(const TomlText& file, const toml::table& beside, std::string line) {
    const auto [at, indent] = end_of_values(file, beside);
    line = indent + line + file.line_end();
    const size_t text = file.text().find_first_not_of(" \t", at);
    const bool precedes_header = &beside == &file.root() && text != std::string::npos
                                 && (file.text()[text] == '[' || file.text()[text] == '#');
    return with_lines(file, at, line + (precedes_header ? file.line_end() : ""));
}

/// The text with a value that it did not have; empty if it cannot take it.
std::optional<std::string> with_new_value(const TomlText& file, const TomlPath& path,
                                          const std::string& value) {
    const std::vector<Step>& steps = path.steps();
    const toml::table* table = nullptr; // the nearest one that can take a line
    size_t known = steps.size();
    while (!table && known > 0) {
        const toml::node* node = node_in(file, steps, --known);
        table = node ? node->as_table() : nullptr;
        const bool takes_lines =
            table && (known == 0 || table->is_inline() || file.has_header(*table));
        if (!takes_lines) table = nullptr;
    }
    if (!table || !std::all_of(steps.begin() + ptrdiff_t(known), steps.end(), is_key_step))
        return std::nullopt;
    const std::string line = dotted(steps, known, steps.size()) + " = " + value;
    if (table->is_inline()) return with_inline_key(file, *table, line);
    const toml::node* next = node_in(file, steps, known + 1);
    const bool has_dotted_keys = next && !file.is_block(*next);
    if (known == 0 && steps.size() > 1 && !has_dotted_keys)
        return with_new_header(file, path, value);
    const toml::table* beside = table;
    for (size_t i = known + 1; i < steps.size() && has_dotted_keys; ++i)
        if (const toml::node* inner = node_in(file, steps, i); inner && inner->is_table())
            beside = inner->as_table();
    return with_new_line(file, *beside, line);
}

/// Removes ranges, which do not overlap, and one of two blank lines where they were.
std::string without_ranges(const std::string& text, std::vector<TextRange> ranges) {
    std::sort(ranges.begin(), ranges.end(),
              [](const TextRange& a, const TextRange& b) { return a.begin > b.begin; });
    std::string left = text;
    for (const TextRange& range : ranges) {
        left.erase(range.begin, range.end - range.begin);
        const auto is_blank_at = [&](size_t at) {
            return left.compare(at, 1, "\n") == 0 || left.compare(at, 2, "\r\n") == 0;
        };
        const bool after_blank = range.begin == 0
                                 || (range.begin >= 2 && left[range.begin - 1] == '\n'
                                     && (left[range.begin - 2] == '\n'
                                         || (range.begin >= 3 && left[range.begin - 2] == '\r'
                                             && left[range.begin - 3] == '\n')));
        const bool at_end = range.begin >= left.size();
        if (after_blank && !at_end && is_blank_at(range.begin)) {
            left.erase(range.begin, left[range.begin] == '\r' ? 2 : 1);
        } else if (after_blank && at_end && range.begin > 0) {
            left.erase(range.begin - (left.ends_with("\r\n") ? 2 : 1));
        }
    }
    return left;
}

/// The range of a key with its value: whole lines where they hold nothing else.
TextRange range_of_key(const TomlText& file, const toml::key& key, const toml::node& value) {
    const std::string& text = file.text();
    TextRange range{file.byte_of(key.source().begin), file.range_of(value).end};
    while (range.begin > 0) { // the beginning of a dotted key
        const char before = text[range.begin - 1];
        if (before == '\n' || before == '{' || before == ',') break;
        --range.begin;
    }
    const bool begins_line = range.begin == 0 || text[range.begin - 1] == '\n';
    if (begins_line) return {range.begin, file.next_line(range.end - 1)};
    size_t after = range.end;
    while (after < text.size() && (text[after] == ' ' || text[after] == '\t')) ++after;
    if (after < text.size() && text[after] == ',')
        range.end = after + 1; // the first or a middle one
    else if (text[range.begin - 1] == ',')
        --range.begin; // the last one
    return range;
}

const toml::key* key_object(const toml::table& table, const std::string& name) {
    for (const auto& [key, value] : table)
        if (key == name) return &key;
    return nullptr;
}

std::vector<TextRange> ranges_of(const TomlText& file, const TomlPath& path,
                                 const toml::node& node) {
    std::vector<TextRange> ranges;
    const toml::table* table = node.as_table();
    const auto add_block = [&](size_t header) {
        TextRange block = file.block_at(header);
        block.begin = file.with_comments_above(block.begin);
        ranges.push_back(block);
    };
    for (const size_t header : file.headers_of(node)) add_block(header);
    if (!ranges.empty()) return ranges;
    if (table && !table->is_inline()) { // made by dotted keys
        file.visit_values(*table, [&](const toml::key& key, const toml::node& value) {
            ranges.push_back(range_of_key(file, key, value));
        });
        return ranges;
    }
    const toml::node* above = node_in(file, path.parent());
    const toml::table* owner = above ? above->as_table() : nullptr;
    if (const toml::key* key = owner ? key_object(*owner, path.key()) : nullptr)
        ranges.push_back(range_of_key(file, *key, node));
    return ranges;
}

void take_out(toml::table& root, const TomlPath& path) {
    toml::node* above = node_at<toml::node>(root, path.parent());
    if (toml::table* table = above->as_table())
        table->erase(path.key());
    else if (toml::array* list = above->as_array())
        list->erase(list->cbegin() + ptrdiff_t(std::get<size_t>(path.steps().back())));
}

/// Whether two trees are equal, apart from empty tables and lists, for which the text has no line.
bool same_values(const toml::table& a, const toml::table& b);

bool is_void(const toml::node& node) {
    const toml::array* list = node.as_array();
    const toml::table* table = node.as_table();
    if (list) return list->empty();
    return table && std::all_of(table->begin(), table->end(), [](const auto& entry) {
               return is_void(entry.second);
           });
}

bool same_node(const toml::node& a, const toml::node& b) {
    if (a.is_table() && b.is_table()) return same_values(*a.as_table(), *b.as_table());
    const toml::array *one = a.as_array(), *two = b.as_array();
    if (one && two)
        return std::equal(one->begin(), one->end(), two->begin(), two->end(), same_node);
    return a.visit([&](const auto& left) {
        return b.visit([&](const auto& right) {
            if constexpr (std::is_same_v<decltype(left), decltype(right)>)
                return left == right;
            else
                return false;
        });
    });
}

bool same_values(const toml::table& a, const toml::table& b) {
    const auto holds = [](const toml::table& outer, const toml::table& inner) {
        return std::all_of(inner.begin(), inner.end(), [&](const auto& entry) {
            const toml::node* found = outer.get(entry.first);
            return found ? same_node(*found, entry.second) : is_void(entry.second);
        });
    };
    return holds(a, b) && holds(b, a);
}

/// Whether two values are equal, apart from their spelling: 1, 1.0 and 1.00 are.
bool means_the_same(const toml::node& a, const toml::node& b) {
    if (a.is_number() && b.is_number()) return a.value<double>() == b.value<double>();
    return same_node(a, b);
}

/// A change of the text of one scalar.
struct ScalarChange {
    TextRange range; // in the old text
    std::string text;
};

/// Collects the scalars that differ between two values. Whether the values have the same form: the
/// same lists and tables with as many scalars at the same places.
bool add_changes(const TomlText& before, const toml::node& old, const TomlText& after,
                 const toml::node& wanted, std::vector<ScalarChange>& changes) {
    const toml::array* lists[] = {old.as_array(), wanted.as_array()};
    const toml::table* tables[] = {old.as_table(), wanted.as_table()};
    if (lists[0] && lists[1])
        return std::equal(lists[0]->begin(), lists[0]->end(), lists[1]->begin(), lists[1]->end(),
                          [&](const toml::node& one, const toml::node& two) {
                              return add_changes(before, one, after, two, changes);
                          });
    if (tables[0] && tables[1])
        return tables[0]->size() == tables[1]->size()
               && std::all_of(tables[0]->begin(), tables[0]->end(), [&](const auto& entry) {
                      const toml::node* found = tables[1]->get(entry.first);
                      return found && add_changes(before, entry.second, after, *found, changes);
                  });
    if (lists[0] || lists[1] || tables[0] || tables[1]) return false;
    if (means_the_same(old, wanted)) return true;
    const TextRange range = after.range_of(wanted);
    changes.push_back(
        {before.range_of(old), after.text().substr(range.begin, range.end - range.begin)});
    return true;
}

std::string with_changes(const std::string& text, std::vector<ScalarChange> changes) {
    std::sort(changes.begin(), changes.end(), [](const ScalarChange& a, const ScalarChange& b) {
        return a.range.begin < b.range.begin;
    });
    std::string changed;
    size_t at = 0;
    for (const ScalarChange& change : changes) {
        changed += text.substr(at, change.range.begin - at) + change.text;
        at = change.range.end;
    }
    return changed + text.substr(at);
}

/// A new value in the form of the text of the old one: with its comments, line ends and alignment,
/// and with its spelling of scalars that stay. The new value itself if the forms differ.
std::string in_form_of(const std::string& old, const std::string& value) {
    const auto before = read("value = " + old), after = read("value = " + value);
    if (!before || !after) return value;
    const auto* from = before->root().get("value");
    const auto* to = after->root().get("value");
    std::vector<ScalarChange> changes;
    if (!from || !to || !add_changes(*before, *from, *after, *to, changes)) return value;
    const std::string kept = with_changes(before->text(), std::move(changes));
    const auto read_again = parsed_toml(kept);
    std::vector<ScalarChange> left;
    const auto again = read_again ? std::optional(TomlText(kept, *read_again)) : std::nullopt;
    const bool is_right = again && again->root().size() == 1 && again->root().get("value")
                          && add_changes(*again, *again->root().get("value"), *after, *to, left)
                          && left.empty();
    return is_right ? kept.substr(kept.find('=') + 2) : value;
}

/// The text of a table as `{ ... }` in one line.
std::string inline_text(toml::table table) {
    const std::function<void(toml::node&)> make_inline = [&](toml::node& node) {
        if (toml::table* inner = node.as_table()) {
            inner->is_inline(true);
            for (auto&& [key, value] : *inner) make_inline(value);
        } else if (toml::array* list = node.as_array()) {
            for (toml::node& value : *list) make_inline(value);
        }
    };
    make_inline(table);
    std::ostringstream text;
    text << table;
    return text.str();
}

} // namespace

TomlPath TomlPath::operator/(Step step) const {
    TomlPath longer = *this;
    longer.steps_.push_back(std::move(step));
    return longer;
}

TomlPath TomlPath::parent() const {
    assert(!steps_.empty());
    TomlPath shorter = *this;
    shorter.steps_.pop_back();
    return shorter;
}

std::string TomlPath::key() const {
    return !steps_.empty() && is_key_step(steps_.back()) ? std::get<std::string>(steps_.back())
                                                         : std::string();
}

std::string text_of(const TomlPath& path) {
    std::string text;
    for (const Step& step : path.steps())
        text += is_key_step(step)
                    ? (text.empty() ? "" : ".") + toml_key(std::get<std::string>(step))
                    : fmt::format("[{}]", std::get<size_t>(step));
    return text;
}

core::Result<std::string> toml_with_value(const std::string& text, const TomlPath& path,
                                          const std::string& value) {
    assert(!path.empty());
    auto parsed = table_with(value);
    if (!parsed)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{} is not a valid value for {}", value, text_of(path)));
    FEELER_TRY(const TomlText file, read(text));
    toml::table wanted = file.root();
    std::optional<std::string> edited;
    if (const toml::node* old = node_in(file, path)) {
        const toml::table* table = old->as_table();
        if (file.is_block(*old) || (table && !table->is_inline())) return cannot_edit(file, path);
        const TextRange range = file.range_of(*old);
        const std::string formed =
            in_form_of(text.substr(range.begin, range.end - range.begin), value);
        parsed = table_with(formed);
        edited = text.substr(0, range.begin) + formed + text.substr(range.end);
    } else {
        edited = with_new_value(file, path, value);
    }
    if (!edited || !parsed || !put(wanted, path.steps(), *parsed->get("value")))
        return cannot_edit(file, path);
    return verified(file, path, *std::move(edited), wanted);
}

core::Result<std::string> toml_without(const std::string& text, const TomlPath& path) {
    assert(!path.empty());
    FEELER_TRY(const TomlText file, read(text));
    const toml::node* node = node_in(file, path);
    if (!node) return text;
    toml::table wanted = file.root();
    take_out(wanted, path);
    std::vector<TextRange> ranges = ranges_of(file, path, *node);
    if (ranges.empty()) return cannot_edit(file, path);
    std::string left = without_ranges(text, std::move(ranges));
    const auto read_again = parsed_toml(left);
    if (!read_again || !same_values(*read_again, wanted)) return cannot_edit(file, path);
    return left;
}

core::Result<std::string> toml_with_table(const std::string& text, const std::string& list,
                                          const std::string& body) {
    const TomlPath path{list};
    const std::string header = "[[" + toml_key(list) + "]]";
    auto parsed = parsed_toml(header + "\n" + body);
    if (!parsed)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("not a valid {}: {}", header, parsed.error().message));
    FEELER_TRY(const TomlText file, read(text));
    toml::table wanted = file.root();
    const toml::table& element = *parsed->get(list)->as_array()->get(0)->as_table();
    if (!wanted.contains(list)) wanted.insert(list, toml::array{});
    if (!wanted.get(list)->is_array()) return cannot_edit(file, path);
    wanted.get(list)->as_array()->push_back(element);
    const toml::node* old = file.root().get(list);
    const std::string end = file.line_end();
    if (old && !file.is_block(*old)) {
        const size_t close = file.range_of(*old).end - 1;
        const bool is_first = old->as_array()->empty();
        return verified(file, path,
                        inserted(text, close, (is_first ? "" : ", ") + inline_text(element)),
                        wanted);
    }
    std::string lines;
    for (const char c : header + "\n" + body) lines += c == '\n' ? end : std::string(1, c);
    if (!lines.ends_with(end)) lines += end;
    size_t at = text.size();
    if (old) at = file.block_at(file.headers_of(*old).back()).end;
    const bool needs_blank = at > 0;
    const bool is_last = text.find_first_not_of(" \t\r\n", at) == std::string::npos;
    return verified(file, path,
                    with_lines(file, is_last ? text.size() : at, (needs_blank ? end : "") + lines),
                    wanted);
}

core::Result<std::string> toml_body_of(const std::string& text, const std::string& list,
                                       size_t index) {
    FEELER_TRY(const TomlText file, read(text));
    const toml::node* node = node_in(file, {list, index});
    if (!node || !node->is_table()) return std::string();
    if (!file.is_block(*node)) {
        std::ostringstream body;
        toml::table table = *node->as_table();
        table.is_inline(false);
        body << table << "\n";
        return body.str();
    }
    std::string body;
    for (const size_t header : file.headers_of(*node)) {
        const TextRange block = file.block_at(header);
        const size_t begin = body.empty() ? file.next_line(header) : block.begin;
        body += text.substr(begin, block.end - begin);
        if (!body.empty() && body.back() != '\n') body += '\n';
    }
    return body;
}

bool toml_has(const std::string& text, const TomlPath& path) {
    const auto root = parsed_toml(text);
    return root && node_at<const toml::node>(*root, path);
}

core::SourceSpan toml_span(const std::string& text, const TomlPath& path) {
    const auto root = parsed_toml(text);
    const toml::node* node = root ? node_at<const toml::node>(*root, path) : nullptr;
    if (!node) return {};
    const auto [begin, end] = std::pair(node->source().begin, node->source().end);
    return {begin.line, begin.column, begin.line == end.line ? end.column - begin.column : 0};
}

} // namespace app
