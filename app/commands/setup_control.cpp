#include "app/commands/setup_control.h"

#include <CLI/CLI.hpp>

#include "app/check/check_job.h"
#include "app/check/prepared_check.h"
#include "app/commands/output.h"
#include "app/commands/program_arguments.h"
#include "app/commands/read_files.h"
#include "app/commands/suggestion.h"
#include "app/report/text/offset_report.h"
#include "app/setup/control/control_offsets.h"
#include "app/setup/control/offset_differences.h"
#include "app/setup/control/used_offsets.h"
#include "app/setup/tools/program_tools.h"
#include "gcode/text/source.h"

namespace app {

core::Result<OffsetComparison> comparison_of(const CheckJob& job,
                                             const std::vector<std::string>& files) {
    FEELER_TRY(const PreparedCheck check, read_check(job));
    const auto unit = unit_of_program(*check.program, unit_at_start(check.file.environment));
    FEELER_TRY(const ControlOffsets control,
               read_control_offsets(files, reading_of(check.file, unit)));
    return differences(check.file, control, used_offsets(*check.program, check.file.environment));
}

void add_control_arguments(CLI::App& command, ControlArguments& arguments) {
    const OptionGroup group(command, "Comparing with the control");
    CLI::Option* files =
        add_path(command, "--control", arguments.files,
                 "Instead of writing a set-up, compare that of the program with a file from the "
                 "control: LinuxCNC .var or .tbl, G10 blocks of Fanuc or Haas, Haas .ofs; may be "
                 "repeated")
            ->allow_extra_args(false);
    add_path(command, "--setup", arguments.setup,
             "The set-up to be compared or updated; default: NAME.toml next to NAME.nc");
    command.add_option("--format", arguments.format, "Of the comparison: text or json")
        ->check(one_of({"text", "json"}))
        ->capture_default_str()
        ->needs(files);
}

core::Result<ExitCode> compare_with_control(const std::string& program,
                                            const ProgramArguments& reading,
                                            const ControlArguments& arguments,
                                            const std::string& output) {
    const ReadFiles read;
    CheckArguments what;
    what.program = program;
    what.setup = arguments.setup;
    what.reading = reading;
    FEELER_TRY(const CheckJob job, job_of(what));
    FEELER_TRY(const OffsetComparison comparison, comparison_of(job, arguments.files));
    const ComparedFiles files{job.setup, arguments.files};
    const std::string text = arguments.format == "json" ? offset_json(comparison, files)
                                                        : offset_text(comparison, files);
    if (auto written = write_output(output, text, read); !written)
        return tl::unexpected(written.error());
    if (comparison.stopped) return ExitCode::failed;
    return comparison.differences() > 0 ? ExitCode::findings : ExitCode::clear;
}

} // namespace app
