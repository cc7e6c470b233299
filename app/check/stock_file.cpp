#include "app/check/stock_file.h"

#include <cassert>
#include <filesystem>

#include <fmt/format.h>

#include "core/base/text.h"
#include "core/dbm/cut_model.h"
#include "core/dbm/stock_mesh.h"
#include "core/dbm/stock_record.h"
#include "core/geom/mesh.h"
#include "core/sim/verdict.h"

namespace app {
namespace {

/// Rounding to single precision moves a vertex by up to half a unit in the last place.
double rounding_of(const core::Mesh& mesh) {
    const core::Aabb box = mesh.bounds();
    const core::Vec3 farthest = glm::max(glm::abs(box.min), glm::abs(box.max));
    return glm::length(farthest) * 0x1p-24;
}

} // namespace

core::Result<MeshForm> mesh_form(const std::string& path) {
    const std::string ending =
        core::lower_case(std::filesystem::path(path).extension().generic_string());
    if (ending == ".stl") return MeshForm::stl;
    if (ending == ".ply") return MeshForm::ply;
    if (ending == ".feeler") return MeshForm::record;
    return core::fail_file(path, "cannot be written: the name must end in .stl, .ply or .feeler");
}

std::string facts_of(const SavedStock& saved) {
    if (saved.moves > 0 || saved.triangles == 0)
        return fmt::format("{}: the raw stock and {} moves, for [stock] model in a set-up",
                           saved.file, saved.moves);
    std::string text = fmt::format(
        "{}: {} triangles, within {} mm of the model's points, scan lines {} mm apart", saved.file,
        saved.triangles, core::at_most_figures(saved.error, 2), saved.mesh_size);
    if (saved.lost > 0)
        text += fmt::format("; {} points on thinner details are missing", saved.lost);
    return text;
}

core::Result<StockFile> stock_file(const core::StockMesh& surface, double mesh_size,
                                   const std::string& path) {
    FEELER_TRY(const MeshForm form, mesh_form(path));
    assert(form != MeshForm::record);
    if (surface.mesh.triangles.empty())
        return core::fail_file(path, "was not written: no stock is left");
    StockFile file;
    file.facts = {path, surface.mesh.triangles.size(), surface.error, mesh_size, surface.lost};
    if (form == MeshForm::stl) file.facts.error += rounding_of(surface.mesh);
    if (form == MeshForm::stl) {
        file.bytes = core::stl_bytes(
            surface.mesh,
            fmt::format("feeler stock, mm; error {} at points, lines {:.4g} apart",
                        core::at_most_figures(file.facts.error, 2), file.facts.mesh_size));
        return file;
    }
    std::vector<std::string> comments = {
        "remaining stock, by feeler; mm, frame of the stock",
        fmt::format("error: the points of the model lie within {} mm of this surface",
                    core::at_most_figures(file.facts.error, 3)),
        fmt::format("between scan lines {} mm apart the surface is interpolated",
                    file.facts.mesh_size)};
    if (surface.lost > 0)
        comments.push_back(
            fmt::format("{} points on details thinner than that are missing", surface.lost));
    file.bytes = core::ply_bytes(surface.mesh, comments);
    return file;
}

StockFile stock_record_file(const core::CutModel& stock, double path_error,
                            const std::string& path) {
    const core::StockRecord record = core::record_of(stock, path_error);
    StockFile file;
    file.facts = {.file = path, .mesh_size = record.spacing, .moves = record.sweeps.size()};
    file.bytes = core::bytes_of(record);
    return file;
}

} // namespace app
