#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/debug/prompt/prompt.h"

namespace app {

/// A command of the prompt.
struct PromptCommand {
    std::string_view name;
    std::string_view aliases; // short forms, separated by blanks
    std::string_view usage;   // the arguments
    std::string_view help;    // the first line is for the list, the rest only for `help NAME`
    core::Result<std::string> (*execute)(PromptState& state, const std::string& arguments);
    bool repeats = false; // whether an empty line repeats it
};

/// All commands, in the order of the help.
std::span<const PromptCommand> command_table();

/// The command with this name, alias or unambiguous abbreviation.
///
/// Errors: syntax, with the nearest name or with all names that match.
core::Result<const PromptCommand*> command_named(std::string_view name);

/// The first word of a text and the rest, both trimmed.
std::pair<std::string, std::string> split_word(std::string_view text);

/// All words of a text.
std::vector<std::string> words_of(std::string_view text);

/// The count in a text, at least 1; 1 for an empty text.
///
/// Errors: invalid_value.
core::Result<size_t> count_in(const std::string& text);

// The commands, one source per topic: first those of walk_commands.cpp.
using CommandResult = core::Result<std::string>;

CommandResult run_program(PromptState& state, const std::string& arguments);
CommandResult start_program(PromptState& state, const std::string& arguments);
CommandResult step_on(PromptState& state, const std::string& arguments);
CommandResult step_over(PromptState& state, const std::string& arguments);
CommandResult step_back(PromptState& state, const std::string& arguments);
CommandResult step_back_over(PromptState& state, const std::string& arguments);
CommandResult finish_subprogram(PromptState& state, const std::string& arguments);
CommandResult go_on(PromptState& state, const std::string& arguments);
CommandResult reverse_resume(PromptState& state, const std::string& arguments);
CommandResult go_until(PromptState& state, const std::string& arguments);
CommandResult go_to(PromptState& state, const std::string& arguments);
CommandResult go_to_finding(PromptState& state, const std::string& arguments);
CommandResult go_back_to_finding(PromptState& state, const std::string& arguments);
CommandResult go_to_tool(PromptState& state, const std::string& arguments);
CommandResult go_back_to_tool(PromptState& state, const std::string& arguments);

// break_commands.cpp
CommandResult set_breakpoint(PromptState& state, const std::string& arguments);
CommandResult set_temporary(PromptState& state, const std::string& arguments);
CommandResult watch_value(PromptState& state, const std::string& arguments);
CommandResult delete_breakpoint(PromptState& state, const std::string& arguments);
CommandResult disable_breakpoint(PromptState& state, const std::string& arguments);
CommandResult enable_breakpoint(PromptState& state, const std::string& arguments);
CommandResult ignore_breakpoint(PromptState& state, const std::string& arguments);
CommandResult change_condition(PromptState& state, const std::string& arguments);
CommandResult show_breakpoints(PromptState& state, const std::string& arguments);
CommandResult show_watches(PromptState& state, const std::string& arguments);

// value_commands.cpp
CommandResult print_value(PromptState& state, const std::string& arguments);
CommandResult display_value(PromptState& state, const std::string& arguments);
CommandResult undisplay_value(PromptState& state, const std::string& arguments);
CommandResult show_displays(PromptState& state, const std::string& arguments);

// info_commands.cpp
CommandResult list_lines(PromptState& state, const std::string& arguments);

CommandResult show_info(PromptState& state, const std::string& arguments);
CommandResult show_findings(PromptState& state, const std::string& arguments);
CommandResult show_calls(PromptState& state, const std::string& arguments);

// value_commands.cpp: what-if
CommandResult change_something(PromptState& state, const std::string& arguments);
CommandResult take_back(PromptState& state, const std::string& arguments);

// command_table.cpp
CommandResult show_help(PromptState& state, const std::string& arguments);
CommandResult quit(PromptState& state, const std::string& arguments);

/// The possible first words after `info` and `set`.
std::vector<std::string> info_topics();
std::vector<std::string> set_topics();

} // namespace app
