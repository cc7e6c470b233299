#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
class Option;
class Validator;
} // namespace CLI

namespace app {

/// "; did you mean check?" if one of the names is nearly the word; otherwise empty.
std::string suggestion(std::string_view word, const std::vector<std::string>& names);

/// Accepts only these words; the message for any other one suggests the nearest.
CLI::Validator one_of(const std::vector<std::string>& words);

/// Adds an option that takes one path, or several. They get '/' between their parts, as paths are
/// stored and shown.
CLI::Option* add_path(CLI::App& command, const std::string& name, std::string& path,
                      const std::string& help);
CLI::Option* add_path(CLI::App& command, const std::string& name, std::vector<std::string>& paths,
                      const std::string& help);

/// Puts the options that are added to a command while this exists under a heading of its help.
class OptionGroup {
public:
    OptionGroup(CLI::App& command, const std::string& heading);
    ~OptionGroup();
    OptionGroup(const OptionGroup&) = delete;
    OptionGroup& operator=(const OptionGroup&) = delete;

private:
    CLI::App& command_;
};

/// What is wrong with a command line that could not be parsed: the first word that is not the name
/// of a subcommand or of one of its options, and the nearest name. Empty if all names exist.
std::string misspelt_text(const CLI::App& cli, const std::vector<const char*>& arguments);

} // namespace app
