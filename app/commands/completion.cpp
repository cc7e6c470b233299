#include <algorithm>
#include <cstdio>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/base/version.h"
#include "app/commands/commands.h"
#include "app/commands/output.h"
#include "app/commands/suggestion.h"
#include "core/base/text.h"

namespace app {
namespace {

/// What the help of an option says about its value.
struct ValueText {
    std::string name;                 // such as MM or TEXT; empty if the option takes none
    std::vector<std::string> choices; // if it is one of some words
};

ValueText value_of(const CLI::Option& option) {
    if (option.get_items_expected_max() == 0) return {};
    const std::string type = option.get_type_name(); // "TEXT:{text,json}", "UINT:1..1024", "MM"
    const size_t begin = type.find('{'), end = type.find('}');
    ValueText value{option.get_option_text(), {}};
    if (value.name.empty()) value.name = type.substr(0, type.find(':'));
    if (begin == std::string::npos || end == std::string::npos) return value;
    for (size_t at = begin + 1; at < end;) {
        const size_t comma = std::min(type.find(',', at), end);
        value.choices.push_back(type.substr(at, comma - at));
        at = comma + 1;
    }
    return value;
}

/// The words that the argument of a command may be; none if it is a file.
std::vector<std::string> argument_choices(const CLI::App& command) {
    for (const CLI::Option* option : command.get_options())
        if (option->get_positional()) return value_of(*option).choices;
    return {};
}

std::vector<const CLI::Option*> named_options(const CLI::App& command) {
    std::vector<const CLI::Option*> options;
    for (const CLI::Option* option : command.get_options())
        if (!option->get_positional() && !option->get_group().empty()) options.push_back(option);
    return options;
}

std::vector<const CLI::App*> shown_commands(const CLI::App& cli) {
    std::vector<const CLI::App*> commands;
    for (const CLI::App* command : cli.get_subcommands({}))
        if (!command->get_group().empty()) commands.push_back(command);
    return commands;
}

std::vector<std::string> spellings(const CLI::Option& option) {
    std::vector<std::string> all;
    for (const std::string& name : option.get_snames()) all.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) all.push_back("--" + name);
    return all;
}

// --- man ---

std::string roff(std::string_view text) {
    std::string escaped;
    for (const char letter : text) {
        if (letter == '\\')
            escaped += "\\e";
        else if (letter == '-')
            escaped += "\\-";
        else if (letter == '\n')
            escaped += "\n.br\n";
        else
            escaped += letter;
    }
    if (!escaped.empty() && (escaped[0] == '.' || escaped[0] == '\'')) escaped.insert(0, "\\&");
    return escaped;
}

/// The options of a command by group, each group once, in the order of their first options.
std::vector<const CLI::Option*> grouped_options(const CLI::App& command) {
    std::vector<const CLI::Option*> options = named_options(command);
    std::vector<std::string> groups;
    for (const CLI::Option* option : options)
        if (std::find(groups.begin(), groups.end(), option->get_group()) == groups.end())
            groups.push_back(option->get_group());
    const auto place_of = [&](const CLI::Option* option) {
        return std::find(groups.begin(), groups.end(), option->get_group());
    };
    std::stable_sort(options.begin(), options.end(),
                     [&](const auto* a, const auto* b) { return place_of(a) < place_of(b); });
    return options;
}

std::string options_section(const CLI::App& command) {
    std::string text, group;
    for (const CLI::Option* option : grouped_options(command)) {
        if (const std::string& now = option->get_group(); now != group) {
            group = now;
            text += fmt::format(".SH {}\n", roff(core::upper_case(group)));
        }
        const ValueText value = value_of(*option);
        std::string name;
        for (const std::string& spelling : spellings(*option))
            name += fmt::format("{}\\fB{}\\fR", name.empty() ? "" : ", ", roff(spelling));
        if (!value.choices.empty())
            name += fmt::format(" {}", roff(fmt::format("{}", fmt::join(value.choices, "|"))));
        else if (!value.name.empty())
            name += fmt::format(" \\fI{}\\fR", roff(value.name));
        text += fmt::format(".TP\n{}\n{}\n", name, roff(option->get_description()));
    }
    return text;
}

std::string usage_line(const CLI::App& command, const std::string& name) {
    std::string text = fmt::format("\\fB{}\\fR [\\fIoptions\\fR]", roff(name));
    for (const CLI::Option* option : command.get_options()) {
        if (!option->get_positional()) continue;
        const std::string word = fmt::format("\\fI{}\\fR{}", roff(option->get_name()),
                                             option->get_items_expected_max() > 1 ? " ..." : "");
        text += option->get_required() ? " " + word : " [" + word + "]";
    }
    return text;
}

/// The meaning of the exit status: docs/manual/exit-status-and-limits.md.
const char* exit_status_of(const std::string& command) {
    if (command == "check" || command == "merge")
        return "0 if no finding is an error, 1 if one is (with --require coverage, also if the "
               "set-up lacks something), 2 if the check could not finish.";
    if (command == "coproc")
        return "0 if every block is permitted in time, 1 if a block is refused or a permit is "
               "late, 2 if the command failed.";
    if (command == "diff")
        return "0 if the later version is not worse, 1 if it is, 2 if one of them could not be run "
               "to its end.";
    if (command == "feeler") return "That of the command; 2 for a wrong command or option.";
    return "0, or 2 if the command failed.";
}

/// A manual page. `list`: a section after the options; `see_also`: another page, or empty.
std::string manual_page(const CLI::App& command, const std::string& title, const std::string& usage,
                        const std::string& list, const std::string& see_also) {
    std::string text =
        fmt::format(".TH {} 1 \"\" \"Feeler {}\" \"User Commands\"\n.SH NAME\n{} \\- {}\n"
                    ".SH SYNOPSIS\n{}\n",
                    title, version, roff(title), roff(command.get_description()), usage);
    std::string arguments;
    for (const CLI::Option* option : command.get_options())
        if (option->get_positional())
            arguments += fmt::format(".TP\n\\fI{}\\fR\n{}\n", roff(option->get_name()),
                                     roff(option->get_description()));
    if (!arguments.empty()) text += ".SH ARGUMENTS\n" + arguments;
    text += options_section(command) + list;
    text += fmt::format(".SH EXIT STATUS\n{}\n", exit_status_of(command.get_name()));
    if (const std::string footer = command.get_footer(); !footer.empty())
        text += fmt::format(".SH NOTES\n{}\n", roff(footer));
    if (!see_also.empty()) text += fmt::format(".SH SEE ALSO\n\\fB{}\\fR(1)\n", see_also);
    return text;
}

// --- shells ---

/// A word in single quotes for a POSIX shell; fish reads the escape alike.
std::string in_quotes(std::string_view text) {
    std::string word = "'";
    for (const char letter : text)
        word += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
    return word + "'";
}

std::string bash_script(const CLI::App& cli) {
    std::vector<std::string> commands;
    std::string cases, values;
    for (const CLI::App* command : shown_commands(cli)) {
        std::vector<std::string> words;
        for (const CLI::Option* option : named_options(*command)) {
            const std::vector<std::string> names = spellings(*option);
            words.insert(words.end(), names.begin(), names.end());
            const ValueText value = value_of(*option);
            if (value.name.empty() && value.choices.empty()) continue;
            const std::string reply =
                value.choices.empty()
                    ? std::string() // the name of a file, or something of the user's own
                    : fmt::format("COMPREPLY=($(compgen -W {} -- \"$word\")); ",
                                  in_quotes(fmt::format("{}", fmt::join(value.choices, " "))));
            values +=
                fmt::format("        {}:{}) {}return ;;\n", command->get_name(),
                            fmt::join(names, fmt::format("|{}:", command->get_name())), reply);
        }
        commands.push_back(command->get_name());
        cases +=
            fmt::format("        {}) words={} arguments={} ;;\n", command->get_name(),
                        in_quotes(fmt::format("{}", fmt::join(words, " "))),
                        in_quotes(fmt::format("{}", fmt::join(argument_choices(*command), " "))));
    }
    return fmt::format(R"(# bash completion of feeler
_feeler() {{
    local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} words='' arguments=''
    COMPREPLY=()
    # The words of --format=json are --format, = and json.
    if [[ $word == = ]]; then
        word=''
    elif [[ $before == = ]]; then
        before=${{COMP_WORDS[COMP_CWORD - 2]}}
    fi
    if ((COMP_CWORD == 1)); then
        COMPREPLY=($(compgen -W {} -- "$word"))
        return
    fi
    case ${{COMP_WORDS[1]}}:$before in
{}    esac
    case ${{COMP_WORDS[1]}} in
{}    esac
    if [[ $word == -* ]]; then
        COMPREPLY=($(compgen -W "$words" -- "$word"))
    elif [[ -n $arguments ]]; then
        COMPREPLY=($(compgen -W "$arguments" -- "$word"))
    fi # else there is no reply, and bash completes the names of files
}}
complete -o bashdefault -o default -F _feeler feeler
)",
                       in_quotes(fmt::format("{} --help --version", fmt::join(commands, " "))),
                       values, cases);
}

