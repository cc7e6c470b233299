#include <algorithm>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/commands/output.h"
#include "app/commands/program_arguments.h"
#include "app/commands/read_files.h"
#include "app/commands/suggestion.h"
#include "app/coproc/study/coprocessor_report.h"
#include "hwsim/vcd_trace.h"

namespace app {
namespace {

struct CoprocOptions {
    CheckArguments what;
    std::string config, device = "emulator", format = "text", output, vcd;
    std::optional<size_t> from, to;
    bool past_refusals = false, no_fit = false;
};

core::Result<std::string> report_of(const CoprocOptions& options, const CoprocessorResult& result) {
    if (options.format == "json") return coprocessor_json(result);
    if (options.format == "csv") return coprocessor_csv(result);
    return coprocessor_text(result);
}

/// The signals of a range of blocks, if --vcd is given.
struct Trace {
    std::optional<hwsim::VcdTrace> vcd;
    size_t from = 0, to = 0;

    void note(const BlocksInDevice& blocks, const hwsim::CoprocessorState& state) {
        if (vcd && blocks.newest >= from && blocks.oldest <= to) vcd->note(state);
    }
};

core::Result<CoprocessorResult> run(const CoprocOptions& options, Trace& trace) {
    DeviceFile file;
    if (!options.config.empty()) {
        FEELER_TRY(file, read_device_file(options.config));
    }
    CoprocessorJob job;
    FEELER_TRY(job.check, job_of(options.what));
    job.check.detail = core::Detail::every_pair;
    job.on_circuit = options.device == "rtl";
    // The size in which it is built.
    if (job.on_circuit && options.config.empty()) file.device.elements = 2;
    job.device = file.device;
    if (!options.no_fit) job.other_elements.assign(tried_elements.begin(), tried_elements.end());
    if (!options.vcd.empty()) {
        trace.vcd.emplace(job.device);
        trace.from = options.from.value_or(0);
        trace.to = options.to.value_or(trace.from);
        job.on_cycle = [&trace](const auto& blocks, const hwsim::CoprocessorState& state) {
            trace.note(blocks, state);
        };
    }
    FEELER_TRY(CoprocessorRun run, run_with_coprocessor(job));
    return in_time(std::move(run), file, options.past_refusals);
}

core::Result<ExitCode> coproc(const CoprocOptions& options) {
    const ReadFiles read;
    for (const std::string& output : {options.output, options.vcd})
        if (auto safe =
                check_output(output, {options.what.program, options.what.setup, options.config});
            !safe)
            return tl::unexpected(std::move(safe).error());
    if (options.to && *options.to < *options.from)
        return core::fail(core::ErrorCode::invalid_value, "--to must not be less than --from");
    Trace trace;
    FEELER_TRY(const CoprocessorResult result, run(options, trace));
    if (trace.vcd && trace.from >= result.run.blocks.size())
        return core::fail(core::ErrorCode::invalid_value,
                          fmt::format("--from {}: the program has {} blocks, numbered from 0",
                                      trace.from, result.run.blocks.size()));
    FEELER_TRY(const std::string report, report_of(options, result));
    if (auto written = write_output(options.output, report, read); !written)
        return tl::unexpected(std::move(written).error());
    if (trace.vcd)
        if (auto written = write_output(options.vcd, trace.vcd->text(), read); !written)
            return tl::unexpected(std::move(written).error());
    if (result.run.check.stopped) return failed(*result.run.check.stopped);
    const bool refuses = std::any_of(result.run.blocks.begin(), result.run.blocks.end(),
                                     [](const auto& block) { return !block.permit.permitted; });
    return refuses || result.timing.missed > 0 ? ExitCode::findings : ExitCode::clear;
}

} // namespace

void add_coproc(CLI::App& cli, ExitCode& exit_code) {
    const auto options = std::make_shared<CoprocOptions>();
    CLI::App& command = *cli.add_subcommand(
        "coproc", "Run a program with an emulated coprocessor that permits each block");
    add_check_arguments(command, options->what)->required();
    add_start_line(command, options->what);
    add_path(command, "--config", options->config,
             "Device file (TOML): [device], [control], [energy]");
    command
        .add_option("--device", options->device,
                    "emulator; or rtl: its circuit answers, with the emulator beside it")
        ->check(one_of({"emulator", "rtl"}))
        ->capture_default_str();
    command.add_option("--format", options->format, "text, json or csv")
        ->check(one_of({"text", "json", "csv"}))
        ->capture_default_str();
    add_path(command, "-o,--output", options->output, "Write the report to this file");
    auto* vcd = add_path(command, "--vcd", options->vcd,
                         "Write the signals of the coprocessor to this file, for GTKWave");
    auto* from = command.add_option("--from", options->from, "First block for --vcd")
                     ->needs(vcd)
                     ->check(CLI::NonNegativeNumber);
    command.add_option("--to", options->to, "Last block for --vcd")
        ->needs(from)
        ->check(CLI::NonNegativeNumber);
    command.add_flag("--past-refusals", options->past_refusals,
                     "Run refused blocks as if the operator had allowed them");
    command.add_flag("--no-fit", options->no_fit,
                     "Do not search for the smallest sufficient coprocessor");
    command.callback([options, &exit_code] {
        auto done = coproc(*options);
        exit_code = done ? *done : failed(done.error());
    });
}

} // namespace app
