#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <histedit.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include "app/base/text.h"
#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/commands/commands.h"
#include "app/commands/interrupt.h"
#include "app/commands/output.h"
#include "app/commands/program_arguments.h"
#include "app/commands/progress.h"
#include "app/debug/prompt/prompt.h"

namespace app {

/// Reads lines from a terminal, with history and completion. While the user is idle, the session
/// records ahead.
class LineReader {
public:
    /// Loads the history of earlier sessions; an empty `history_file` means no history.
    LineReader(Prompt& prompt, DebugSession& session, std::string history_file);
    /// Saves the history.
    ~LineReader();
    LineReader(const LineReader&) = delete;
    LineReader& operator=(const LineReader&) = delete;

    /// The next line; an interrupt discards the line being typed. Empty at end of input.
    std::optional<std::string> next();

    struct Editor;

private:
    std::string history_file_;
    std::unique_ptr<Editor> editor_;
};

/// Path of this user's history file; empty if there is no suitable folder.
std::string history_file();

namespace {

constexpr int longest_history = 2000;
constexpr unsigned char end_of_input = 'D' - '@'; // Ctrl-D

/// The longest common prefix.
std::string common_beginning(const std::vector<std::string>& names) {
    std::string common = names.front();
    for (const std::string& name : names) {
        const auto end = std::mismatch(common.begin(), common.end(), name.begin(), name.end());
        common.erase(end.first, common.end());
    }
    return common;
}

} // namespace

struct LineReader::Editor {
    Editor(Prompt& its_prompt, DebugSession& its_session);
    Editor(const Editor&) = delete;
    Editor& operator=(const Editor&) = delete;
    ~Editor();

    /// The next byte of standard input: 1 if there is one, 0 at the end, -1 after an interrupt.
    int read(wchar_t& character);
    /// Completes the word before the cursor to the common prefix of all candidates, and lists them
    /// if that adds nothing.
    unsigned char complete();

