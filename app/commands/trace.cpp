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

Json axes_json(const gcode::Position& end) {
    Json axes = Json::array();
    for (const std::optional<double>& value : end) axes.push_back(value ? Json(*value) : Json());
    return axes;
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

    void operator()(const gcode::StraightTraverse& c) const { json["end"] = axes_json(c.end); }
    void operator()(const gcode::StraightFeed& c) const {
        json["end"] = axes_json(c.end);
        json["feed"] = c.feed;
    }
    void operator()(const gcode::ArcFeed& c) const {
        json["end"] = axes_json(c.end);
        json["plane"] = gcode::name_of(c.plane);
        json["centre"] = {c.centre[0], c.centre[1]};
        json["turns"] = c.turns;
        json["feed"] = c.feed;
    }
    void operator()(const gcode::Dwell& c) const { json["seconds"] = c.seconds; }
    void operator()(const gcode::SelectTool& c) const { json["tool"] = core::value_of(c.tool); }
    void operator()(const gcode::ChangeTool& c) const {
        json["tool"] = c.tool ? Json(core::value_of(*c.tool)) : Json(nullptr);
    }
    void operator()(const gcode::NameTool& c) const {
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
    void operator()(const gcode::SelectPlane& c) const { json["plane"] = gcode::name_of(c.plane); }
    void operator()(const gcode::SetOffset& c) const {
        json["number"] = c.offsets.active + 1;
        json["offset"] = axes_json(gcode::machine_minus_program(c.offsets));
        json["rotation_deg"] = c.offsets.work.rotation_deg;
        if (!c.offsets.has_frame) return;
        Json frame = Json::array();
        for (int row = 0; row < 3; ++row)
            frame.push_back({c.offsets.frame.linear[0][row], c.offsets.frame.linear[1][row],
                             c.offsets.frame.linear[2][row], c.offsets.frame.shift[row]});
        json["frame"] = std::move(frame);
    }
    void operator()(const gcode::UseToolLengthOffset& c) const {
        json["number"] = c.number ? Json(core::value_of(*c.number)) : Json(nullptr);
        json["length"] = c.offset[2];
        json["tool_offset"] = c.offset;
    }
    void operator()(const gcode::StraightProbe& c) const {
        json["end"] = axes_json(c.end);
        json["feed"] = c.feed;
        json["towards"] = c.towards;
        json["must_succeed"] = c.must_succeed;
    }
    void operator()(const gcode::ThreadFeed& c) const {
        json["end"] = axes_json(c.end);
        json["pitch"] = c.pitch;
        json["back_again"] = c.back_again;
    }
    void operator()(const gcode::UseSpindleMode& c) const {
        json["surface_speed"] = c.surface_speed;
        json["speed"] = c.speed;
        json["fastest_speed"] = c.fastest_speed;
    }
    void operator()(const gcode::SetPathMode& c) const {
        constexpr const char* names[] = {"exact_path", "exact_stop", "continuous"};
        json["mode"] = names[static_cast<size_t>(c.mode)];
        json["tolerance"] = c.tolerance;
        json["naive_tolerance"] = c.naive_tolerance;
    }
    void operator()(const gcode::EnableOverride& c) const {
        constexpr const char* names[] = {"feed", "speed", "adaptive_feed", "feed_hold"};
        json["kind"] = names[static_cast<size_t>(c.kind)];
        json["enabled"] = c.enabled;
    }
    void operator()(const gcode::SetOutput& c) const {
        json["number"] = c.number;
        json["value"] = c.value;
        json["analog"] = c.is_analog;
        json["with_motion"] = c.with_motion;
    }
    void operator()(const gcode::WaitForInput& c) const {
        json["number"] = c.number;
        json["analog"] = c.is_analog;
        json["seconds"] = c.seconds;
    }
    void operator()(const gcode::Message& c) const { json["message"] = c.text; }
    void operator()(const gcode::ProgramStop&) const {}
    void operator()(const gcode::OptionalStop&) const {}
    void operator()(const gcode::ProgramEnd&) const {}
};

std::string json_lines(const gcode::Run& run) {
    std::string text;
    for (const gcode::BlockResult& block : run.blocks) {
        for (size_t i = 0; i < block.commands.size(); ++i) {
            const gcode::CanonicalCommand& command = block.commands[i];
            Json json;
            json["block"] = core::value_of(block.block);
            if (!block.file.empty()) json["file"] = std::string(block.file);
            json["line"] = block.line;
            json["column"] = block.columns[i];
            if (!block.calls.empty()) json["calls"] = block.calls;
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
