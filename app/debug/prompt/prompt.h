#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "app/debug/debug_session.h"
#include "gcode/text/source.h"

namespace app {

/// The answer to a command line.
struct PromptAnswer {
    std::string text;    // ends with a newline, or is empty
    bool failed = false; // the text is the error message
    bool ends = false;   // the user quits
};

/// An expression that is shown at every stop.
struct Display {
    int id = 0;
    std::string expression;
};

/// The session, and what the commands remember.
struct PromptState {
    DebugSession& session;
    std::vector<Display> displays = {};
    int last_display = 0;
    std::string repeated = {};    // the command that an empty line repeats
    std::string listed_file = {}; // where `list` continues; empty: main program
    uint32_t listed_to = 0;       // the last line listed; 0: none since the last stop
    bool ends = false;
    std::map<std::string, std::shared_ptr<const gcode::Program>> files = {}; // of subprograms
};

/// The command language of `feeler debug`. Takes command lines and returns texts; does not access
/// the terminal.
class Prompt {
public:
    /// The session must outlive the prompt.
    explicit Prompt(DebugSession& session) : state_{session} {}

    /// The first text: the program and its position.
    std::string greeting();

    /// Executes a command. An empty line repeats the last command if it is repeatable.
    PromptAnswer answer(std::string_view line);

    /// Executes a line of a script: empty lines and lines that begin with # do nothing.
    PromptAnswer answer_script(std::string_view line);

    /// The possible completions of the last word of a line, as whole words.
    std::vector<std::string> completions(std::string_view line);

private:
    PromptState state_;
};

} // namespace app
