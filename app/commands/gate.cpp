#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/commands/output.h"
#include "app/commands/progress.h"
#include "app/commands/suggestion.h"
#include "app/gate/gate_ports.h"

namespace app {
namespace {

struct GateOptions {
    std::string setup;
    GatePorts ports;
    LineCheck::Options check;
};

core::Result<ExitCode> run(const GateOptions& options) {
    FEELER_TRY(LineCheck check, LineCheck::open(options.setup, options.check));
    const auto note = [](const std::string& text) { print_note(text + "\n"); };
    for (const std::string& assumption : check.assumptions()) note(assumption);
    FEELER_TRY(const GateCounts counts, run_gate(options.ports, check, is_interrupted, note));
    print_note(fmt::format("{} lines passed, {} refused\n", counts.passed, counts.refused));
    return counts.refused == 0 ? ExitCode::clear : ExitCode::findings;
}

ExitCode gate(GateOptions options) {
    constexpr const char* usual_address = "127.0.0.1:2300";
    stop_on_interrupt();
    if (options.ports.listen.empty() && options.ports.terminal.empty())
        options.ports.listen = usual_address;
    const auto done = run(options);
    return done ? *done : failed(done.error());
}

constexpr const char* gate_examples = R"(
An assistant, never a safety function. The sender connects to the gate and not to the controller:
  feeler gate --setup router.toml --controller /dev/ttyUSB0
  feeler gate --setup router.toml --controller 192.168.1.5:23 --pty /tmp/grbl)";

} // namespace

void add_gate(CLI::App& cli, ExitCode& exit_code) {
    const auto options = std::make_shared<GateOptions>();
    CLI::App& command = *cli.add_subcommand(
        "gate", "Stand between a sender and a Grbl controller, and let pass only lines that are "
                "clear");
    add_path(command, "--setup", options->setup, "The set-up of the machine")->required();
    command
        .add_option("--controller", options->ports.controller,
                    "The serial port of the controller, or its address as HOST:PORT")
        ->required();
    command.add_option("--baud", options->ports.baud, "Speed of the serial port")
        ->check(CLI::Range(1200u, 4000000u))
        ->capture_default_str();
    command.add_option("--listen", options->ports.listen,
                       "Where the sender connects by TCP, as HOST:PORT; 127.0.0.1:2300 if there is "
                       "no --pty");
    add_path(command, "--pty", options->ports.terminal,
             "Where the sender finds a serial port of the gate: a link that the gate makes");
    command.add_option("--tool", options->check.tool, "The tool in the spindle")
        ->check(CLI::Range(0, 99999));
    command
        .add_option(
            "--tolerance", options->check.tolerance,
            "How far work offset and tool length of the control may differ from the set-up, "
            "mm")
        ->check(CLI::Range(0.0, 10.0))
        ->capture_default_str();
    command.add_flag(
        "--zero-is-set", options->check.zero_is_set,
        "Take the control's work offset for the place of the work, without waiting for "
        "$FEELER=ZERO");
    command.footer(gate_examples);
    command.callback([options, &exit_code] { exit_code = gate(*options); });
}

} // namespace app
