#include <cstdio>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/commands/generated_help.h"
#include "app/commands/output.h"
#include "app/commands/suggestion.h"

namespace app {
namespace {

core::Result<void> write_pages(const CLI::App& cli, const std::string& folder) {
    for (const auto& [name, text] : manual_pages(cli))
        if (auto written = write_output((std::filesystem::path(folder) / name).string(), text);
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
    pages->add_option("folder", *folder, "An existing folder")->required();
    pages->callback([&cli, &exit_code, folder] {
        if (const auto written = write_pages(cli, *folder); !written) {
            print_error(written.error());
            exit_code = ExitCode::failed;
        }
    });
}

} // namespace app