    Prompt& prompt;
    DebugSession& session;
    EditLine* line = ::el_init("feeler", stdin, stdout, stderr);
    ::History* history = ::history_init();
};

namespace {

LineReader::Editor& editor_of(EditLine* line);

} // namespace

int LineReader::Editor::read(wchar_t& character) {
    constexpr double slice = 0.02;       // s: too short to notice
    constexpr int hurry = 0, rest = 100; // ms until the next slice
    bool goes_on = true;
    while (!was_interrupted()) {
        ::pollfd input{STDIN_FILENO, POLLIN, 0};
        if (::poll(&input, 1, goes_on ? hurry : rest) > 0) {
            unsigned char byte = 0;
            const ssize_t count = ::read(STDIN_FILENO, &byte, 1);
            if (count < 0) continue;
            // A Ctrl-D typed while a command runs arrives as 0 when the terminal changes its mode.
            character = byte == 0 ? end_of_input : byte;
            return static_cast<int>(count);
        }
        goes_on = session.record_for(slice);
    }
    return -1;
}

unsigned char LineReader::Editor::complete() {
    const LineInfo* info = ::el_line(line);
    const std::string before(info->buffer, info->cursor);
    const std::vector<std::string> names = prompt.completions(before);
    if (names.empty()) return CC_REFRESH_BEEP;
    const size_t blank = before.find_last_of(" \t");
    const size_t begun = before.size() - (blank == std::string::npos ? 0 : blank + 1);
    std::string whole = common_beginning(names);
    if (names.size() == 1) whole += ' ';
    if (whole.size() > begun) {
        ::el_insertstr(line, whole.substr(begun).c_str());
        return CC_REFRESH;
    }
    fmt::print("\n{}\n", fmt::join(names, "  "));
    return CC_REDISPLAY;
}

LineReader::Editor::Editor(Prompt& its_prompt, DebugSession& its_session)
    : prompt(its_prompt), session(its_session) {
    using Ask = char* (*)(EditLine*);
    using Complete = unsigned char (*)(EditLine*, int);
    const Ask ask = [](EditLine*) -> char* {
        static char text[] = "(feeler) ";
        return text;
    };
    const el_rfunc_t read_one = [](EditLine* asked, wchar_t* character) {
        return editor_of(asked).read(*character);
    };
    const Complete complete_one = [](EditLine* asked, int) { return editor_of(asked).complete(); };
    ::HistEvent event;
    ::history(history, &event, H_SETSIZE, longest_history);
    ::history(history, &event, H_SETUNIQUE, 1);
    ::el_set(line, EL_CLIENTDATA, this);
    ::el_set(line, EL_PROMPT, ask);
    ::el_set(line, EL_EDITOR, "emacs");
    // Without noflsh, Ctrl-C would discard the byte that poll just announced, and the read would
    // block until the next key.
    ::el_set(line, EL_SETTY, "-d", "+noflsh", nullptr);
    ::el_set(line, EL_HIST, ::history, history);
    ::el_set(line, EL_GETCFN, read_one);
    ::el_set(line, EL_ADDFN, "complete", "Complete the word", complete_one);
    ::el_set(line, EL_BIND, "^I", "complete", nullptr);
    ::el_set(line, EL_BIND, "^R", "em-inc-search-prev", nullptr);
}

LineReader::Editor::~Editor() {
    ::history_end(history);
    ::el_end(line);
}

namespace {

LineReader::Editor& editor_of(EditLine* line) {
    void* editor = nullptr;
    ::el_get(line, EL_CLIENTDATA, &editor);
    return *static_cast<LineReader::Editor*>(editor);
}

} // namespace

LineReader::LineReader(Prompt& prompt, DebugSession& session, std::string history_file)
    : history_file_(std::move(history_file)), editor_(std::make_unique<Editor>(prompt, session)) {
    ::HistEvent event;
    if (!history_file_.empty()) ::history(editor_->history, &event, H_LOAD, history_file_.c_str());
}

LineReader::~LineReader() {
    if (history_file_.empty()) return;
    std::error_code ignored;
    std::filesystem::create_directories(std::filesystem::path(history_file_).parent_path(),
                                        ignored);
    ::HistEvent event;
    ::history(editor_->history, &event, H_SAVE, history_file_.c_str());
}

std::optional<std::string> LineReader::next() {
    while (true) {
        int length = 0;
        // el_gets would print the prompt before it sets the terminal mode: a Ctrl-D typed at once
        // would be lost.
        ::el_set(editor_->line, EL_PREP_TERM, 1);
        const char* read = ::el_gets(editor_->line, &length);
        if (was_interrupted()) {
            clear_interrupt();
            ::tcflush(STDIN_FILENO, TCIFLUSH);
            ::el_reset(editor_->line);
            fmt::print("\n");
            continue;
        }
        if (!read || length <= 0) return std::nullopt;
        std::string line(read, static_cast<size_t>(length));
        while (!line.empty() && (line.back() == '\n' || line.back() == '\r')) line.pop_back();
        ::HistEvent event;
        if (!line.empty()) ::history(editor_->history, &event, H_ENTER, line.c_str());
        return line;
    }
}

std::string history_file() {
    const char* state = std::getenv("XDG_STATE_HOME");
    const char* home = std::getenv("HOME");
    if (state && *state == '/') return std::string(state) + "/feeler/debug_history";
    if (home && *home == '/') return std::string(home) + "/.local/state/feeler/debug_history";
    return {};
}

namespace {

/// A file of commands, or one command.
struct Script {
    std::string text;
    bool is_file = false;
};

struct DebugOptions {
    CheckArguments what;
    std::vector<Script> scripts; // in the order of the command line
    bool batch = false;
};

void print(const std::string& text, FILE* to = stdout) {
    std::fputs(printable(text).c_str(), to);
    std::fflush(to);
}

/// A debug session driven by scripts or by a terminal.
class Console {
public:
    explicit Console(DebugSession& session) : session_(session), prompt_(session) {
        session.is_interrupted = [this] {
            const CheckRun& record = session_.record();
            line_.show(CheckProgress{record.blocks.size(), session_.recorded_fraction(),
                                     record.findings.size()});
            return was_interrupted();
        };
    }

