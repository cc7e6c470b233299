#include "app/setup/body_table.h"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/base/text.h"
#include "app/setup/kept_meshes.h"
#include "app/setup/presets/preset.h"
#include "app/setup/setup_file.h"
#include "app/setup/table_reader.h"
#include "core/base/file_reads.h"
#include "core/base/text.h"
#include "core/cad/cad_file.h"
#include "core/dbm/stock_record.h"
#include "core/geom/mesh.h"
#include "core/geom/mesh_file.h"
#include "core/motion/kinematics.h"
#include "core/motion/machine.h"
#include "core/sim/clearance.h"
#include "core/sim/verdict.h"
#include "gcode/language/canonical.h"

namespace app {

MeshSource BodyContext::meshes() { return {folder, file.assumptions, &file.cad_names}; }

namespace {

/// The sizes of a `cylinder`, which stands on the origin of its body.
struct CylinderKey {
    double radius = 0.0;
    double height = 0.0;
    int axis = 2;
};

/// Position of a body: its `at`, `rotate_deg` and `frame`.
struct Placement {
    core::Transform machine_from_frame;
    core::Transform frame_from_body;

    core::Transform machine_from_body() const { return machine_from_frame * frame_from_body; }
};

core::Transform read_pose(TableReader& table) {
    return {core::rotation_xyz_deg(
                table.vector("rotate_deg", Measure::angle).value_or(core::Vec3(0.0))),
            table.vector("at", Measure::length).value_or(core::Vec3(0.0))};
}

/// Whether the set-up or a variables file states where a work offset is.
bool is_placed(const SetupFile& file, size_t offset) {
    return file.offsets_set.contains(static_cast<int>(offset))
           || (!file.infers_frame && file.environment.work_offset(offset) != gcode::AxisValues{});
}

/// Whether a place can be assumed for the bodies in a work offset that nothing states: if no body
/// or work offset has another place, only their places relative to each other count. A variables
/// file without a value says that the offset is 0.
bool may_assume_place(const SetupFile& file, size_t offset) {
    if (!file.environment.parameters.empty()) return true;
    const bool is_only_one =
        file.offsets_of_bodies.empty() || file.offsets_of_bodies.contains(offset);
    return is_only_one && file.offsets_set.empty()
           && (file.infers_frame || file.setup.machine.has_rotary());
}

/// Whether a stock in a work offset that nothing states gets a place when the set-up is completed:
/// if it is the only body, and tools are left open.
bool gets_place_later(const BodyContext& context) {
    const SetupFile& file = context.file;
    const bool has_tools =
        !file.setup.tools.empty() || !file.library.empty() || !file.tool_table.empty();
    return context.has_only_stock && !file.offsets_set.empty() && !has_tools
           && !file.setup.machine.has_rotary();
}

/// A work offset that a body could stand in instead, for a message.
std::string other_offset(const SetupFile& file) {
    const auto after = [](const std::string& name) { return ", such as " + name; };
    if (!file.offsets_set.empty())
        return after(gcode::name_of_offset(static_cast<size_t>(*file.offsets_set.begin())));
    if (file.offsets_of_bodies.empty()) return {};
    return after(gcode::name_of_offset(*file.offsets_of_bodies.begin()))
           + ", in which other bodies are";
}

/// Refuses a body in a work offset whose place nobody knows.
void check_place(TableReader& table, BodyContext& context, size_t offset) {
    SetupFile& file = context.file;
    if (is_placed(file, offset)) return;
    if (may_assume_place(file, offset) || gets_place_later(context)) {
        file.offsets_of_bodies.insert(offset);
        file.names_offset_of_bodies = file.names_offset_of_bodies || table.has("frame");
        return;
    }
    const std::string name = gcode::name_of_offset(offset);
    table.refuse("frame",
                 fmt::format("{} \"{}\" is a work offset that the set-up does not state, so the "
                             "place of this body is not known: add {} to [offsets], or choose "
                             "another frame{}",
                             table.has("frame") ? "=" : "is missing:", name, name,
                             other_offset(file)));
}

core::Transform read_frame(TableReader& table, BodyContext& context) {
    std::string frame = table.string("frame").value_or("G54");
    if (const auto offset = gcode::offset_of_name(frame)) {
        frame = gcode::name_of_offset(*offset);
        check_place(table, context, *offset);
    }
    if (const auto found = context.frames.find(frame)) return *found;
    // Where no work offset is stated, those with numbers are where the others are.
    if (context.file.infers_frame && gcode::offset_of_name(frame))
        return context.frames.machine_from.at("G54");
    std::vector<std::string> known;
    for (const auto& [name, transform] : context.frames.machine_from) known.push_back(name);
    table.refuse("frame", fmt::format("\"{}\" is not known; known frames: {}", frame,
                                      fmt::join(known, " ")));
    return {};
}

Placement read_placement(TableReader& table, BodyContext& context) {
    return {read_frame(table, context), read_pose(table)};
}

/// The shape that is given; exactly one must be.
std::optional<std::string> only_shape(TableReader& table, bool may_be_preset) {
    std::vector<std::string> given;
    for (const char* key : {"box", "cylinder", "mesh", "model", "preset"})
        if (table.has(key)) given.emplace_back(key);
    if (given.size() == 1) return given[0];
    const std::string and_preset = may_be_preset ? ", preset" : "";
    table.need((given.empty()
                    ? "one of box, cylinder, mesh" + and_preset
                    : "a single shape: box, cylinder, mesh" + and_preset + " exclude each other;")
                   .c_str());
    return std::nullopt;
}

/// Refuses a preset where none can be.
void refuse_preset(TableReader& table) {
    if (table.has("preset")) table.refuse("preset", "applies only to fixtures and machine bodies");
}

core::Aabb read_box(TableReader& table) {
    const auto corners = table.rows("box", Measure::length, 3);
    core::Aabb box;
    for (const std::vector<double>& c : corners) box.extend(core::Vec3(c[0], c[1], c[2]));
    const core::Vec3 size = box.size();
    if (corners.size() != 2 || !(std::min({size.x, size.y, size.z}) > 0.0))
        table.refuse("box", "must be two opposite corners, as in [[0, 0, -30], [100, 100, 0]]");
    return box;
}

CylinderKey read_cylinder(TableReader& table) {
    CylinderKey cylinder;
    if (auto inner = table.table("cylinder", table.name() + " cylinder")) {
        cylinder.radius = inner->number_or("radius", Measure::length, 0.0);
        cylinder.height = inner->number_or("height", Measure::length, 0.0);
        const std::string axis = inner->word("axis", {"X", "Y", "Z"}).value_or("Z");
        cylinder.axis = axis[0] - 'X';
        inner->finish();
        if (!(cylinder.radius > 0.0 && cylinder.height > 0.0))
            table.refuse("cylinder", "needs a radius and a height above 0");
    }
    return cylinder;
}

core::Mesh moved(core::Mesh mesh, const core::Transform& by) {
    for (core::Vec3& v : mesh.vertices) v = by * v;
    return mesh;
}

/// A box or mesh in the target frame, as a mesh.
BodyMesh read_polyhedron(TableReader& table, const MeshSource& source, const std::string& shape,
                         const core::Transform& target_from_body) {
    BodyMesh read = shape == "box" ? BodyMesh{core::mesh_of(read_box(table))}
                                   : read_mesh_file(table, "mesh", source).value_or(BodyMesh{});
    read.mesh = moved(std::move(read.mesh), target_from_body);
    return read;
}

core::Solid stock_solid(TableReader& table, BodyContext& context, const std::string& shape,
                        const core::Transform& frame_from_body) {
    const bool rotated = frame_from_body.rotation != core::Mat3(1.0);
    if (shape == "cylinder") {
        if (rotated) table.refuse("rotate_deg", "cannot turn a cylinder: state its axis instead");
        const CylinderKey c = read_cylinder(table);
        return {core::SolidCylinder{frame_from_body.translation, c.radius, c.height, c.axis}, 0.0};
    }
    if (shape == "box" && !rotated) {
        const core::Aabb box = read_box(table);
        const core::Vec3 at = frame_from_body.translation;
        return {core::SolidBox{{box.min + at, box.max + at}}, 0.0};
    }
    BodyMesh read = read_polyhedron(table, context.meshes(), shape, frame_from_body);
    return {.shape = kept_solid(std::move(read.mesh)), .deviation = read.deviation};
}

/// A cylinder along one of its body's axes, with its base centre at the body's origin.
core::ConvexShape standing(const CylinderKey& cylinder) {
    const core::ConvexShape upright = core::convex(
        core::ProfileElement{0.0, cylinder.radius, cylinder.height, cylinder.radius, 0.0});
    if (cylinder.axis == 2) return upright;
    const core::Vec3 turn = cylinder.axis == 0 ? core::Vec3(0, 90, 0) : core::Vec3(-90, 0, 0);
    return core::posed(upright, {core::rotation_xyz_deg(turn), core::Vec3(0.0)});
}

/// The range of a parameter, for a message.
std::string range_text(const TableReader& table, const PresetParameter& parameter) {
    if (parameter.measure == PresetMeasure::count)
        return fmt::format("a whole number from {:g} to {:g}", parameter.least, parameter.greatest);
    return fmt::format("between {} and {}", table.shown(parameter.least),
                       table.shown(parameter.greatest));
}

} // namespace

PresetValues read_preset_values(TableReader& table, const Preset& preset) {
    PresetValues values;
    for (const PresetParameter& parameter : preset.parameters) {
        const std::string key(parameter.key);
        const bool is_length = parameter.measure == PresetMeasure::length;
        const auto value = table.number(key.c_str(), is_length ? Measure::length : Measure::plain);
        if (!value) continue;
        if (!fits(parameter, *value))
            table.refuse(key.c_str(), fmt::format("of {} must be {}", preset.name,
                                                  range_text(table, parameter)));
        values.emplace(key, *value);
    }
    return values;
}

namespace {

/// Says which sizes of a body are those of its preset; empty if it states all.
std::string preset_assumption(const std::string& body, const Preset& preset,
                              const PresetValues& stated) {
    if (stated.size() == preset.parameters.size()) return {};
    std::vector<std::string> keys;
    for (const auto& [key, value] : stated) keys.push_back(key);
    return fmt::format("{}: {} are those of the preset {}, not measured", body,
                       keys.empty() ? "all sizes"
                                    : fmt::format("sizes other than {}", fmt::join(keys, ", ")),
                       preset.name);
}

/// Reads the preset that a table names, with its parameters. Empty after an error.
std::optional<core::Mesh> read_preset(TableReader& table, const MeshSource& source) {
    const std::string name = table.string("preset").value_or("");
    const auto refuse = [&](const std::string& why) {
        table.refuse("preset", fmt::format("= \"{}\": {}", name, why));
        return std::nullopt;
    };
    const Preset* preset = find_preset(name);
    if (!preset) return refuse(unknown_preset_text(name));
    const PresetValues values = read_preset_values(table, *preset);
    auto mesh = preset_mesh(*preset, values);
    if (!mesh) return refuse(mesh.error().message);
    const std::string assumption =
        preset_assumption(table.string("name").value_or(name), *preset, values);
    if (!assumption.empty()) source.assumptions.push_back(assumption);
    return *std::move(mesh);
}

std::optional<DeviatingBody> exact_body(TableReader& table, const MeshSource& source,
                                        const core::Transform& target_from_body) {
    const auto shape = only_shape(table, true);
    if (!shape) return std::nullopt;
    const auto exact = [&](const core::ConvexShape& convex) {
        return DeviatingBody{core::posed(convex, target_from_body)};
    };
    if (*shape == "cylinder") return exact(standing(read_cylinder(table)));
    if (*shape == "box") return exact(core::convex(read_box(table)));
    BodyMesh read;
    if (*shape == "preset")
        read.mesh = read_preset(table, source).value_or(core::Mesh{});
    else
        read = read_mesh_file(table, "mesh", source).value_or(BodyMesh{});
    return DeviatingBody{kept_solid(moved(std::move(read.mesh), target_from_body)), read.deviation};
}

bool has_no_shape(const TableReader& table) {
    for (const char* key : {"box", "cylinder", "mesh", "model"})
        if (table.has(key)) return false;
    return true;
}

/// Reads a stock without a shape, which is inferred from the cutting moves.
void read_envelope(TableReader& table, BodyContext& context, const Placement& placement) {
    constexpr double largest_margin = 1000.0; // mm
    SetupFile& file = context.file;
    if (!has_no_shape(table))
        table.refuse("margin", "applies only to an inferred stock, that is, one without a shape");
    for (const char* key : {"at", "rotate_deg"})
        if (table.has(key)) table.refuse(key, "does not apply to a stock without a shape");
    if (file.stock_margin && !(*file.stock_margin >= 0.0 && *file.stock_margin <= largest_margin))
        table.refuse("margin", "must lie between 0 and " + table.shown(largest_margin));
    file.needs_stock = true;
    file.setup.stock_mount = {file.setup.machine.table, placement.machine_from_frame};
    file.setup.stock.tolerance = table.number_or("tolerance", Measure::length, 0.0);
    if (file.setup.stock.tolerance < 0.0) table.refuse("tolerance", "must not be negative");
    context.frames.machine_from["stock"] = placement.machine_from_frame;
    table.finish();
}

core::ExactBody moved(const core::ExactBody& body, const core::Transform& by) {
    if (const auto* shape = std::get_if<core::ConvexShape>(&body)) return core::posed(*shape, by);
    return kept_solid(moved(*std::get<core::SolidMesh>(body).mesh, by));
}

/// The number of an M code such as "M61"; empty for any other text.
std::optional<int> m_code(const std::string& text) {
    if (text.empty() || core::upper(text[0]) != 'M') return {};
    const auto number = number_in(std::string_view(text).substr(1));
    if (!number || *number < 0.0 || *number > 99999.0 || *number != std::floor(*number)) return {};
    return static_cast<int>(*number);
}

/// Reads a `[[fixture.move]]` of the last fixture. Returns its new pose; empty if it is removed.
std::optional<core::Transform> read_move(TableReader& table, core::Setup& setup, size_t last,
                                         std::set<int>& known_codes) {
    core::FixtureMove move{.from = last};
    if (const auto line = table.integer("line")) {
        if (*line < 1) table.refuse("line", "counts from 1");
        move.line = static_cast<uint32_t>(std::max(*line, 1));
    }
    if (const auto code = table.string("code")) {
        move.code = m_code(*code);
        if (!move.code) table.refuse("code", "must be an M code, as in \"M61\"");
    }
    if (table.has("line") == table.has("code")) table.need("one of line, code");
    const bool removed = table.boolean("remove").value_or(false);
    if (removed && (table.has("at") || table.has("rotate_deg")))
        table.refuse("remove", "removes the fixture: do not give a position as well");
    if (!removed) move.to = setup.fixtures.size();
    const core::Transform to = read_pose(table);
    table.finish();
    setup.fixture_moves.push_back(move);
    if (move.code) known_codes.insert(*move.code);
    return removed ? std::nullopt : std::optional(to);
}

core::Result<core::StockRecord> read_record(const std::filesystem::path& path) {
    if (const std::string why = core::why_no_file(path); !why.empty())
        return core::fail(core::ErrorCode::io, why);
    const std::optional<std::string> bytes = core::file_bytes(path);
    if (!bytes) return core::fail(core::ErrorCode::io, "it cannot be read");
    return core::stock_record(*bytes);
}

/// Reads a stock saved after an earlier program (check --save-stock).
void read_model(TableReader& table, BodyContext& context, const Placement& placement) {
    const std::string name = table.string("model").value_or("");
    auto record = read_record(context.folder / name);
    if (record) record = core::moved(*std::move(record), placement.frame_from_body);
    if (!record)
        return table.refuse("model", fmt::format("= \"{}\": {}", name, record.error().message));
    core::Setup& setup = context.file.setup;
    setup.stock_mount = {setup.machine.table, placement.machine_from_frame};
    setup.stock = std::move(record->solid);
    setup.earlier_cuts =
        std::make_shared<const std::vector<core::CutterSweep>>(std::move(record->sweeps));
    context.frames.machine_from["stock"] = placement.machine_from_body();
    table.finish();
}

std::nullopt_t refuse_named(TableReader& table, const char* key, const std::string& name,
                            const std::string& why) {
    table.refuse(key, fmt::format("= \"{}\": {}", name, why));
    return std::nullopt;
}

/// Reads the CAD file that a key of a table names. Empty after an error.
std::optional<BodyMesh> read_cad_file(TableReader& table, const char* key, const std::string& name,
                                      const MeshSource& source) {
    const double wanted =
        table.number_or("mesh_deviation", Measure::length, core::default_cad_deviation);
    const std::string solid = table.string("solid").value_or("");
    if (table.has("mesh_unit")) {
        table.refuse("mesh_unit", fmt::format("does not apply to {}, whose unit is known", name));
        return std::nullopt;
    }
    if (!(wanted >= core::least_cad_deviation && wanted <= core::largest_cad_deviation)) {
        table.refuse("mesh_deviation", fmt::format("must lie between {} and {}",
                                                   table.shown(core::least_cad_deviation, 7),
                                                   table.shown(core::largest_cad_deviation)));
        return std::nullopt;
    }
    const auto file = core::read_cad(source.folder / name, wanted);
    if (!file) return refuse_named(table, key, name, file.error().message);
    if (source.cad_names) {
        if (!*source.cad_names) *source.cad_names = std::make_shared<core::CadNames>();
        (*source.cad_names)->by_file[name] = core::names_of(**file);
    }
    auto body = core::body_of(**file, solid);
    if (!body)
        return solid.empty() ? refuse_named(table, key, name, body.error().message)
                             : refuse_named(table, "solid", solid, body.error().message);
    const auto note = [&](std::string text) { // once for all bodies of the file
        auto& known = source.assumptions;
        if (std::find(known.begin(), known.end(), text) == known.end())
            known.push_back(std::move(text));
    };
    for (const std::string& remark : core::remarks_on(**file))
        note(fmt::format("{}: {}", name, remark));
    note(fmt::format("{}{}: {}", solid.empty() ? "" : solid + " of ", name, meshed_text(*body)));
    return BodyMesh{std::move(body->mesh), body->deviation};
}

/// Reads the mesh file that a key of a table names. Empty after an error.
std::optional<core::Mesh> read_plain_mesh(TableReader& table, const char* key,
                                          const std::string& name, const MeshSource& source) {
    constexpr double mm_per_inch = 25.4;
    const bool is_inch = table.word("mesh_unit", {"mm", "inch"}) == "inch";
    for (const char* of_cad : {"solid", "mesh_deviation"})
        if (table.has(of_cad)) {
            table.refuse(of_cad, "applies only to CAD files (STEP, IGES, BREP, FreeCAD)");
            return std::nullopt;
        }
    const auto read = kept_mesh(source.folder / name);
    if (!read) return refuse_named(table, key, name, read.error().message);
    for (const std::string& repair : (*read)->repairs)
        source.assumptions.push_back(fmt::format("{}: {}", name, repair));
    core::Mesh mesh = (*read)->mesh;
    if (is_inch)
        for (core::Vec3& v : mesh.vertices) v *= mm_per_inch;
    return mesh;
}

} // namespace

std::string meshed_text(const core::CadBody& body) {
    std::string text =
        fmt::format("meshed within {} mm of its surface ({})", core::at_most(body.deviation, 4),
                    body.is_proven ? "proven" : "in part measured, and doubled");
    constexpr double small_gap = 1e-3; // mm
    if (body.gap > small_gap)
        text +=
            fmt::format("; gaps between its faces are {} mm of this", core::at_most(body.gap, 4));
    return text;
}

std::optional<BodyMesh> read_mesh_file(TableReader& table, const char* key,
                                       const MeshSource& source) {
    const std::string name = table.string(key).value_or("");
    if (name.empty()) {
        table.refuse(key, "must name a file");
        return std::nullopt;
    }
    std::optional<BodyMesh> read;
    if (core::is_cad_file(name))
        read = read_cad_file(table, key, name, source);
    else if (auto mesh = read_plain_mesh(table, key, name, source))
        read = BodyMesh{*std::move(mesh)};
    if (!read) return std::nullopt;
    const core::Aabb box = read->mesh.bounds();
    for (const core::Vec3& corner : {box.min, box.max})
        for (int axis = 0; axis < 3; ++axis)
            if (std::abs(corner[axis]) > largest_number)
                return refuse_named(table, key, name,
                                    fmt::format("reaches to {} {:g} mm, beyond {:.0f} mm (1 km)",
                                                "XYZ"[axis], corner[axis], largest_number));
    return read;
}

std::optional<DeviatingBody> read_exact_body(TableReader& table, const MeshSource& source,
                                             const core::Transform& target_from_frame) {
    return exact_body(table, source, target_from_frame * read_pose(table));
}

std::string why_no_fixture_name(const std::string& name) {
    const std::string plain = core::lower_case(trimmed(name));
    std::string what;
    if (gcode::offset_of_name(core::upper_case(plain)))
        what = "the name of a work offset, in which bodies are positioned";
    else if (plain == "machine" || plain == "stock" || plain == "part" || core::names_a_kind(name))
        what = "a reserved word, for a frame or a kind of body";
    if (what.empty()) return {};
    return fmt::format("is {}: choose another name, such as \"{}-1\"", what, name);
}

void add_machine_bodies(TableReader& table, core::Setup& setup) {
    for (const core::MachineBody& body : setup.machine.bodies) {
        for (const core::Fixture& other : setup.fixtures)
            if (other.name == body.name)
                table.refuse("fixture", fmt::format("\"{}\" is already the name of a machine body",
                                                    body.name));
        if (body.link == core::LinkId::base || core::is_on_table_side(setup.machine, body.link))
            setup.fixtures.push_back({.name = body.name,
                                      .body = body.body,
                                      .mount = {body.link, body.place},
                                      .is_machine = true,
                                      .deviation = body.deviation});
    }
}

void infer_stock(BodyContext& context) {
    SetupFile& file = context.file;
    file.needs_stock = true;
    // At the first work offset that is stated.
    const bool has_others = !file.offsets_set.empty() && !file.offsets_set.contains(0);
    if (has_others)
        file.stock_frame = gcode::name_of_offset(static_cast<size_t>(*file.offsets_set.begin()));
    const core::Transform frame = context.frames.machine_from.at(file.stock_frame);
    file.setup.stock_mount = {file.setup.machine.table, frame};
    context.frames.machine_from["stock"] = frame;
}

void read_stock(TableReader& table, BodyContext& context) {
    table.limit_numbers();
    refuse_preset(table);
    const Placement placement = read_placement(table, context);
    context.file.stock_frame = table.string("frame").value_or("G54");
    context.file.stock_margin = table.number("margin", Measure::length);
    if (context.file.stock_margin || has_no_shape(table))
        return read_envelope(table, context, placement);
    const auto shape = only_shape(table, false);
    if (!shape) return;
    if (*shape == "model") return read_model(table, context, placement);
    core::Setup& setup = context.file.setup;
    setup.stock_mount = {setup.machine.table, placement.machine_from_frame};
    setup.stock = stock_solid(table, context, *shape, placement.frame_from_body);
    setup.stock.tolerance = table.number_or("tolerance", Measure::length, 0.0);
    if (setup.stock.tolerance < 0.0) table.refuse("tolerance", "must not be negative");
    setup.stock.tolerance += setup.stock.deviation;
    context.frames.machine_from["stock"] = placement.machine_from_body();
    table.finish();
}

void read_part(TableReader& table, BodyContext& context) {
    table.limit_numbers();
    refuse_preset(table);
    core::Setup& setup = context.file.setup;
    const Placement placement = read_placement(table, context);
    const bool box = table.has("box");
    if (box == table.has("mesh")) return table.need("one of mesh, box");
    const core::Transform stock_from_body =
        setup.stock_mount.link_from_body.inverse() * placement.machine_from_body();
    BodyMesh read = read_polyhedron(table, context.meshes(), box ? "box" : "mesh", stock_from_body);
    core::Part part;
    if (const auto tolerance = table.number("tolerance", Measure::length)) {
        if (!(*tolerance > 0.0)) table.refuse("tolerance", "must be above 0");
        part.tolerance = *tolerance;
    } else {
        context.file.assumptions.push_back(fmt::format(
            "the result may deviate from the part by {} mm either way", part.tolerance));
    }
    if (!(part.tolerance > read.deviation))
        table.refuse("tolerance", fmt::format("must be above {}, by which the mesh of the part may "
                                              "deviate from it",
                                              table.shown(read.deviation)));
    part.deviation = read.deviation;
    if (read.deviation > 0.0)
        context.file.assumptions.push_back(
            fmt::format("deviations from the part count from {} mm on, because its mesh may be off "
                        "by {} mm",
                        core::at_least(part.limit(), 4), core::at_most(read.deviation, 4)));
    table.finish();
    if (read.mesh.triangles.empty()) return;
    part.solid = kept_solid(std::move(read.mesh));
    setup.part = std::move(part);
}

/// The moves of the fixture in whose frame a fixture is: it goes along, unless it has a move of its
/// own for each. `own`: the fixture's own moves.
std::vector<FrameMove> moves_of_frame(TableReader& table, const BodyContext& context,
                                      const std::vector<FrameMove>& own) {
    const std::string frame = table.string("frame").value_or("");
    const auto found = context.frames.moves.find(frame);
    if (found == context.frames.moves.end()) return {};
    const auto has_own = [&](const FrameMove& move) {
        return std::any_of(own.begin(), own.end(), [&](const FrameMove& other) {
            return other.when.line == move.when.line && other.when.code == move.when.code;
        });
    };
    if (own.empty()) return found->second;
    if (!std::all_of(found->second.begin(), found->second.end(), has_own))
        table.refuse("frame", fmt::format("\"{}\" moves during the program and takes it along: "
                                          "state a move of its own for each of those, or give it "
                                          "another frame",
                                          frame));
    return {};
}

void read_fixture(TableReader& table, BodyContext& context) {
    table.limit_numbers();
    core::Setup& setup = context.file.setup;
    core::Fixture fixture;
    fixture.name = table.string("name").value_or("");
    if (fixture.name.empty()) return table.need("name");
    if (const std::string why = why_no_fixture_name(fixture.name); !why.empty())
        table.refuse("name", fmt::format("= \"{}\" {}", fixture.name, why));
    for (const core::Fixture& other : setup.fixtures)
        if (other.name == fixture.name)
            table.refuse("name", fmt::format("\"{}\" is defined twice", fixture.name));
    fixture.expendable = table.boolean("expendable").value_or(false);
    const core::Transform machine_from_frame = read_frame(table, context);
    const core::Transform stock_from_frame =
        setup.stock_mount.link_from_body.inverse() * machine_from_frame;
    fixture.mount = setup.stock_mount;
    if (table.has("model")) return table.refuse("model", "applies only to the stock");
    const core::Transform frame_from_body = read_pose(table);
    const auto body = exact_body(table, context.meshes(), stock_from_frame * frame_from_body);
    if (!body) return;
    fixture.body = body->body;
    fixture.deviation = body->deviation;
    context.frames.machine_from[fixture.name] = machine_from_frame * frame_from_body;
    std::vector<TableReader> moves = table.tables("move", "[[fixture.move]]");
    setup.fixtures.push_back(fixture);
    const core::Transform body_from_machine = (machine_from_frame * frame_from_body).inverse();
    const core::Transform stock_from_machine = setup.stock_mount.link_from_body.inverse();
    std::vector<FrameMove>& own = context.frames.moves[fixture.name];
    size_t last = setup.fixtures.size() - 1;
    const auto add_place = [&](const core::Transform& machine_from_body) {
        core::Fixture there = fixture;
        there.is_there = false;
        there.body = moved(fixture.body, stock_from_machine * machine_from_body * body_from_machine
                                             * stock_from_machine.inverse());
        last = setup.fixtures.size();
        setup.fixtures.push_back(std::move(there));
    };
    for (TableReader& move : moves) {
        const auto to = read_move(move, setup, last, context.file.environment.known_m_codes);
        own.push_back(
            {setup.fixture_moves.back(), machine_from_frame * to.value_or(core::Transform{}), !to});
        if (to) add_place(own.back().machine_from_body);
    }
    for (const FrameMove& move : moves_of_frame(table, context, own)) {
        core::FixtureMove along{move.when.line, move.when.code, last, {}};
        if (!move.is_removed) along.to = setup.fixtures.size();
        setup.fixture_moves.push_back(along);
        own.push_back({along, move.machine_from_body * frame_from_body, move.is_removed});
        if (!move.is_removed) add_place(own.back().machine_from_body);
    }
    table.finish();
}

} // namespace app
