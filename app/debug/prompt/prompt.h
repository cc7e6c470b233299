#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "app/debug/debug_session.h"
#include "gcode/text/source.h"

namespace app {

/// What a command line gave.
struct PromptAnswer {
    std::string text;    // with a newline at its end, or nothing
    bool failed = false; // the text says why
    bool ends = false;   // the user wants to leave
};

/// An expression that is shown at every stop.
struct Display {
    int id = 0;
    std::string expression;
};

/// What commands work on and remember.
struct PromptState {
    DebugSession& session;
    std::vector<Display> displays = {};
    int last_display = 0;
    std::string repeated = {};    // what an empty line means
    std::string listed_file = {}; // where `list` goes on; empty: main program
    uint32_t listed_to = 0;       // the last line that was listed; 0: none since the last stop
    bool ends = false;
    std::map<std::string, std::shared_ptr<const gcode::Program>> files = {}; // of subprograms
};

/// The debugger's command language: a function from a session and a command line to a text. It
/// reads no terminal and prints nothing.
class Prompt {
public:
    /// The session must outlive it.
    explicit Prompt(DebugSession& session) : state_{session} {}

    /// What is said first: the program, and where it stands.
    std::string greeting();

    /// Carries a command out. An empty line repeats the last one if that goes on somewhere.
    PromptAnswer answer(std::string_view line);

    /// Carries one out that comes of a file: empty lines and lines that begin with # do nothing.
    PromptAnswer answer_script(std::string_view line);

    /// What may stand in place of the last word of a line, each of them whole.
    std::vector<std::string> completions(std::string_view line);

private:
    PromptState state_;
};

} // namespace app
