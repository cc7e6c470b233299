#include "app/setup/tool_holder.h"

#include <fmt/format.h>

#include "app/setup/holder_library.h"
#include "app/setup/outline.h"
#include "core/geom/mesh_file.h"
#include "core/geom/revolved_hull.h"

namespace app {
namespace {

constexpr double mesh_tolerance = 0.005; // mm, by which cones may be wider than a mesh
constexpr double same_level = 0.01;      // mm; meshes come in single precision

void read_named(TableReader& table, BodyContext& context, core::ToolDescription& tool) {
    const std::string name = table.string("holder").value_or("");
    HolderLibrary library;
    std::string where = "among those that come with the program";
    if (const auto file = table.string("holder_file")) {
        auto read = read_holder_library((context.folder / *file).string());
        if (!read) return table.refuse_with(read.error());
        library = *std::move(read);
        where = "in " + *file;
    } else {
        library = shipped_holder_library();
    }
    const auto found = library.find(name);
    if (found == library.end())
        return table.refuse(
            "holder", fmt::format("\"{}\" is not {}: {}", name, where, names_like(library, name)));
    tool.holder = found->second;
}

void read_mesh_holder(TableReader& table, BodyContext& context, core::ToolDescription& tool) {
    const std::string name = table.string("holder_mesh").value_or("");
    auto read = core::read_mesh(context.folder / name);
    if (!read)
        return table.refuse("holder_mesh", fmt::format("= \"{}\": {}", name, read.error().message));
    for (const std::string& repair : read->repairs)
        context.file.assumptions.push_back(fmt::format("{}: {}", name, repair));
    const double lowest = read->mesh.bounds().min.z;
    if (std::abs(lowest) > same_level)
        return table.refuse("holder_mesh",
                            fmt::format("= \"{}\": the origin must lie in its lower face, but it "
                                        "begins at Z {:g}",
                                        name, lowest));
    tool.holder = cones_of_profile(core::revolved_hull(read->mesh, mesh_tolerance));
    context.file.assumptions.push_back(
        fmt::format("tool {}: its holder is the smallest body of revolution that holds {}",
                    core::value_of(tool.number), name));
}

} // namespace

std::vector<core::ConeStep> read_steps(TableReader& table, const char* key) {
    std::vector<core::ConeStep> steps;
    if (table.row_length(key) == 2) {
        auto cones = cones_of_outline(table.rows(key, 2));
        if (!cones) table.refuse(key, cones.error().message);
        return cones ? *std::move(cones) : steps;
    }
    for (const std::vector<double>& row : table.rows(key, 3))
        steps.push_back({row[0], row[1], row[2]});
    return steps;
}

void read_holder(TableReader& table, BodyContext& context, core::ToolDescription& tool) {
    if (table.has("holder") && table.has("holder_mesh"))
        return table.refuse("holder_mesh", "and holder exclude each other");
    if (table.is_text("holder")) return read_named(table, context, tool);
    if (table.has("holder_file"))
        return table.refuse("holder_file", "needs holder = \"NAME\", which of its holders it is");
    if (table.has("holder_mesh")) return read_mesh_holder(table, context, tool);
    for (const char* absent : {"holder_file", "holder_mesh"}) table.string(absent);
    tool.holder = read_steps(table, "holder");
}

} // namespace app
