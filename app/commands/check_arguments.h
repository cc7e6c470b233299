#pragma once

#include "app/commands/program_arguments.h"
#include "app/session/check_run.h"

namespace app {

/// The options that say what is checked against what, as words of a command line.
struct CheckArguments {
    std::string program, setup, start_line;
    std::optional<double> allowance, mesh_size, memory_limit; // mm, mm, MB
    ProgramArguments reading;
};

/// Gives a command these options and the program's name. The arguments must outlive it. Result: the
/// option of the program, for who wants more of it.
CLI::Option* add_check_arguments(CLI::App& command, CheckArguments& arguments);

/// The same without the program, for who takes more than one.
void add_check_options(CLI::App& command, CheckArguments& arguments);

/// Gives a command that can start in the middle of a program the option for it, too.
void add_start_line(CLI::App& command, CheckArguments& arguments);

/// What they mean.
///
/// Errors: those of settings_of.
core::Result<CheckJob> job_of(const CheckArguments& arguments);

} // namespace app
