#include <cstdio>
#include <fstream>
#include <iostream>
#include <memory>

#include <fmt/format.h>
#include <unistd.h>

#include "app/commands/check_arguments.h"
#include "app/commands/commands.h"
#include "app/commands/interrupt.h"
#include "app/commands/line_reader.h"
#include "app/commands/output.h"
#include "app/commands/progress.h"
#include "app/report/text_layout.h"

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

/// A session at a prompt, whoever writes the commands.
class Console {
public:
    explicit Console(DebugSession& session) : session_(session), prompt_(session) {
        session.is_interrupted = [this] {
            const CheckRun& record = session_.record();
            line_.show(CheckProgress{record.blocks.size(), session_.recorded_share(),
                                     record.findings.size()});
            return was_interrupted();
        };
    }

    /// Whether it went on to the end of the scripts; false where a command failed or ended it.
    bool carry_out(const std::vector<Script>& scripts) {
        for (const Script& script : scripts) {
            if (!script.is_file) {
                if (!one(script.text, fmt::format("-ex '{}'", script.text))) return false;
                continue;
            }
            std::ifstream file(script.text);
            if (!file) {
                print(fmt::format("feeler: {}: this file cannot be read\n", script.text), stderr);
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
    /// What was said of a walk's progress goes away before its answer comes.
    PromptAnswer answered(PromptAnswer answer) {
        line_.clear();
        forget_interrupt();
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
    note_interrupts();
    Console console(**session);
    const bool goes_on = console.carry_out(options.scripts) || console.failed;
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
        *cli.add_subcommand("debug", "Step through a program at a prompt, forwards and back");
    add_check_arguments(command, options->what)->required();
    add_start_line(command, options->what);
    const auto add_script = [options](bool is_file) {
        return [options, is_file](const std::string& text) {
            options->scripts.push_back({text, is_file});
        };
    };
    command
        .add_option_function<std::string>("-x,--command", add_script(true),
                                          "Carry out the commands of a file; may be repeated")
        ->trigger_on_parse();
    command
        .add_option_function<std::string>("--eval-command", add_script(false),
                                          "Carry out a command, also written -ex; may be repeated")
        ->trigger_on_parse();
    command.add_flag("--batch", options->batch, "End behind these commands");
    command.callback([options, &exit_code] { exit_code = debug(*options); });
}

} // namespace app
