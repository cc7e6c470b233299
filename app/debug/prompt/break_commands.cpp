#include <algorithm>

#include <fmt/format.h>

#include "app/base/text.h"
#include "app/check/check_run.h"
#include "app/debug/inspected_value.h"
#include "app/debug/prompt/command_table.h"
#include "app/debug/prompt/location.h"
#include "app/debug/prompt/state_text.h"
#include "core/base/text.h"
#include "core/sim/finding.h"

namespace app {
namespace {

using core::ErrorCode;

/// Parses `3` or `T3`.
core::Result<core::ToolNumber> tool_in(const std::string& text) {
    const bool lettered = !text.empty() && (text[0] == 'T' || text[0] == 't');
    const auto number = number_in(text.substr(lettered ? 1 : 0));
    if (!number || *number > 99999999)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("'{}' is not a tool: write it as T3", text));
    return core::ToolNumber(static_cast<int32_t>(*number));
}

/// Splits a text at the word `if` into the place and the condition; no condition without `if`.
std::pair<std::string, std::optional<std::string>> split_condition(const std::string& text) {
    const std::string small = " " + core::lower_case(text) + " ";
    const size_t at = small.find(" if ");
    if (at == std::string::npos) return {text, std::nullopt};
    const std::string condition = at + 3 < text.size() ? text.substr(at + 3) : std::string();
    return {trimmed(text.substr(0, at)), condition};
}

core::Result<void> read_location(PromptState& state, const std::string& text,
                                 Breakpoint& breakpoint) {
    const auto [first, rest] = split_word(text);
    if (first == "tool" || (rest.empty() && (first[0] == 'T' || first[0] == 't'))) {
        FEELER_TRY(breakpoint.tool, tool_in(first == "tool" ? rest : first));
        return {};
    }
    if (first == "finding" && rest.empty()) {
        breakpoint.rule = "finding";
        return {};
    }
    if (first == "rule" || (rest.empty() && core::default_severity(first))) {
        breakpoint.rule = first == "rule" ? rest : first;
        if (!core::default_severity(breakpoint.rule))
            return core::fail(ErrorCode::invalid_value,
                              fmt::format("there is no rule '{}'; the nearest is '{}'",
                                          breakpoint.rule, core::nearest_rule(breakpoint.rule)));
        return {};
    }
    if (first != "line" && !is_location(text))
        return core::fail(ErrorCode::syntax,
                          fmt::format("'{}' is not a location: write a line (23), a block "
                                      "(N210), FILE:LINE, a tool (T3), finding, rule NAME, or if "
                                      "CONDITION",
                                      text));
    FEELER_TRY(const Location location, location_in(state, first == "line" ? rest : text));
    breakpoint.line = location.line;
    breakpoint.file = location.file;
    if (!location.file.empty()) return {};
    // A line with only a comment has no block: use the next line that has one.
    FEELER_TRY(breakpoint.line, state.session.line_with_block(location.line));
    return {};
}

core::Result<Breakpoint> breakpoint_in(PromptState& state, const std::string& arguments) {
    Breakpoint breakpoint;
    const auto [location_words, condition] = split_condition(arguments);
    if (!location_words.empty()) {
        if (auto read = read_location(state, location_words, breakpoint); !read)
            return tl::unexpected(read.error());
    } else if (!condition) {
        if (!has_block(state))
            return core::fail(ErrorCode::invalid_value, "the program has ended: name a line");
        const CheckedBlock block = state.session.record().blocks[state.session.at()];
        breakpoint.line = block.line;
        breakpoint.file = block.file;
    }
    if (condition) {
        FEELER_TRY(breakpoint.condition, Condition::read(*condition));
    }
    return breakpoint;
}

CommandResult added(PromptState& state, Breakpoint breakpoint) {
    const std::string text = text_of(breakpoint);
    const bool temporary = breakpoint.temporary;
    const int id = state.session.add(std::move(breakpoint));
    return fmt::format("{} {}: {}\n", temporary ? "temporary breakpoint" : "breakpoint", id, text);
}

/// The ids in a list, which must be those of breakpoints or watches; for an empty list, all ids.
core::Result<std::vector<int>> ids_in(PromptState& state, const std::string& arguments) {
    std::vector<int> all, ids;
    for (const Breakpoint& breakpoint : state.session.breakpoints()) all.push_back(breakpoint.id);
    for (const Watch& watch : state.session.watches()) all.push_back(watch.id);
    for (const std::string& word : words_of(arguments)) {
        FEELER_TRY(const size_t id, number_in(word));
        if (std::find(all.begin(), all.end(), static_cast<int>(id)) == all.end())
            return core::fail(ErrorCode::invalid_value,
                              fmt::format("there is no breakpoint or watchpoint {}; 'info "
                                          "breakpoints' lists them",
                                          id));
        ids.push_back(static_cast<int>(id));
    }
    return ids.empty() ? all : ids;
}

CommandResult switched(PromptState& state, const std::string& arguments, bool enabled) {
    FEELER_TRY(const std::vector<int> ids, ids_in(state, arguments));
    for (const int id : ids) {
        for (Breakpoint& breakpoint : state.session.breakpoints())
            if (breakpoint.id == id) breakpoint.enabled = enabled;
        for (Watch& watch : state.session.watches())
            if (watch.id == id) watch.enabled = enabled;
    }
    return std::string();
}

/// The breakpoint of the leading id, and the text after the id.
core::Result<std::pair<Breakpoint*, std::string>> one_and_rest(PromptState& state,
                                                               const std::string& arguments) {
    const auto [first, rest] = split_word(arguments);
    FEELER_TRY(const size_t id, number_in(first));
    for (Breakpoint& breakpoint : state.session.breakpoints())
        if (breakpoint.id == static_cast<int>(id)) return std::pair(&breakpoint, rest);
    return core::fail(ErrorCode::invalid_value, fmt::format("there is no breakpoint {}", id));
}

} // namespace

