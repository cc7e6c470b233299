#pragma once

namespace CLI {
class App;
}

namespace app {

/// The exit status of the program.
enum class ExitCode : int {
    clear = 0,    // no finding of severity error
    findings = 1, // at least one
    failed = 2,   // not completed
};

/// Each adds a subcommand that sets `exit_code` when it runs.
void add_check(CLI::App& cli, ExitCode& exit_code);
void add_setup(CLI::App& cli, ExitCode& exit_code);
void add_coproc(CLI::App& cli, ExitCode& exit_code);
void add_trace(CLI::App& cli, ExitCode& exit_code);
void add_debug(CLI::App& cli, ExitCode& exit_code);
void add_distance(CLI::App& cli, ExitCode& exit_code);
void add_presets(CLI::App& cli, ExitCode& exit_code);
void add_bench(CLI::App& cli, ExitCode& exit_code);
void add_view(CLI::App& cli, ExitCode& exit_code);
void add_shot(CLI::App& cli, ExitCode& exit_code);
void add_filter(CLI::App& cli, ExitCode& exit_code);
void add_gate(CLI::App& cli, ExitCode& exit_code);
void add_guard(CLI::App& cli, ExitCode& exit_code);
void add_sheet(CLI::App& cli, ExitCode& exit_code);
void add_merge(CLI::App& cli, ExitCode& exit_code);
void add_history(CLI::App& cli, ExitCode& exit_code);
void add_diff(CLI::App& cli, ExitCode& exit_code);
void add_completion(CLI::App& cli, ExitCode& exit_code);

} // namespace app