    /// Runs the scripts. True if they ran to their end; false if a command failed or ended the
    /// session.
    bool run_scripts(const std::vector<Script>& scripts) {
        for (const Script& script : scripts) {
            if (!script.is_file) {
                if (!one(script.text, fmt::format("-ex '{}'", script.text))) return false;
                continue;
            }
            std::ifstream file(script.text);
            if (!file) {
                print(fmt::format("feeler: {}: cannot read this file\n", script.text), stderr);
                failed = true;
                return false;
            }
            if (!lines_of(file, script.text)) return false;
        }
        return true;
    }

    bool lines_of(std::istream& lines, const std::string& name) {
        std::string line;
        for (size_t number = 1; std::getline(lines, line); ++number)
            if (!one(line, fmt::format("{}:{}", name, number))) return false;
        return true;
    }

    void talk() {
        print(prompt_.greeting());
        LineReader reader(prompt_, session_, history_file());
        while (!ended_) {
            const auto line = reader.next();
            if (!line) {
                print("\n");
                return;
            }
            const PromptAnswer answer = answered(prompt_.answer(*line));
            print(answer.text);
            ended_ = answer.ends;
        }
    }

    bool failed = false;

private:
    /// Removes the progress line before the answer is printed.
    PromptAnswer answered(PromptAnswer answer) {
        line_.clear();
        clear_interrupt();
        return answer;
    }

    bool one(const std::string& line, const std::string& where) {
        PromptAnswer answer = prompt_.answer_script(line);
        if (was_interrupted() && !answer.failed) {
            print(answer.text);
            answer = {"interrupted\n", true};
        }
        answer = answered(std::move(answer));
        if (answer.failed) {
            print(fmt::format("feeler: {}: {}", where, answer.text), stderr);
            failed = true;
            return false;
        }
        print(answer.text);
        ended_ = answer.ends;
        return !ended_;
    }

    DebugSession& session_;
    Prompt prompt_;
    ProgressLine line_;
    bool ended_ = false;
};

ExitCode debug(const DebugOptions& options) {
    const auto job = job_of(options.what);
    if (!job) return failed(job.error());
    auto session = DebugSession::open(*job);
    if (!session) return failed(session.error());
    catch_interrupts();
    Console console(**session);
    const bool goes_on = console.run_scripts(options.scripts) || console.failed;
    if (goes_on && !options.batch) {
        if (isatty(STDIN_FILENO) == 1)
            console.talk();
        else if (!console.failed)
            console.lines_of(std::cin, "standard input");
    }
    return console.failed ? ExitCode::failed : ExitCode::clear;
}

} // namespace

void add_debug(CLI::App& cli, ExitCode& exit_code) {
    const auto options = std::make_shared<DebugOptions>();
    CLI::App& command =
        *cli.add_subcommand("debug", "Step through a program at a prompt, forwards and backwards");
    add_check_arguments(command, options->what)->required();
    add_start_line(command, options->what);
    const auto add_script = [options](bool is_file) {
        return [options, is_file](const std::string& text) {
            options->scripts.push_back({text, is_file});
        };
    };
    command
        .add_option_function<std::string>("-x,--command", add_script(true),
                                          "Run the commands in this file; may be repeated")
        ->trigger_on_parse();
    command
        .add_option_function<std::string>("--eval-command", add_script(false),
                                          "Run this command, also written -ex; may be repeated")
        ->trigger_on_parse();
    command.add_flag("--batch", options->batch, "Exit after these commands");
    command.callback([options, &exit_code] { exit_code = debug(*options); });
}

} // namespace app
