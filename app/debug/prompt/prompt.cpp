#include "app/debug/prompt/prompt.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/base/text.h"
#include "app/check/check_run.h"
#include "app/debug/inspected_value.h"
#include "app/debug/prompt/command_table.h"
#include "app/debug/prompt/state_text.h"
#include "app/setup/setup_file.h"
#include "core/base/text.h"
#include "core/sim/finding.h"
#include "gcode/text/source.h"

namespace app {
namespace {

/// The message of an error, with file and column if known.
std::string error_text(const core::Error& error) {
    std::string text = error.message;
    if (error.where.column > 0)
        text += fmt::format(" (column {} of the condition)", error.where.column);
    if (!error.file.empty()) text = error.file + ": " + text;
    return text + "\n";
}

} // namespace

std::string Prompt::greeting() {
    const CheckRun& record = state_.session.record();
    std::string text =
        fmt::format("{}: {} lines\n", record.program_file, state_.session.program().line_count());
    if (state_.session.setup_file().is_inferred)
        text += "the set-up is inferred from the program; 'info program' lists the assumptions\n";
    return text + "'help' lists the commands; start with 'run', 'step' or 'next-finding'\n"
           + location_text(state_);
}

PromptAnswer Prompt::answer(std::string_view line) {
    std::string text = trimmed(line);
    if (text.empty()) text = state_.repeated;
    if (text.empty()) return {};
    const auto [name, arguments] = split_word(text);
    const auto command = command_named(name);
    if (!command) return {error_text(command.error()), true};
    auto result = (*command)->execute(state_, arguments);
    // After `list 20`, repeating continues with a plain `list`.
    state_.repeated = !(*command)->repeats         ? std::string()
                      : (*command)->name == "list" ? std::string("list")
                                                   : text;
    if (!result) return {error_text(result.error()), true};
    return {*std::move(result), false, state_.ends};
}

PromptAnswer Prompt::answer_script(std::string_view line) {
    const std::string text = trimmed(line);
    if (text.empty() || text[0] == '#') return {};
    return answer(text);
}

namespace {

using Names = std::vector<std::string>;

Names command_names() {
    Names names;
    for (const PromptCommand& command : command_table()) names.emplace_back(command.name);
    return names;
}

Names ids_of(PromptState& state) {
    Names names;
    for (const Breakpoint& breakpoint : state.session.breakpoints())
        names.push_back(std::to_string(breakpoint.id));
    for (const Watch& watch : state.session.watches()) names.push_back(std::to_string(watch.id));
    return names;
}

Names tools_of(PromptState& state, const std::string& prefix) {
    Names names;
    for (const auto& [number, tool] : state.session.setup_at(state.session.at()).tools)
        names.push_back(fmt::format("{}{}", prefix, core::value_of(number)));
    return names;
}

Names fixtures_of(PromptState& state) {
    Names names;
    for (const core::Fixture& fixture : state.session.setup_at(state.session.at()).fixtures)
        if (!fixture.is_machine) names.push_back(fixture.name);
    return names;
}

/// The possible words after `break`: a place or a condition.
Names break_names(PromptState& state, const Names& before) {
    if (std::find(before.begin(), before.end(), "if") != before.end())
        return condition_names_beginning("");
    if (before.size() > 1 && before.back() == "rule") return core::rule_names();
    if (before.size() > 1 && before.back() == "tool") return tools_of(state, "");
    if (before.size() > 1) return {"if"};
    Names names = tools_of(state, "T");
    for (const char* name : {"if", "finding", "line", "rule", "tool"}) names.emplace_back(name);
    return names;
}

Names set_names(PromptState& state, const Names& before) {
    if (before.size() == 1) return set_topics();
    if (before[1] == "fixture") return before.size() == 2 ? fixtures_of(state) : Names{"by"};
    if (before[1] == "tool") return before.size() == 2 ? tools_of(state, "") : Names{"length"};
    if (before[1] == "allowance") return {"default"};
    return {};
}

/// The possible words after these; the first one is a command.
Names names_after(PromptState& state, const Names& before) {
    const auto command = command_named(before[0]);
    if (!command) return {};
    const std::string_view name = (*command)->name;
    if (name == "info") return before.size() == 1 ? info_topics() : Names{};
    if (name == "help") return before.size() == 1 ? command_names() : Names{};
    if (name == "set") return set_names(state, before);
    if (name == "break" || name == "tbreak") return break_names(state, before);
    if (name == "delete" || name == "enable" || name == "disable") return ids_of(state);
    if (name == "goto") return {"block", "end", "line", "start"};
    if (name == "watch" || name == "display") return names_beginning("");
    if (name == "print" || name == "until" || name == "condition")
        return condition_names_beginning("");
    return {};
}

} // namespace

std::vector<std::string> Prompt::completions(std::string_view line) {
    Names before = words_of(line);
    std::string begun;
    if (!before.empty() && !line.empty() && line.back() != ' ') {
        begun = before.back();
        before.pop_back();
    }
    Names all = before.empty() ? command_names() : names_after(state_, before);
    std::erase_if(all, [&](const std::string& name) {
        return !core::lower_case(name).starts_with(core::lower_case(begun));
    });
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

} // namespace app
