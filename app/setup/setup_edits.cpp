#include "app/setup/setup_edits.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/setup/setup_file.h"
#include "app/setup/setup_text.h"
#include "app/setup/toml_file.h"
#include "app/setup/tool_table.h"
#include "core/base/vec.h"
#include "core/sim/clearance.h"

namespace app {
namespace {

constexpr double largest_stock = 20000.0; // mm; anything larger is a typing error

bool is_size(double value) { return value > 0.0 && value <= largest_stock; }

void check_stock(const core::Solid& stock, std::vector<EditRefusal>& refused) {
    const std::string sizes =
        fmt::format("sizes must be above 0 and at most {:g} mm", largest_stock);
    if (const auto* box = std::get_if<core::SolidBox>(&stock.shape)) {
        const core::Vec3 size = box->box.size();
        if (!core::is_finite(box->box.min))
            refused.push_back({{}, "box", "the corner must have finite coordinates"});
        else if (!is_size(size.x) || !is_size(size.y) || !is_size(size.z))
            refused.push_back({{}, "box", sizes});
    } else if (const auto* round = std::get_if<core::SolidCylinder>(&stock.shape)) {
        if (!core::is_finite(round->base))
            refused.push_back({{}, "cylinder", "the base must have finite coordinates"});
        else if (!is_size(2.0 * round->radius) || !is_size(round->height))
            refused.push_back({{}, "cylinder", sizes});
    } else {
        refused.push_back({{}, "mesh", "a mesh can only be given in a set-up file"});
    }
}

/// The key that a message about a tool begins with, else the first one that it contains.
std::string key_in(const std::string& why) {
    std::vector<std::string_view> keys = {"teeth", "holder"};
    for (const core::ToolSize& size : core::tool_sizes()) keys.emplace_back(size.key);
    std::string first;
    size_t at = std::string::npos;
    for (const std::string_view key : keys)
        if (const size_t found = why.find(key); found < at) {
            at = found;
            first = key;
        }
    return first;
}

void check_tool(const core::ToolDescription& tool, std::vector<EditRefusal>& refused) {
    const auto assembled = core::assemble(tool);
    if (assembled) return;
    std::string why = assembled.error().message;
    const std::string opening = fmt::format("tool {}: ", core::value_of(tool.number));
    if (why.starts_with(opening)) why = why.substr(opening.size());
    refused.push_back({tool.number, key_in(why), why});
}

/// Replaces the notes that the set-up reader made about a tool.
void renew_notes(SetupFile& file, const core::ToolDescription& tool) {
    const auto old = file.setup.tools.find(tool.number);
    if (old != file.setup.tools.end())
        for (const std::string& note : notes_on(old->second.description))
            std::erase(file.assumptions, note);
    for (std::string& note : notes_on(tool)) file.assumptions.push_back(std::move(note));
}

} // namespace

std::vector<EditRefusal> refusals_of(const SetupEdits& edits) {
    std::vector<EditRefusal> refused;
    if (edits.stock) check_stock(*edits.stock, refused);
    for (const auto& [number, stated] : edits.tools) check_tool(stated.tool, refused);
    if (edits.allowance
        && !(*edits.allowance >= 0.0 && *edits.allowance <= core::largest_allowance))
        refused.push_back({{},
                           "allowance",
                           fmt::format("a minimum clearance must be between 0 and {:g} mm",
                                       core::largest_allowance)});
    return refused;
}

core::Result<void> apply(const SetupEdits& edits, SetupFile& file) {
    if (const auto refused = refusals_of(edits); !refused.empty()) {
        const EditRefusal& first = refused.front();
        return core::fail(core::ErrorCode::invalid_value,
                          first.tool
                              ? fmt::format("tool {}: {}", core::value_of(*first.tool), first.why)
                              : fmt::format("{}: {}", first.key, first.why));
    }
    if (edits.stock) {
        const double tolerance = file.setup.stock.tolerance;
        file.setup.stock = *edits.stock;
        file.setup.stock.tolerance = tolerance;
        file.setup.earlier_cuts = nullptr;
        file.needs_stock = false;
        file.assumed.erase("stock");
    }
    for (const auto& [number, stated] : edits.tools) {
        core::ToolAssembly tool = *core::assemble(stated.tool);
        renew_notes(file, tool.description);
        file.assumptions.push_back(fmt::format(
            "tool {} is as stated: {}{}", core::value_of(number), fmt::join(stated.stated, ", "),
            stated.stated.empty() ? "all of it" : "; the rest is unchanged"));
        file.environment.tool_lengths[number] = tool.length;
        if (!tool.description.length_is_guess) file.environment.guessed_lengths.erase(number);
        file.environment.tool_diameters[number] = tool.description.diameter;
        file.setup.tools.insert_or_assign(number, std::move(tool));
    }
    if (edits.stock) file.assumptions.emplace_back("the stock is as stated");
    if (edits.allowance) file.setup.allowance = edits.allowance;
    if (edits.tool_at_start && !file.setup.tool_at_start)
        file.setup.tool_at_start = edits.tool_at_start;
    return {};
}

namespace {

/// Visits all nodes below `node`, with their keys; elements of a list have the key of the list.
void visit(const toml::node& node, const std::string& key,
           const std::function<void(const std::string&, const toml::node&)>& see) {
    see(key, node);
    if (const toml::table* table = node.as_table())
        for (const auto& [name, value] : *table)
            visit(value, std::string(std::string_view(name)), see);
    if (const toml::array* list = node.as_array())
        for (const toml::node& value : *list) visit(value, key, see);
}

/// The lines of a TOML file, numbered from 1.
class Lines {
public:
    explicit Lines(const std::string& text) {
        std::istringstream all(text);
        for (std::string line; std::getline(all, line);) lines_.push_back(line);
    }

