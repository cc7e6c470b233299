#include "app/commands/check_arguments.h"

#include "app/commands/number_range.h"

namespace app {

CLI::Option* add_check_arguments(CLI::App& command, CheckArguments& arguments) {
    CLI::Option* program = command.add_option("program", arguments.program, "NC program");
    add_check_options(command, arguments);
    return program;
}

void add_check_options(CLI::App& command, CheckArguments& arguments) {
    command.add_option(
        "--setup", arguments.setup,
        "Set-up file (TOML); else NAME.toml beside NAME.nc, else what the program says");
    command
        .add_option("--allowance", arguments.allowance,
                    "Clearance to keep from fixtures, and of the holder from the stock, mm")
        ->check(number_range(0.0, 1000.0));
    command.add_option("--mesh-size", arguments.mesh_size, "Spacing of the scan lines, mm")
        ->check(number_range(1e-300, 1e300));
    command
        .add_option("--memory-limit", arguments.memory_limit,
                    "What the model of the stock may take, MB (8590 unless said)")
        ->check(number_range(1.0, 1e9));
    add_program_arguments(command, arguments.reading);
}

void add_start_line(CLI::App& command, CheckArguments& arguments) {
    command.add_option("--start-line", arguments.start_line,
                       "Start at this line, or at block N210, as after switching on, and list what "
                       "is missing");
}

core::Result<CheckJob> job_of(const CheckArguments& arguments) {
    FEELER_TRY(ProgramSettings settings, settings_of(arguments.reading));
    CheckJob job;
    job.program = arguments.program;
    job.setup = arguments.setup;
    look_beside(job);
    job.allowance = arguments.allowance;
    job.mesh_size = arguments.mesh_size;
    if (arguments.memory_limit) job.memory_limit = *arguments.memory_limit * 1e6;
    job.start_line = arguments.start_line;
    job.settings = std::move(settings);
    return job;
}

} // namespace app