CommandResult set_breakpoint(PromptState& state, const std::string& arguments) {
    FEELER_TRY(Breakpoint breakpoint, breakpoint_in(state, arguments));
    return added(state, std::move(breakpoint));
}

CommandResult set_temporary(PromptState& state, const std::string& arguments) {
    FEELER_TRY(Breakpoint breakpoint, breakpoint_in(state, arguments));
    breakpoint.temporary = true;
    return added(state, std::move(breakpoint));
}

CommandResult watch_value(PromptState& state, const std::string& arguments) {
    if (arguments.empty())
        return core::fail(ErrorCode::syntax, "watch what? A value of the control, as in watch z, "
                                             "watch #100 or watch offset");
    FEELER_TRY(const int id, state.session.watch(arguments));
    FEELER_TRY(const InspectedValue now,
               value_of(arguments, state.session.control(), state.session.environment()));
    return fmt::format("watchpoint {}: {}, now {}\n", id, arguments, now.text);
}

CommandResult delete_breakpoint(PromptState& state, const std::string& arguments) {
    FEELER_TRY(const std::vector<int> ids, ids_in(state, arguments));
    for (const int id : ids) state.session.remove(id);
    return std::string();
}

CommandResult disable_breakpoint(PromptState& state, const std::string& arguments) {
    return switched(state, arguments, false);
}

CommandResult enable_breakpoint(PromptState& state, const std::string& arguments) {
    return switched(state, arguments, true);
}

CommandResult ignore_breakpoint(PromptState& state, const std::string& arguments) {
    FEELER_TRY(const auto chosen, one_and_rest(state, arguments));
    FEELER_TRY(chosen.first->ignore, number_in(chosen.second));
    return fmt::format("breakpoint {}: ignore count {}\n", chosen.first->id, chosen.first->ignore);
}

CommandResult change_condition(PromptState& state, const std::string& arguments) {
    FEELER_TRY(const auto chosen, one_and_rest(state, arguments));
    std::optional<Condition> condition;
    if (!chosen.second.empty()) {
        FEELER_TRY(condition, Condition::read(chosen.second));
    }
    chosen.first->condition = std::move(condition);
    return fmt::format("breakpoint {}: {}\n", chosen.first->id, text_of(*chosen.first));
}

CommandResult show_breakpoints(PromptState& state, const std::string&) {
    std::string text;
    for (const Breakpoint& breakpoint : state.session.breakpoints()) {
        text += fmt::format("{:>4}  breakpoint  {}", breakpoint.id, text_of(breakpoint));
        if (!breakpoint.enabled) text += ", disabled";
        if (breakpoint.temporary) text += ", temporary";
        if (breakpoint.ignore > 0) text += fmt::format(", ignore count {}", breakpoint.ignore);
        if (breakpoint.hits > 0) text += ", stopped " + counted(breakpoint.hits, "time");
        text += "\n";
    }
    FEELER_TRY(const std::string watches, show_watches(state, ""));
    if (text.empty() || !state.session.watches().empty()) text += watches;
    return text;
}

CommandResult show_watches(PromptState& state, const std::string&) {
    std::string text;
    for (const Watch& watch : state.session.watches()) {
        text += fmt::format("{:>4}  watchpoint  {}", watch.id, watch.expression);
        if (!watch.enabled) text += ", disabled";
        if (watch.hits > 0) text += ", stopped " + counted(watch.hits, "time");
        text += "\n";
    }
    return text.empty() ? "no breakpoints and no watchpoints\n" : text;
}

} // namespace app
