#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "app/base/text.h"
#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/commands/commands.h"
#include "app/commands/interrupt.h"
#include "app/commands/line_reader.h"
#include "app/commands/output.h"
#include "app/commands/program_arguments.h"
#include "app/commands/progress.h"
#include "app/debug/prompt/prompt.h"
#include "core/base/platform.h"

namespace app {

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

/// Path of this user's history file; empty if there is no suitable folder.
std::string history_file() {
    const std::filesystem::path folder = core::platform::state_folder();
    return folder.empty() ? std::string() : (folder / "feeler" / "debug_history").generic_string();
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
            std::ifstream file{std::filesystem::path(script.text)};
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
        if (core::platform::is_terminal(stdin))
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
