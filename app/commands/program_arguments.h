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

/// The options that say how a program is read, as words of a command line.
struct ProgramArguments {
    std::string dialect, start_position, block_delete, parameters, tool_table, ini, machine_unit,
        no_decimal_point;
    std::vector<std::string> search_path;
    std::optional<uint64_t> max_blocks;
};

/// Gives a command these options. The arguments must outlive it.
void add_program_arguments(CLI::App& command, ProgramArguments& arguments);

/// What they mean.
///
/// Errors: io for a folder of the search path that is not there.
core::Result<ProgramSettings> settings_of(const ProgramArguments& arguments);

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

/// The options that say beside which coprocessor a program is run.
struct DeviceArguments {
    std::string file; // empty: the usual one
    bool shown = false;
};

/// Gives a command these options. The arguments must outlive it.
void add_device_arguments(CLI::App& command, DeviceArguments& arguments);

/// Refuses an option's value that is no finite number from `low` to `high`.
CLI::Validator number_range(double low, double high);

} // namespace app