    /// Whether a line is the header of a table or of an element of a list of tables.
    bool is_head(size_t line) const {
        const std::string& text = lines_[line - 1];
        const size_t at = text.find_first_not_of(" \t");
        return at != std::string::npos && text[at] == '[';
    }
    void replace(size_t first, size_t end, std::string with) {
        while (!with.empty() && with.front() == '\n') with.erase(0, 1);
        if (with.ends_with('\n')) with.pop_back();
        lines_.erase(lines_.begin() + static_cast<ptrdiff_t>(first) - 1,
                     lines_.begin() + static_cast<ptrdiff_t>(end) - 1);
        lines_.insert(lines_.begin() + static_cast<ptrdiff_t>(first) - 1, std::move(with));
    }
    /// The line after the last one of the table that begins at `first`: excludes the blank lines
    /// and comments before the next header.
    size_t end_of(size_t first, const std::set<size_t>& heads) const {
        const auto next = heads.upper_bound(first);
        size_t end = next == heads.end() ? lines_.size() + 1 : *next;
        const auto leads_on = [&](const std::string& text) {
            const size_t at = text.find_first_not_of(" \t\r");
            return at == std::string::npos || text[at] == '#';
        };
        while (end > first + 1 && leads_on(lines_[end - 2])) --end;
        return end;
    }
    void append(const std::string& text) { lines_.push_back(text); }
    std::string text() const {
        std::string all;
        for (const std::string& line : lines_) all += line + "\n";
        return all;
    }
    size_t count() const { return lines_.size(); }

private:
    std::vector<std::string> lines_;
};

/// The new text of a table at lines `first` to `end`; a new table if `first` is 0.
struct NewTable {
    size_t first = 0, end = 0;
    std::string text;
};

size_t line_of(const toml::node& node) { return node.source().begin.line; }

/// The first lines of all tables that have a header.
std::set<size_t> heads_of(const toml::table& root, const Lines& lines) {
    std::set<size_t> heads;
    visit(root, "", [&](const std::string& key, const toml::node& node) {
        const toml::table* table = node.as_table();
        if (!table || table->is_inline() || key.empty()) return;
        const size_t line = line_of(node);
        if (line >= 1 && line <= lines.count() && lines.is_head(line)) heads.insert(line);
    });
    return heads;
}

bool others_stand_on_stock(const toml::table& root) {
    bool any = false;
    visit(root, "", [&](const std::string& key, const toml::node& node) {
        any = any || (key == "frame" && node.value<std::string>() == "stock");
    });
    return any;
}

core::Result<std::string> new_stock(const toml::table& root, const core::Solid& stock) {
    const toml::table* old = root["stock"].as_table();
    const bool was_placed = old && (old->contains("at") || old->contains("rotate_deg"));
    const bool is_placed = std::holds_alternative<core::SolidCylinder>(stock.shape);
    if ((was_placed || is_placed) && others_stand_on_stock(root))
        return core::fail(core::ErrorCode::unsupported,
                          "other bodies are positioned in the stock's frame, which would move: "
                          "edit the stock in the file by hand");
    core::Solid with_tolerance = stock;
    if (old) with_tolerance.tolerance = (*old)["tolerance"].value_or(0.0);
    const std::string frame = old ? (*old)["frame"].value_or(std::string("G54")) : "G54";
    return stock_table(with_tolerance, frame);
}

const toml::table* old_tool(const toml::table& root, core::ToolNumber number) {
    const toml::array* tools = root["tool"].as_array();
    if (!tools) return nullptr;
    for (const toml::node& node : *tools)
        if (const toml::table* tool = node.as_table())
            if ((*tool)["number"].value<int64_t>() == int64_t(core::value_of(number))) return tool;
    return nullptr;
}

/// The general rule in a list of allowances, the one without a pair; null if there is none.
const toml::table* old_general(const toml::table& root) {
    const toml::array* rules = root["allowance"].as_array();
    if (!rules) return nullptr;
    for (const toml::node& node : *rules)
        if (const toml::table* rule = node.as_table(); rule && !rule->contains("between"))
            return rule;
    return nullptr;
}

/// Keys of the root must come before all tables.
NewTable new_allowance(const toml::table& root, double allowance, const std::set<size_t>& heads,
                       size_t lines) {
    const std::string number = toml_number(allowance);
    if (const toml::table* rule = old_general(root)) {
        const size_t first = line_of(*rule);
        return {first, 0, "[[allowance]]\ndistance = " + number};
    }
    if (root["allowance"].is_array()) return {0, 0, "\n[[allowance]]\ndistance = " + number};
    const std::string text = "allowance = " + number;
    if (const toml::node* old = root.get("allowance")) {
        const size_t line = line_of(*old);
        return {line, line + 1, text};
    }
    const size_t before = heads.empty() ? lines + 1 : *heads.begin();
    return {before, before, text + "\n"};
}

/// Takes the stock out of what the file calls assumed. Whether it was there.
bool state_stock(toml::table& root) {
    toml::array* words = root["assumed"].as_array();
    if (!words) return false;
    const size_t before = words->size();
    for (auto word = words->begin(); word != words->end();)
        word = word->value<std::string>() == "stock" ? words->erase(word) : std::next(word);
    const bool changes = words->size() < before;
    if (words->empty()) root.erase("assumed");
    return changes;
}

/// Replaces or adds a tool in the tree that the new text must give when read.
void put(toml::table& root, const std::string& text, core::ToolNumber number) {
    toml::table fresh = toml::parse(text);
    toml::table tool = *fresh["tool"].as_array()->get(0)->as_table();
    if (!root.contains("tool")) root.insert_or_assign("tool", toml::array{});
    toml::array& tools = *root["tool"].as_array();
    for (toml::node& node : tools)
        if ((*node.as_table())["number"].value<int64_t>() == int64_t(core::value_of(number))) {
            *node.as_table() = std::move(tool);
            return;
        }
    tools.push_back(std::move(tool));
}

void put(toml::table& root, double allowance) {
    toml::array* rules = root["allowance"].as_array();
    if (!rules) {
        root.insert_or_assign("allowance", allowance);
        return;
    }
    for (toml::node& node : *rules)
        if (toml::table& rule = *node.as_table(); !rule.contains("between")) {
            rule = toml::table{{"distance", allowance}};
            return;
        }
    rules->push_back(toml::table{{"distance", allowance}});
}

} // namespace

core::Result<std::string> rewritten_setup(const std::string& text, const SetupEdits& edits) {
    FEELER_TRY(const toml::table before, parsed_toml(text));
    Lines lines(text);
    const std::set<size_t> heads = heads_of(before, lines);
    toml::table wanted = before;
    std::vector<NewTable> tables;
    const auto replace = [&](const toml::table* old, std::string with) {
        tables.push_back({old ? line_of(*old) : 0, 0, std::move(with)});
    };
    if (edits.stock) {
        FEELER_TRY(const std::string stock, new_stock(before, *edits.stock));
        wanted.insert_or_assign("stock", *toml::parse(stock)["stock"].as_table());
        replace(before["stock"].as_table(), stock);
        if (state_stock(wanted)) {
            std::ostringstream line;
            if (const toml::array* words = wanted["assumed"].as_array())
                line << "assumed = " << *words;
            const size_t at = line_of(*before.get("assumed"));
            tables.push_back({at, at + 1, line.str()});
        }
    }
    for (const auto& [number, stated] : edits.tools) {
        const std::string tool = tool_table(stated.tool);
        put(wanted, tool, number);
        replace(old_tool(before, number), tool);
    }
    if (edits.allowance) {
        put(wanted, *edits.allowance);
        tables.push_back(new_allowance(before, *edits.allowance, heads, lines.count()));
    }
    for (NewTable& table : tables)
        if (table.first > 0 && table.end == 0) table.end = lines.end_of(table.first, heads);
    // Backwards, so that the line numbers of earlier tables stay valid.
    std::stable_sort(tables.begin(), tables.end(),
                     [](const NewTable& a, const NewTable& b) { return a.first > b.first; });
    std::string added;
    for (const NewTable& table : tables) {
        if (table.first == 0) added += table.text;
        if (table.first > 0) lines.replace(table.first, table.end, table.text);
    }
    const std::string cut = lines.text() + added;
    if (const auto read = parsed_toml(cut); read && *read == wanted) return cut;
    std::ostringstream whole;
    whole << wanted << "\n";
    return whole.str();
}

bool names_relative_files(const std::string& text) {
    const auto root = parsed_toml(text);
    if (!root) return false;
    static const std::set<std::string> keys = {
        "mesh",       "model",       "file",         "ini",         "parameters",
        "tool_table", "search_path", "tool_library", "holder_file", "holder_mesh"};
    bool any = false;
    visit(*root, "", [&](const std::string& key, const toml::node& node) {
        const auto path = node.value<std::string>();
        any = any || (keys.contains(key) && path && std::filesystem::path(*path).is_relative());
    });
    return any;
}

} // namespace app