/// A description within `[...]` of an argument of zsh's _arguments.
std::string zsh_text(std::string_view text) {
    std::string escaped;
    for (const char letter : text) {
        if (letter == '[' || letter == ']' || letter == ':') escaped += '\\';
        escaped += letter;
    }
    return escaped;
}

std::string zsh_script(const CLI::App& cli) {
    std::string commands, cases;
    for (const CLI::App* command : shown_commands(cli)) {
        commands += fmt::format("        {}\n", in_quotes(fmt::format("{}:{}", command->get_name(),
                                                                      command->get_description())));
        cases += fmt::format("    {}) _arguments", command->get_name());
        for (const CLI::Option* option : named_options(*command)) {
            const ValueText value = value_of(*option);
            const std::string takes =
                !value.choices.empty() ? fmt::format(":value:({})", fmt::join(value.choices, " "))
                : !value.name.empty()  ? fmt::format(":{}:_files", zsh_text(value.name))
                                       : "";
            for (const std::string& name : spellings(*option))
                cases += " \\\n        "
                         + in_quotes(fmt::format("{}[{}]{}", name,
                                                 zsh_text(option->get_description()), takes));
        }
        const std::vector<std::string> choices = argument_choices(*command);
        cases += choices.empty()
                     ? " \\\n        '*:file:_files' ;;\n"
                     : fmt::format(" \\\n        '1:argument:({})' ;;\n", fmt::join(choices, " "));
    }
    return fmt::format(R"(#compdef feeler
local -a commands
if ((CURRENT == 2)); then
    commands=(
{}    )
    _describe command commands
    return
fi
local command=$words[2]
shift words
((CURRENT--))
case $command in
{}esac
)",
                       commands, cases);
}

