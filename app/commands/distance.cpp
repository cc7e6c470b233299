#include <algorithm>
#include <charconv>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "app/bench/bench_scene.h"
#include "app/commands/commands.h"
#include "app/commands/output.h"
#include "app/commands/preset_arguments.h"
#include "app/commands/program_arguments.h"
#include "app/commands/read_files.h"
#include "app/commands/suggestion.h"
#include "app/report/text/bench_report.h"
#include "app/setup/body_table.h"
#include "core/cad/cad_file.h"
#include "core/geom/mesh_file.h"

namespace app {

/// A body given on the command line.
struct NamedBody {
    std::string name;
    MeasuredBody body;
    std::vector<std::string> repairs; // of its mesh and how closely it is meshed, as texts
    double deviation = 0.0;           // of its mesh from the true body, mm
};

/// Reads `sphere:R`, `box:X,Y,Z`, `cylinder:R,H` (axis Z), centred on the origin, a preset as in
/// `preset:vise-6,opening=50`, a mesh file, a CAD file, or a solid of it as in `vise.step#jaw`.
/// A CAD file is meshed within `deviation`.
///
/// Errors: sizes that are not positive lengths; those of preset_argument, preset_mesh, read_mesh,
///         read_cad.
core::Result<NamedBody> body_argument(const std::string& argument, double deviation);

namespace {

struct DistanceOptions {
    std::string a, b, output;
    std::string format = "text";
    std::string engine = "fast";
    double mesh_size = 0.5;
    double deviation = core::default_cad_deviation;
    std::vector<double> move = {0, 0, 0}, rotate = {0, 0, 0}, sweep = {0, 0, 0};
};

core::Vec3 vector(const std::vector<double>& v) { return {v[0], v[1], v[2]}; }

/// The error, with the name of the body that cannot be scanned, if it is one of a body.
core::Error named(core::Error error, const NamedBody& a, const NamedBody& b,
                  const DistanceOptions& options) {
    for (const NamedBody* body : {&a, &b})
        if (!points_of(body->body, options.mesh_size)) {
            error.message = fmt::format("{}: {}", body->name, error.message);
            break;
        }
    return error;
}

core::Result<std::string> answer(const DistanceOptions& options) {
    FEELER_TRY(const NamedBody a, body_argument(options.a, options.deviation));
    FEELER_TRY(const NamedBody b, body_argument(options.b, options.deviation));
    const core::Transform a_from_b{core::rotation_xyz_deg(vector(options.rotate)),
                                   vector(options.move)};
    const core::Vec3 sweep = vector(options.sweep);
    const auto engine = options.engine == "paper" ? core::paper_engine() : core::fast_engine();
    auto measured = measure(a.body, b.body, a_from_b, sweep, options.mesh_size, *engine);
    if (!measured) return tl::unexpected(named(std::move(measured).error(), a, b, options));
    BodyPairDistance& found = *measured;
    const double deviation = a.deviation + b.deviation;
    found.lower = std::max(0.0, found.lower - deviation);
    if (found.upper > 0.0) {
        found.upper += deviation;
        found.deviation = deviation;
    }
    for (const NamedBody* body : {&a, &b})
        for (const std::string& repair : body->repairs)
            print_note(fmt::format("{}: {}\n", body->name, repair));
    if (options.format == "json") return json_distance(found);
    return text_distance(found, a.name, b.name, sweep != core::Vec3(0.0));
}

ExitCode distance(const DistanceOptions& options) {
    const ReadFiles read;
    const auto text = answer(options);
    if (!text) return failed(text.error());
    const auto written = write_output(options.output, *text, read);
    if (written) return ExitCode::clear;
    return failed(written.error());
}

void add_vector(CLI::App& command, const char* name, std::vector<double>& value, const char* help) {
    command.add_option(name, value, help)
        ->delimiter(',')
        ->expected(3)
        ->check(number_range(-1e6, 1e6));
}

} // namespace

void add_distance(CLI::App& cli, ExitCode& exit_code) {
    const auto options = std::make_shared<DistanceOptions>();
    CLI::App& command = *cli.add_subcommand("distance", "Measure the distance between two bodies");
    const char* body = "Mesh file; CAD file, or one of its solids, as in vise.step#jaw; "
                       "sphere:R, box:X,Y,Z or cylinder:R,H, centred on the origin; or "
                       "preset:NAME,KEY=VALUE...";
    add_path(command, "a", options->a, body)->required();
    add_path(command, "b", options->b, body)->required();
    command.add_option("--mesh-size", options->mesh_size, "Spacing of the scan lines, mm")
        ->check(number_range(1e-300, 1e300))
        ->capture_default_str();
    command
        .add_option("--mesh-deviation", options->deviation,
                    "How far the mesh of a CAD file may be from its surface, mm")
        ->check(number_range(core::least_cad_deviation, core::largest_cad_deviation))
        ->capture_default_str();
    add_vector(command, "--move", options->move, "Move B by X,Y,Z, mm");
    add_vector(command, "--rotate", options->rotate,
               "Rotate B about its origin by RX,RY,RZ before the move, degrees, fixed axes");
    add_vector(command, "--sweep", options->sweep,
               "Then sweep B by X,Y,Z and measure the least distance along the way, mm");
    command
        .add_option("--engine", options->engine,
                    "fast, or paper (the published search); both find the same distance")
        ->check(one_of({"fast", "paper"}))
        ->capture_default_str();
    command.add_option("--format", options->format, "text or json")
        ->check(one_of({"text", "json"}))
        ->capture_default_str();
    add_path(command, "-o,--output", options->output, "Write the answer to this file");
    command.callback([options, &exit_code] { exit_code = distance(*options); });
}

namespace {

core::Result<std::vector<double>> sizes(const std::string& argument, size_t colon, size_t count) {
    std::vector<double> values;
    const char* at = argument.data() + colon + 1;
    const char* const end = argument.data() + argument.size();
    while (true) {
        double value = 0.0;
        const auto [next, failure] = std::from_chars(at, end, value);
        if (failure != std::errc()) break;
        values.push_back(value);
        at = next;
        if (at == end || *at != ',') break;
        ++at;
    }
    if (at == end && values.size() == count) return values;
    return core::fail(core::ErrorCode::invalid_value,
                      fmt::format("\"{}\" is not a body: write sphere:R, box:X,Y,Z or cylinder:R,H "
                                  "with sizes in mm",
                                  argument));
}

core::Result<core::Primitive> primitive(const std::string& argument, size_t colon) {
    const std::string kind = argument.substr(0, colon);
    if (kind == "sphere") {
        FEELER_TRY(const auto s, sizes(argument, colon, 1));
        return core::checked_primitive(core::Sphere{s[0]});
    }
    if (kind == "box") {
        FEELER_TRY(const auto s, sizes(argument, colon, 3));
        return core::checked_primitive(core::Box{{s[0], s[1], s[2]}});
    }
    FEELER_TRY(const auto s, sizes(argument, colon, 2));
    return core::checked_primitive(core::Cylinder{s[0], s[1]});
}

core::Result<NamedBody> preset_body(const std::string& argument, size_t colon) {
    FEELER_TRY(const ChosenPreset chosen, preset_argument(argument.substr(colon + 1)));
    FEELER_TRY(core::Mesh mesh, preset_mesh(*chosen.preset, chosen.values));
    return NamedBody{argument, core::solid_mesh(std::move(mesh)), {}};
}

/// The error of a mesh file that cannot be read, with a hint if it has the name of a preset.
core::Error mesh_error(core::Error error, const std::string& argument) {
    if (error.file.empty()) error.file = argument;
    const std::string name = argument.substr(0, argument.find(','));
    if (named_preset(name))
        error.message += fmt::format("; for the preset of this name, write preset:{}", argument);
    return error;
}

/// The file and the solid of "vise.step#jaw"; no solid in the name of a file itself.
struct CadArgument {
    std::string file, solid;
};

std::optional<CadArgument> cad_argument(const std::string& argument) {
    if (core::is_cad_file(argument)) return CadArgument{argument, {}};
    for (size_t hash = argument.find('#'); hash != std::string::npos;
         hash = argument.find('#', hash + 1))
        if (const std::string file = argument.substr(0, hash); core::is_cad_file(file))
            return CadArgument{file, argument.substr(hash + 1)};
    return std::nullopt;
}

core::Result<NamedBody> cad_body(const std::string& argument, const CadArgument& cad,
                                 double deviation) {
    FEELER_TRY(const auto file, core::read_cad(cad.file, deviation));
    auto body = core::body_of(*file, cad.solid);
    if (!body) return tl::unexpected(core::in_file(body.error(), cad.file));
    NamedBody named{argument, core::solid_mesh(std::move(body->mesh)), core::remarks_on(*file),
                    body->deviation};
    named.repairs.push_back(meshed_text(*body));
    return named;
}

} // namespace

core::Result<NamedBody> body_argument(const std::string& argument, double deviation) {
    if (const auto cad = cad_argument(argument)) return cad_body(argument, *cad, deviation);
    const size_t colon = argument.find(':');
    const std::string kind = argument.substr(0, std::min(colon, argument.size()));
    if (colon != std::string::npos && (kind == "sphere" || kind == "box" || kind == "cylinder")) {
        FEELER_TRY(const core::Primitive body, primitive(argument, colon));
        return NamedBody{argument, body, {}};
    }
    if (colon != std::string::npos && kind == "preset") return preset_body(argument, colon);
    auto read = core::read_mesh(argument);
    if (!read) return tl::unexpected(mesh_error(read.error(), argument));
    return NamedBody{argument, core::solid_mesh(std::move(read->mesh)), std::move(read->repairs)};
}

} // namespace app
