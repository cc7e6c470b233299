#include "app/debug/prompt/command_table.h"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>

#include "app/base/text.h"
#include "app/debug/prompt/location.h"
#include "core/base/text.h"

namespace app {
namespace {

using core::ErrorCode;

// clang-format off
constexpr PromptCommand commands[] = {
    {"step", "s", "[COUNT]", "run one block, or COUNT blocks", step_on, true},
    {"next", "n", "[COUNT]", "run one block, including a subprogram that it calls", step_over, true},
    {"back", "reverse-step rs", "[COUNT]", "go back one block", step_back, true},
    {"reverse-next", "rn", "[COUNT]", "go back one block, skipping subprograms", step_back_over, true},
    {"finish", "fin", "", "run to the first block after the subprogram", finish_subprogram, true},
    {"continue", "c", "[COUNT]", "run to the next breakpoint, or to the COUNTth", go_on, true},
    {"reverse-continue", "rc", "[COUNT]", "go back to the previous breakpoint", reverse_resume, true},
    {"until", "u", "LINE|CONDITION", "run to a line, or to a block that meets a condition\n"
     "until 120, until N210, until clearance < 1 and rapid", go_until, false},
    {"goto", "jump", "LOCATION", "go forwards or back to: block 17, line 120, N210, start, end", go_to, false},
    {"run", "r", "", "run from the beginning to the first breakpoint", run_program, false},
    {"start", "", "", "go to the beginning", start_program, false},
    {"next-finding", "nf", "", "run to the next block that has an error or is not proven clear", go_to_finding, true},
    {"previous-finding", "pf", "", "go back to the previous block that has an error or is not proven clear", go_back_to_finding, true},
    {"next-tool", "nt", "", "run to the next tool change", go_to_tool, true},
    {"previous-tool", "pt", "", "go back to the previous tool change", go_back_to_tool, true},
    {"break", "b", "[LOCATION] [if CONDITION]", "stop before a block\n"
     "LOCATION is a line (23), a block (N210), a line of a subprogram (sub.nc:5), a tool change (T3), "
     "finding, or rule NAME. Conditions can use the block (clearance < 1 and rapid, near-miss, "
     "\"clamp-1\", ~ \"G81\") and the control before it (#100 = 5, z < -2, plane = ZX). "
     "Without LOCATION: the current line.", set_breakpoint, false},
    {"tbreak", "tb", "[LOCATION] [if CONDITION]", "like break, but stop only once", set_temporary, false},
    {"watch", "", "EXPRESSION", "stop when a value of the control changes: z, #100, offset", watch_value, false},
    {"delete", "d", "[ID...]", "remove the given breakpoints and watchpoints, or all", delete_breakpoint, false},
    {"disable", "", "[ID...]", "switch breakpoints and watchpoints off", disable_breakpoint, false},
    {"enable", "", "[ID...]", "switch breakpoints and watchpoints on", enable_breakpoint, false},
    {"ignore", "", "ID COUNT", "ignore the next COUNT hits of a breakpoint", ignore_breakpoint, false},
    {"condition", "", "ID [CONDITION]", "change or remove the condition of a breakpoint", change_condition, false},
    {"list", "l", "[LINE|FIRST,LAST]", "show lines of the program with their clearance\n"
     "-> marks the next line, * a breakpoint, ! a line that is not clear. Repeat it to continue.", list_lines, true},
    {"print", "p", "[EXPRESSION]", "print a value: x, machine.z, feed, #100, G54.x, H3, clearance - allowance\n"
     "Without EXPRESSION: the positions of the axes.", print_value, false},
    {"display", "", "[EXPRESSION]", "print a value at every stop", display_value, false},
    {"undisplay", "", "[ID]", "stop displaying a value, or all", undisplay_value, false},
    {"info", "i", "[TOPIC]", "show axes, block, breakpoints, changes, display, findings, fixtures, modal, offsets, "
     "parameters, program, stack, tools, watchpoints", show_info, false},
    {"findings", "", "", "show all findings so far", show_findings, false},
    {"where", "bt backtrace", "", "show the lines that called this one", show_calls, false},
    {"set", "", "WHAT VALUE", "what if: change something from the current block on\n"
     "set tool 3 length 95, set H3 95, set G54.x -350, set allowance 1 (or default), "
     "set fixture clamp-1 by 0,10,0. Earlier blocks do not change.", change_something, false},
    {"undo", "", "", "undo the last change", take_back, false},
    {"help", "h", "[COMMAND]", "show this list, or more about one command", show_help, false},
    {"quit", "q exit", "", "end the debugger", quit, false},
};
// clang-format on

bool is_alias(const PromptCommand& command, std::string_view name) {
    for (const std::string& alias : words_of(command.aliases))
        if (alias == name) return true;
    return false;
}

std::string heading_of(const PromptCommand& command) {
    std::string text(command.name);
    for (const std::string& alias : words_of(command.aliases)) text += ", " + alias;
    return command.usage.empty() ? text : text + " " + std::string(command.usage);
}

} // namespace

std::span<const PromptCommand> command_table() { return commands; }

core::Result<const PromptCommand*> command_named(std::string_view name) {
    std::vector<const PromptCommand*> beginning;
    std::vector<std::string> names;
    for (const PromptCommand& command : commands) {
        if (command.name == name || is_alias(command, name)) return &command;
        if (command.name.starts_with(name)) beginning.push_back(&command);
        names.emplace_back(command.name);
    }
    if (beginning.size() == 1) return beginning[0];
    if (beginning.empty()) {
        const std::string nearest = core::nearest_name(name, names);
        const bool is_near = 2 * core::edit_distance(name, nearest) <= name.size();
        return core::fail(
            ErrorCode::syntax,
            fmt::format("there is no command '{}'; {}'help' lists all commands", name,
                        is_near ? fmt::format("the nearest is '{}'; ", nearest) : ""));
    }
    std::string list;
    for (const PromptCommand* command : beginning)
        list += (list.empty() ? "" : ", ") + std::string(command->name);
    return core::fail(ErrorCode::syntax,
                      fmt::format("'{}' is ambiguous: it may be {}", name, list));
}

std::pair<std::string, std::string> split_word(std::string_view text) {
    const std::string whole = trimmed(text);
    const size_t end = std::min(whole.find(' '), whole.size());
    return {whole.substr(0, end), trimmed(std::string_view(whole).substr(end))};
}

std::vector<std::string> words_of(std::string_view text) {
    std::istringstream stream{std::string(text)};
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(word);
    return words;
}

core::Result<size_t> count_in(const std::string& text) {
    if (text.empty()) return size_t{1};
    const auto count = number_in(text);
    if (count && *count > 0) return *count;
    return core::fail(ErrorCode::invalid_value,
                      fmt::format("'{}' is not a count: write a whole number above 0", text));
}

CommandResult show_help(PromptState&, const std::string& arguments) {
    if (!arguments.empty()) {
        FEELER_TRY(const PromptCommand* command, command_named(arguments));
        return heading_of(*command) + "\n" + wrapped(std::string(command->help), 4);
    }
    std::string text;
    for (const PromptCommand& command : commands) {
        const std::string heading = heading_of(command);
        const std::string help(command.help.substr(0, command.help.find('\n')));
        text += heading.size() < 28 ? fmt::format("{:<28}", heading) + wrapped(help, 28).substr(28)
                                    : heading + "\n" + wrapped(help, 28);
    }
    return text
           + "Names can be abbreviated if they stay unique. An empty line repeats step, next,\n"
             "back, list and similar commands. TAB completes.\n";
}

CommandResult quit(PromptState& state, const std::string&) {
    state.ends = true;
    return std::string();
}

} // namespace app
