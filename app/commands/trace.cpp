#include "gcode/trace.h"

#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/commands/commands.h"
#include "app/commands/output.h"
#include "app/report/text_report.h"
#include "app/setup/setup_file.h"

namespace app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
    std::string program, setup, dialect, output;
    std::string format = "text";
};

/// Nine axes, of which this version moves three.
Json end_json(const gcode::Position& end) {
    Json axes = Json::array();
    for (const std::optional<double>& value : end) axes.push_back(value ? Json(*value) : Json());
    while (axes.size() < 9) axes.push_back(0.0);
    return axes;
}

const char* plane_name(gcode::Plane plane) {
    switch (plane) {
    case gcode::Plane::xy:
        return "XY";
    case gcode::Plane::zx:
        return "ZX";
    default:
        return "YZ";
    }
}

const char* direction_name(core::SpindleDirection direction) {
    switch (direction) {
    case core::SpindleDirection::stopped:
        return "stopped";
    case core::SpindleDirection::clockwise:
        return "clockwise";
    default:
        return "counterclockwise";
    }
}

struct Keys {
    Json& json;

    void operator()(const gcode::StraightTraverse& c) const { json["end"] = end_json(c.end); }
    void operator()(const gcode::StraightFeed& c) const {
        json["end"] = end_json(c.end);
        json["feed"] = c.feed;
    }
    void operator()(const gcode::ArcFeed& c) const {
        json["end"] = end_json(c.end);
        json["plane"] = plane_name(c.plane);
        json["centre"] = {c.centre[0], c.centre[1]};
        json["turns"] = c.turns;
        json["feed"] = c.feed;
    }
    void operator()(const gcode::Dwell& c) const { json["seconds"] = c.seconds; }
    void operator()(const gcode::SelectTool& c) const { json["tool"] = core::value_of(c.tool); }
    void operator()(const gcode::ChangeTool& c) const {
        json["tool"] = c.tool ? Json(core::value_of(*c.tool)) : Json(nullptr);
    }
    void operator()(const gcode::Spindle& c) const {
        json["direction"] = direction_name(c.direction);
        json["speed"] = c.speed;
    }
    void operator()(const gcode::Coolant& c) const {
        json["mist"] = c.mist;
        json["flood"] = c.flood;
    }
    void operator()(const gcode::SelectPlane& c) const { json["plane"] = plane_name(c.plane); }
    void operator()(const gcode::SetOffset& c) const {
        json["offset"] = Json::array();
        for (const std::optional<double>& value : gcode::machine_minus_program(c.offsets))
            json["offset"].push_back(value ? Json(*value) : Json());
    }
    void operator()(const gcode::UseToolLengthOffset& c) const {
        json["number"] = c.number ? Json(core::value_of(*c.number)) : Json(nullptr);
        json["length"] = c.length;
    }
    void operator()(const gcode::ProgramStop&) const {}
    void operator()(const gcode::OptionalStop&) const {}
    void operator()(const gcode::ProgramEnd&) const {}
};

std::string json_lines(const gcode::Run& run) {
    std::string text;
    for (const gcode::BlockResult& block : run.blocks) {
        for (const gcode::CanonicalCommand& command : block.commands) {
            Json json;
            json["block"] = core::value_of(block.block);
            json["line"] = block.line;
            json["command"] = gcode::command_name(command);
            std::visit(Keys{json}, command);
            json["text"] = std::string(block.text);
            text += json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
        }
    }
    return text;
}

void print_warnings(const std::string& file, const gcode::Run& run) {
    const auto print = [&](const gcode::Warning& warning) {
        core::Error place{core::ErrorCode::syntax, warning.where, warning.message, file};
        fmt::print(stderr, "{}\n", error_text(place));
    };
    for (const gcode::BlockResult& block : run.blocks)
        for (const gcode::Warning& warning : block.warnings) print(warning);
    if (run.ending) print(*run.ending);
}

core::Result<gcode::Environment> environment_of(const Options& options,
                                                const gcode::Program& program) {
    gcode::Environment environment;
    std::optional<gcode::DialectId> dialect = gcode::dialect_named(options.dialect);
    if (!options.setup.empty()) {
        FEELER_TRY(const SetupFile setup, read_setup(options.setup));
        environment = setup.environment;
        if (!dialect) dialect = setup.dialect;
    }
    environment.dialect = dialect ? *dialect : gcode::recognise(program).dialect;
    if (gcode::dialect(environment.dialect).supported) return environment;
    return core::fail(core::ErrorCode::unsupported,
                      fmt::format("the dialect {} is not supported by this version",
                                  gcode::dialect(environment.dialect).name));
}

ExitCode failed(core::Error error, const std::string& file) {
    if (error.file.empty()) error.file = file;
    print_error(error);
    return ExitCode::failed;
}

ExitCode trace(const Options& options) {
    const auto program = gcode::read_program(options.program);
    if (!program) return failed(program.error(), options.program);
    const auto environment = environment_of(options, *program);
    if (!environment) return failed(environment.error(), options.program);
    const gcode::Run run = gcode::run(*program, *environment);
    print_warnings(options.program, run);
    const bool json = options.format == "jsonl";
    const auto written =
        write_output(run.error ? "" : options.output, json ? json_lines(run) : gcode::to_text(run));
    if (!written) return failed(written.error(), options.output);
    return run.error ? failed(*run.error, options.program) : ExitCode::clear;
}

} // namespace

void add_trace(CLI::App& cli, ExitCode& exit_code) {
    const auto options = std::make_shared<Options>();
    CLI::App& command = *cli.add_subcommand("trace", "Print the canonical commands of a program");
    command.add_option("program", options->program, "NC program")->required();
    command.add_option("--setup", options->setup,
                       "Set-up file (TOML): offsets, tool lengths, start");
    command.add_option("--dialect", options->dialect, "linuxcnc, fanuc, haas or grbl")
        ->check(CLI::IsMember({"linuxcnc", "fanuc", "haas", "grbl", "siemens", "heidenhain"}));
    command.add_option("--format", options->format, "text or jsonl")
        ->check(CLI::IsMember({"text", "jsonl"}))
        ->capture_default_str();
    command.add_option("-o,--output", options->output, "Write the trace to this file");
    command.callback([options, &exit_code] { exit_code = trace(*options); });
}

} // namespace app
