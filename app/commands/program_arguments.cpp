#include "app/commands/program_arguments.h"

#include <filesystem>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/commands/suggestion.h"
#include "app/setup/ini_file.h"
#include "app/setup/program_settings.h"
#include "gcode/language/dialect.h"
#include "gcode/language/modal_state.h"

namespace app {
namespace {

std::string why_no_position(const std::string& text) {
    if (position_in(text)) return {};
    return fmt::format("'{}' is not a position: write machine coordinates in mm, such as "
                       "X=-100,Y=-50,Z=0",
                       text);
}

std::string why_no_count(const std::string& text) {
    const bool digits = text.find_first_not_of("0123456789") == std::string::npos;
    if (digits && !text.empty() && text.size() <= 18 && text.find_first_not_of('0') < text.size())
        return {};
    return fmt::format("'{}' is not a whole number above 0", text);
}

} // namespace

void add_program_arguments(CLI::App& command, ProgramArguments& arguments) {
    const OptionGroup group(command, "Reading the program");
    const auto dialects = gcode::dialect_names();
    command
        .add_option("--dialect", arguments.dialect,
                    "Dialect of the control; default: recognised from the program")
        ->check(one_of(std::vector<std::string>(dialects.begin(), dialects.end())));
    command
        .add_option("--start-position", arguments.start_position,
                    "Machine coordinates before the first block, mm: X=-100,Y=-50,Z=0")
        ->check(CLI::Validator(why_no_position, "AXIS=MM,..."));
    command
        .add_option("--block-delete", arguments.block_delete, "on: skip blocks that begin with /")
        ->check(one_of({"on", "off"}));
    add_path(command, "--parameters", arguments.parameters, "LinuxCNC variables file");
    add_path(command, "--tool-table", arguments.tool_table, "LinuxCNC tool table");
    add_path(command, "--ini", arguments.ini,
             "LinuxCNC ini file: unit, variables, tool table and search path");
    command
        .add_option("--machine-unit", arguments.machine_unit,
                    "Unit of lengths in the variables file and the tool table")
        ->check(one_of({"mm", "inch"}));
    command
        .add_option("--units", arguments.units,
                    "Unit of the program until its first G20 or G21; default: that of the control")
        ->check(one_of({"mm", "inch"}));
    command
        .add_option("--no-decimal-point", arguments.no_decimal_point,
                    "Fanuc, Haas: X1000 means 1000 units, or 1000 least input increments (steps)")
        ->check(one_of({"units", "steps"}));
    add_path(command, "--search-path", arguments.search_path,
             "Folder with subprograms; separate several with ':' (Windows: ';') or repeat "
             "the option")
        ->allow_extra_args(false);
    command
        .add_option("--max-blocks", arguments.max_blocks, "Stop a program after this many blocks")
        ->check(CLI::Validator(why_no_count, "COUNT"));
}

core::Result<ProgramSettings> settings_of(const ProgramArguments& arguments) {
    ProgramSettings settings;
    settings.dialect = gcode::dialect_named(arguments.dialect);
    if (!arguments.start_position.empty())
        settings.start = position_in(arguments.start_position).value_or(gcode::Position{});
    if (!arguments.block_delete.empty()) settings.block_delete = arguments.block_delete == "on";
    if (!arguments.machine_unit.empty())
        settings.machine_unit =
            arguments.machine_unit == "mm" ? gcode::LengthUnit::mm : gcode::LengthUnit::inch;
    if (!arguments.units.empty())
        settings.units_at_start =
            arguments.units == "mm" ? gcode::LengthUnit::mm : gcode::LengthUnit::inch;
    if (!arguments.no_decimal_point.empty())
        settings.counts_smallest_steps = arguments.no_decimal_point == "steps";
    settings.parameters = arguments.parameters;
    settings.tool_table = arguments.tool_table;
    settings.ini = arguments.ini;
    settings.max_blocks = arguments.max_blocks;
    for (const std::string& list : arguments.search_path) {
        for (const std::string& folder : split_search_path(list)) {
            std::error_code failure;
            if (!std::filesystem::is_directory(folder, failure))
                return core::fail(core::ErrorCode::io,
                                  fmt::format("--search-path: there is no folder {}", folder));
            settings.search_path.push_back(folder);
        }
    }
    return settings;
}

CLI::Option* add_check_arguments(CLI::App& command, CheckArguments& arguments) {
    CLI::Option* program = add_path(command, "program", arguments.program, "NC program");
    add_check_options(command, arguments);
    return program;
}

void add_check_options(CLI::App& command, CheckArguments& arguments) {
    const OptionGroup group(command, "Set-up, clearances and limits");
    add_path(command, "--setup", arguments.setup,
             "Set-up file (TOML); default: NAME.toml next to NAME.nc, else inferred from "
             "the program");
    command
        .add_option("--allowance", arguments.allowance,
                    "Minimum clearance to fixtures, and of the holder to the stock, mm")
        ->check(number_range(0.0, 1000.0))
        ->option_text("MM");
    command.add_option("--mesh-size", arguments.mesh_size, "Spacing of the scan lines, mm")
        ->check(number_range(1e-300, 1e300))
        ->option_text("MM");
    command
        .add_option("--memory-limit", arguments.memory_limit,
                    "Memory for the model of the stock, MB; default 8590")
        ->check(number_range(1.0, 1e9))
        ->option_text("MB");
    add_program_arguments(command, arguments.reading);
}

void add_start_line(CLI::App& command, CheckArguments& arguments) {
    const OptionGroup group(command, "Reading the program");
    command.add_option("--start-line", arguments.start_line,
                       "Start at this line, or at block N210, as after power-on, and report what "
                       "the program relies on");
}

core::Result<CheckJob> job_of(const CheckArguments& arguments) {
    FEELER_TRY(ProgramSettings settings, settings_of(arguments.reading));
    CheckJob job;
    job.program = arguments.program;
    job.setup = arguments.setup;
    find_setup_next_to(job);
    job.allowance = arguments.allowance;
    job.mesh_size = arguments.mesh_size;
    if (arguments.memory_limit) job.memory_limit = *arguments.memory_limit * 1e6;
    job.start_line = arguments.start_line;
    job.settings = std::move(settings);
    job.threads = std::max(1U, std::thread::hardware_concurrency());
    return job;
}

void add_device_arguments(CLI::App& command, DeviceArguments& arguments) {
    command.add_flag("--coprocessor", arguments.shown,
                     "Run the program with an emulated coprocessor and show its panel");
    add_path(command, "--device", arguments.file,
             "Use this device file (TOML), as for coproc --config; implies --coprocessor")
        ->each([&arguments](const std::string&) { arguments.shown = true; });
}

CLI::Validator number_range(double low, double high) {
    const auto check = [low, high](const std::string& text) {
        double number = 0.0;
        // Written so that NaN is refused, too.
        if (CLI::detail::lexical_cast(text, number) && number >= low && number <= high)
            return std::string();
        return fmt::format("{} is not a number from {:g} to {:g}", text, low, high);
    };
    return CLI::Validator(check, fmt::format("{:g}..{:g}", low, high));
}

} // namespace app
