#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/commands/output.h"
#include "app/commands/program_arguments.h"
#include "app/commands/read_files.h"
#include "app/commands/suggestion.h"
#include "app/report/text/trace_report.h"
#include "app/setup/program_settings.h"
#include "app/setup/setup_file.h"
#include "gcode/exec/interpreter.h"
#include "gcode/language/dialect.h"
#include "gcode/text/source.h"

namespace app {
namespace {

constexpr size_t buffer_size = 65536; // bytes per write

struct TraceOptions {
    std::string program, setup, output;
    ProgramArguments reading;
    std::string format = "text";
};

void print_notes(const std::vector<std::string>& notes) {
    for (const std::string& note : notes) print_note(fmt::format("feeler: {}\n", note));
}

/// What is stated about the program. `dialect` is empty if neither options nor set-up state it.
core::Result<SetupFile> stated_by(const TraceOptions& options) {
    FEELER_TRY(const ProgramSettings settings, settings_of(options.reading));
    if (!options.setup.empty()) return read_setup(options.setup, settings);
    SetupFile file;
    FEELER_TRY(const AppliedSettings applied, apply(settings, file.environment));
    print_notes(applied.notes);
    file.dialect = applied.settings.dialect;
    return file;
}

/// The stated dialect, else the recognised one, which is printed as a note.
core::Result<gcode::DialectId> choose_dialect(std::optional<gcode::DialectId> stated,
                                              const gcode::Program& program) {
    if (!stated) {
        const gcode::Recognition seen = gcode::recognise(program);
        FEELER_TRY(stated, gcode::supported(seen));
        print_note(fmt::format("feeler: dialect {}, because {}\n", gcode::dialect(*stated).name,
                               seen.reason));
    }
    return gcode::supported(*stated);
}

/// A trace in progress: each block is written before the next one is read.
struct Tracing {
    const TraceOptions& options;
    const gcode::Environment& environment;
    OutputStream out;
    const ReadFiles& read;
    std::string text{};
    WarningLog log{};

    void warn(const gcode::Warning& warning, std::string_view file) {
        print_note(log.line_for(warning, file.empty() ? options.program : file));
    }

    core::Result<void> add(const gcode::BlockCommands& block) {
        for (const gcode::Warning& warning : block.warnings) warn(warning, block.file);
        if (options.format == "jsonl")
            append_trace_json(block, text);
        else
            append_trace_text(block, text);
        return text.size() < buffer_size ? core::Result<void>{} : flush();
    }

    core::Result<void> flush() {
        auto written = out.write(text);
        text.clear();
        return written;
    }

    /// Errors: those of the program, after everything before the error was written; io of the
    /// output.
    core::Result<void> run(const gcode::Program& program) {
        gcode::ProgramLibrary library(program, gcode::dialect(environment.dialect),
                                      environment.search_path);
        gcode::Interpreter interpreter(library, environment);
        gcode::InterpreterState state = gcode::initial_state(environment);
        while (true) {
            const auto block = interpreter.next(state);
            if (!block) return stop(block.error());
            if (!*block) break;
            if (auto written = add(**block); !written) return written;
        }
        if (const auto warning = gcode::end_warning(environment, state)) warn(*warning, {});
        if (auto written = flush(); !written) return written;
        if (auto safe = read.check(options.output); !safe) return safe; // it may be a subprogram
        return out.finish();
    }

    core::Result<void> stop(core::Error error) {
        if (auto written = flush(); !written) return written;
        if (auto written = out.give_up(); !written) return written;
        return tl::unexpected(std::move(error));
    }
};

core::Result<void> run_trace(const TraceOptions& options) {
    const ReadFiles read;
    FEELER_TRY(gcode::Program program, gcode::open_program(options.program));
    const auto safe = check_output(options.output, {options.program, options.setup});
    if (!safe) return safe;
    FEELER_TRY(SetupFile stated, stated_by(options));
    gcode::Environment& environment = stated.environment;
    FEELER_TRY(environment.dialect, choose_dialect(stated.dialect, program));
    FEELER_TRY(const std::vector<std::string> notes,
               apply(stated.control, environment, stated.setup.machine));
    print_notes(notes);
    // A Klartext block may span several lines, which must be adjacent in memory.
    if (gcode::dialect(environment.dialect).language == gcode::Language::klartext
        && program.windows) {
        FEELER_TRY(program, gcode::read_program(options.program));
    }
    FEELER_TRY(OutputStream out, OutputStream::open(options.output));
    Tracing tracing{options, environment, std::move(out), read};
    auto traced = tracing.run(program);
    print_note(tracing.log.rest());
    return traced;
}

ExitCode trace(const TraceOptions& options) {
    auto traced = run_trace(options);
    if (traced) return ExitCode::clear;
    core::Error error = std::move(traced).error();
    if (error.file.empty()) error.file = options.program;
    return failed(error);
}

} // namespace

void add_trace(CLI::App& cli, ExitCode& exit_code) {
    const auto options = std::make_shared<TraceOptions>();
    CLI::App& command =
        *cli.add_subcommand("trace", "Print what each block means, as canonical commands");
    add_path(command, "program", options->program, "NC program")->required();
    add_path(command, "--setup", options->setup,
             "Set-up file (TOML), for offsets, tool lengths and start position");
    add_program_arguments(command, options->reading);
    command.add_option("--format", options->format, "text or jsonl")
        ->check(one_of({"text", "jsonl"}))
        ->capture_default_str();
    add_path(command, "-o,--output", options->output, "Write the trace to this file");
    command.callback([options, &exit_code] { exit_code = trace(*options); });
}

} // namespace app
