#pragma once

#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "app/setup/program_settings.h"

namespace app {

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

} // namespace app
