#include "app/setup/setup_update.h"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "app/base/text.h"
#include "app/setup/coverage.h"
#include "app/setup/setup_file.h"
#include "app/setup/setup_text.h"
#include "app/setup/stated_setup.h"
#include "app/setup/toml_file.h"
#include "gcode/language/canonical.h"

namespace app {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    for (size_t at = 0; at < text.size();) {
        const size_t end = text.find('\n', at);
        lines.push_back(text.substr(at, end - at));
        if (end == std::string::npos) break;
        at = end + 1;
    }
    return lines;
}

/// A statement that may be commented out, without its comment sign.
std::string uncommented(std::string_view line) {
    std::string left = trimmed(line);
    while (!left.empty() && left.front() == '#') left = trimmed(left.substr(1));
    return left;
}

/// Whether a line states an offset, in force or commented out.
bool is_entry_of(const std::string& line, const std::string& name) {
    const std::string statement = uncommented(line);
    std::string_view left = statement;
    if (!left.empty() && (left.front() == '"' || left.front() == '\'')) left.remove_prefix(1);
    if (!left.starts_with(name)) return false;
    left.remove_prefix(name.size());
    if (!left.empty() && (left.front() == '"' || left.front() == '\'')) left.remove_prefix(1);
    return trimmed(left).starts_with('=');
}

bool is_header(std::string_view line) { return uncommented(line).starts_with('['); }

/// The line after the last entry of `[offsets]`, in force or commented out; empty if there is none.
std::optional<size_t> end_of_offsets(const std::vector<std::string>& lines) {
    const auto begins = [](const std::string& line) {
        return uncommented(line).starts_with("[offsets]");
    };
    const auto header = std::find_if(lines.begin(), lines.end(), begins);
    if (header == lines.end()) return std::nullopt;
    const auto ends = [](const std::string& line) {
        return trimmed(line).empty() || is_header(line);
    };
    return std::find_if(header + 1, lines.end(), ends) - lines.begin();
}

/// The work offsets of the program that no line of the text mentions.
std::vector<size_t> new_offsets(const std::vector<std::string>& lines, const SetupFile& file) {
    std::vector<size_t> found;
    for (const size_t index : file.offsets_used) {
        const std::string name = offset_name(file, index);
        const bool is_stated = file.offsets_set.contains(static_cast<int>(index));
        const bool is_there =
            is_stated || std::any_of(lines.begin(), lines.end(), [&](const std::string& line) {
                return is_entry_of(line, name);
            });
        if (!is_there) found.push_back(index);
    }
    return found;
}

std::string joined(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    return text;
}

/// The text with the line ends of another one.
std::string with_line_ends_of(const std::string& text, const std::string& other) {
    if (other.find("\r\n") == std::string::npos) return text;
    std::string changed;
    for (const char c : text) changed += c == '\n' ? std::string("\r\n") : std::string(1, c);
    return changed;
}

void add_offsets(SetupUpdate& update, const SetupFile& file) {
    std::vector<std::string> lines = lines_of(update.text);
    const std::vector<size_t> offsets = new_offsets(lines, file);
    if (offsets.empty()) return;
    std::vector<std::string> added;
    for (const size_t index : offsets) {
        std::string line = offset_line(file, index);
        line.pop_back();
        added.push_back(std::move(line));
        if (update.text.find("\r\n") != std::string::npos) added.back() += '\r';
        update.added.push_back("work offset " + offset_name(file, index)
                               + ", commented out because nobody has stated it");
    }
    if (const auto at = end_of_offsets(lines)) {
        lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(*at), added.begin(), added.end());
        update.text = joined(lines);
        return;
    }
    std::string table = offsets_header();
    for (const size_t index : offsets) table += offset_line(file, index);
    update.text += with_line_ends_of(table, update.text);
}

void add_stock(SetupUpdate& update, const SetupFile& file, const StatedSetup& stated) {
    const bool program_states_it = file.needs_stock && file.stock_known == Known::described;
    if (stated.stock || !program_states_it) return;
    const std::string table = stock_text(file, {});
    if (table.empty()) return;
    update.text += with_line_ends_of(table, update.text);
    update.added.push_back("stock");
}

void add_tools(SetupUpdate& update, const SetupFile& file, const StatedSetup& stated) {
    for (const auto& [number, found] : file.found_tools) {
        if (stated.has_tool(number) || file.library.contains(number)) continue;
        update.text += with_line_ends_of(tool_text(file, number), update.text);
        update.added.push_back(
            fmt::format("tool {}, according to {}", core::value_of(number), found.source));
    }
}

void list_unused(SetupUpdate& update, const SetupFile& file, const StatedSetup& stated) {
    for (const core::ToolNumber number : stated.tools)
        if (!file.tools_used.empty() && !file.tools_used.contains(number))
            update.unused.push_back(fmt::format("tool {}", core::value_of(number)));
    for (const int index : file.offsets_set)
        if (!file.offsets_used.contains(static_cast<size_t>(index)))
            update.unused.push_back("work offset "
                                    + gcode::name_of_offset(static_cast<size_t>(index)));
}

/// Whether a set-up states all that another one states, with the same values; new tools are at the
/// end of their list.
bool contains_all(const toml::table& after, const toml::table& before) {
    for (const auto& [key, value] : before) {
        const toml::node* now = after.get(key.str());
        if (!now) return false;
        if (key.str() == "tool" && now->is_array() && value.is_array()) {
            toml::array first;
            for (size_t i = 0; i < std::min(now->as_array()->size(), value.as_array()->size()); ++i)
                first.push_back(*now->as_array()->get(i)->as_table());
            if (first != *value.as_array()) return false;
        } else {
            toml::table one, two;
            one.insert(key.str(), *now);
            two.insert(key.str(), value);
            if (one != two) return false;
        }
    }
    return true;
}

} // namespace

core::Result<SetupUpdate> updated_setup(const std::string& text, const SetupFile& file) {
    FEELER_TRY(const toml::table before, parsed_toml(text));
    const StatedSetup stated = stated_in(text);
    SetupUpdate update{text, {}, {}};
    if (!text.empty() && text.back() != '\n') update.text += with_line_ends_of("\n", text);
    add_offsets(update, file);
    add_stock(update, file, stated);
    add_tools(update, file, stated);
    list_unused(update, file, stated);
    if (update.added.empty()) update.text = text;
    const auto after = parsed_toml(update.text);
    if (!after || !contains_all(*after, before))
        return tl::unexpected<core::Error>(
            {core::ErrorCode::unsupported,
             {},
             "nothing can be added to this file: write the tools as [[tool]] and the work offsets "
             "as [offsets]"});
    return update;
}

} // namespace app
