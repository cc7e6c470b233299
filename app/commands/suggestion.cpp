#include "app/commands/suggestion.h"

#include <algorithm>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/platform.h"
#include "core/base/text.h"

namespace app {
namespace {

std::vector<std::string> command_names(const CLI::App& cli) {
    std::vector<std::string> names;
    for (const CLI::App* command : cli.get_subcommands({})) names.push_back(command->get_name());
    return names;
}

std::vector<std::string> option_names(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options())
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    return names;
}

bool is_in(const std::vector<std::string>& names, std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

CLI::Validator slashes() {
    return CLI::Validator(
        [](std::string& path) {
            path = core::platform::with_slashes(std::move(path));
            return std::string();
        },
        "");
}

} // namespace

std::string suggestion(std::string_view word, const std::vector<std::string>& names) {
    const std::string nearest = core::nearest_name(word, names);
    const size_t most = 1 + std::max(word.size(), nearest.size()) / 4;
    const bool is_near = !nearest.empty() && core::edit_distance(word, nearest) <= most;
    const bool begins = !nearest.empty() && word.size() > 2 && nearest.starts_with(word);
    return is_near || begins ? "; did you mean " + nearest + "?" : "";
}

CLI::Validator one_of(const std::vector<std::string>& words) {
    const std::string list = fmt::format("{{{}}}", fmt::join(words, ","));
    return CLI::Validator(
        [words, list](const std::string& word) {
            return is_in(words, word)
                       ? std::string()
                       : fmt::format("{} not in {}{}", word, list, suggestion(word, words));
        },
        list);
}

CLI::Option* add_path(CLI::App& command, const std::string& name, std::string& path,
                      const std::string& help) {
    return command.add_option(name, path, help)->transform(slashes());
}

CLI::Option* add_path(CLI::App& command, const std::string& name, std::vector<std::string>& paths,
                      const std::string& help) {
    return command.add_option(name, paths, help)->transform(slashes());
}

OptionGroup::OptionGroup(CLI::App& command, const std::string& heading) : command_(command) {
    command_.option_defaults()->group(heading);
}

OptionGroup::~OptionGroup() { command_.option_defaults()->group("Options"); }

std::string misspelt_text(const CLI::App& cli, const std::vector<const char*>& arguments) {
    if (arguments.size() < 2) return {};
    const std::string command(arguments[1]);
    const std::vector<std::string> commands = command_names(cli);
    if (!command.starts_with('-') && !is_in(commands, command))
        return fmt::format("there is no command {}{}", command, suggestion(command, commands));
    const bool has_command = is_in(commands, command);
    const CLI::App& called = has_command ? *cli.get_subcommand(command) : cli;
    const std::vector<std::string> options = option_names(called);
    for (size_t i = has_command ? 2 : 1; i < arguments.size(); ++i) {
        const std::string_view argument(arguments[i]);
        const std::string_view name = argument.substr(0, argument.find('='));
        if (name == "--") break;
        if (name.starts_with("--") && !is_in(options, name))
            return fmt::format("{} has no option {}{}",
                               has_command ? "feeler " + command : "feeler", name,
                               suggestion(name, options));
    }
    return {};
}

} // namespace app