std::string fish_script(const CLI::App& cli) {
    std::string text = "# fish completion of feeler\n";
    for (const CLI::App* command : shown_commands(cli)) {
        text += fmt::format("complete -c feeler -n __fish_use_subcommand -f -a {} -d {}\n",
                            command->get_name(), in_quotes(command->get_description()));
        for (const CLI::Option* option : named_options(*command)) {
            text += fmt::format("complete -c feeler -n '__fish_seen_subcommand_from {}'",
                                command->get_name());
            for (const std::string& name : option->get_snames()) text += " -s " + name;
            for (const std::string& name : option->get_lnames()) text += " -l " + name;
            const ValueText value = value_of(*option);
            if (!value.choices.empty())
                text += " -x -a " + in_quotes(fmt::format("{}", fmt::join(value.choices, " ")));
            else if (!value.name.empty())
                text += " -r";
            text += " -d " + in_quotes(option->get_description()) + "\n";
        }
        if (const auto choices = argument_choices(*command); !choices.empty())
            text += fmt::format("complete -c feeler -n '__fish_seen_subcommand_from {}' -f -a {}\n",
                                command->get_name(),
                                in_quotes(fmt::format("{}", fmt::join(choices, " "))));
    }
    return text;
}

/// The manual pages of the program and its subcommands, from the texts of --help: file names, such
/// as feeler-check.1, and contents for man.
std::vector<std::pair<std::string, std::string>> manual_pages(const CLI::App& cli) {
    std::string list = ".SH COMMANDS\n";
    std::vector<std::pair<std::string, std::string>> pages;
    for (const CLI::App* command : shown_commands(cli)) {
        const std::string name = command->get_name(), title = "feeler-" + name;
        list +=
            fmt::format(".TP\n\\fB{}\\fR(1)\n{}\n", roff(title), roff(command->get_description()));
        pages.emplace_back(
            title + ".1",
            manual_page(*command, title, usage_line(*command, "feeler " + name), "", "feeler"));
    }
    pages.emplace_back(
        "feeler.1",
        manual_page(cli, "feeler", "\\fBfeeler\\fR \\fIcommand\\fR [\\fIoptions\\fR]", list, ""));
    return pages;
}

/// The script with which a shell completes subcommands, options, their values and file names.
std::string completion_script(const CLI::App& cli, std::string_view shell) {
    if (shell == "bash") return bash_script(cli);
    return shell == "zsh" ? zsh_script(cli) : fish_script(cli);
}

core::Result<void> write_pages(const CLI::App& cli, const std::string& folder) {
    for (const auto& [name, text] : manual_pages(cli))
        if (auto written =
                write_output((std::filesystem::path(folder) / name).generic_string(), text);
            !written)
            return written;
    return {};
}

} // namespace

void add_completion(CLI::App& cli, ExitCode& exit_code) {
    CLI::App* command = cli.add_subcommand("completion", "Print the completion script of a shell");
    const auto shell = std::make_shared<std::string>();
    command->add_option("shell", *shell, "The shell that reads it")
        ->required()
        ->check(one_of({"bash", "zsh", "fish"}));
    command->callback(
        [&cli, shell] { std::fputs(completion_script(cli, *shell).c_str(), stdout); });

    // Used by the installation.
    CLI::App* pages = cli.add_subcommand("man-pages", "Write the manual pages to a folder");
    pages->group("");
    const auto folder = std::make_shared<std::string>();
    add_path(*pages, "folder", *folder, "An existing folder")->required();
    pages->callback([&cli, &exit_code, folder] {
        if (const auto written = write_pages(cli, *folder); !written) {
            print_error(written.error());
            exit_code = ExitCode::failed;
        }
    });
}

} // namespace app
