#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace CLI {
class App;
class Option;
class Validator;
} // namespace CLI

namespace app {

struct CheckJob;
struct ProgramSettings;

/// The options that control how a program is read, as given on the command line.
struct ProgramArguments {
    std::string dialect, start_position, block_delete, parameters, tool_table, ini, machine_unit,
        units, no_decimal_point;
    std::vector<std::string> search_path;
    std::optional<uint64_t> max_blocks;
};

/// Adds these options to a command. `arguments` must outlive it.
void add_program_arguments(CLI::App& command, ProgramArguments& arguments);

/// Converts the arguments to settings.
///
/// Errors: io for a missing folder of the search path.
core::Result<ProgramSettings> settings_of(const ProgramArguments& arguments);

/// The options that control what is checked, as given on the command line.
struct CheckArguments {
    std::string program, setup, start_line;
    std::optional<double> allowance, mesh_size, memory_limit; // mm, mm, MB
    ProgramArguments reading;
};

/// Adds these options and the program's name to a command. `arguments` must outlive it. Returns the
/// option of the program for further settings.
CLI::Option* add_check_arguments(CLI::App& command, CheckArguments& arguments);

/// As add_check_arguments, but without the program, for commands that take several.
void add_check_options(CLI::App& command, CheckArguments& arguments);

/// Adds the option --start-line to a command.
void add_start_line(CLI::App& command, CheckArguments& arguments);

/// Converts the arguments to a job.
///
/// Errors: those of settings_of.
core::Result<CheckJob> job_of(const CheckArguments& arguments);

/// The options of the emulated coprocessor.
struct DeviceArguments {
    std::string file; // empty: the default device
    bool shown = false;
};

/// Adds these options to a command. `arguments` must outlive it.
void add_device_arguments(CLI::App& command, DeviceArguments& arguments);

/// Refuses a value that is not a finite number from `low` to `high`.
CLI::Validator number_range(double low, double high);

} // namespace app
