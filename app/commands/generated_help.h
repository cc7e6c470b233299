#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace CLI {
class App;
}

namespace app {

/// The manual pages of a program and its subcommands, from the texts of --help: file names, such as
/// feeler-check.1, and contents for man.
std::vector<std::pair<std::string, std::string>> manual_pages(const CLI::App& cli);

/// The script with which a shell completes subcommands, options, their values and file names.
/// `shell`: bash, zsh or fish.
std::string completion_script(const CLI::App& cli, std::string_view shell);

} // namespace app
