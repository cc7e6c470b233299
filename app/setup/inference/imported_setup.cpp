#include "app/setup/inference/imported_setup.h"

#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/setup/freecad_job.h"
#include "app/setup/inference/inferred_setup.h"
#include "app/setup/kept_meshes.h"
#include "app/setup/program_settings.h"
#include "app/setup/setup_file.h"
#include "app/setup/tools/program_tools.h"
#include "app/setup/tools/tool_library.h"
#include "core/base/text.h"
#include "core/cad/cad_file.h"
#include "gcode/language/dialect.h"
#include "gcode/text/source.h"

namespace app {
namespace {

bool is_freecad_document(const std::string& path) {
    return core::lower_case(std::filesystem::path(path).extension().generic_string()) == ".fcstd";
}

/// "post processor linuxcnc, work offsets G54, G55"; empty if the job states neither.
std::string facts_of(const FreeCadJob& job) {
    std::string text;
    if (!job.post_processor.empty()) text = "post processor " + job.post_processor;
    if (!job.work_offsets.empty())
        text += fmt::format("{}work offsets {}", text.empty() ? "" : ", ",
                            fmt::join(job.work_offsets, ", "));
    return text;
}

/// A body of a document; empty if it cannot be read, which a note then says.
std::optional<core::CadBody> body_in(const std::string& path, const std::string& name,
                                     std::string_view what, std::vector<std::string>& notes) {
    auto body =
        core::read_cad(path).and_then([&](const auto& file) { return core::body_of(*file, name); });
    if (body) return *std::move(body);
    notes.push_back(fmt::format("its {}, \"{}\", cannot be read, so state it yourself: {}", what,
                                name, body.error().message));
    return std::nullopt;
}

/// The stock of a job that does not state it in numbers.
void take_stock_body(const std::string& path, FreeCadJob& job, ImportedBodies& bodies) {
    auto body = body_in(path, job.stock_body, "stock", job.notes);
    if (!body) return;
    if (job.stock_is_its_box) {
        job.stock = core::Solid{core::SolidBox{body->mesh.bounds().grown(body->deviation)}};
        return;
    }
    job.stock = core::Solid{.shape = kept_solid(std::move(body->mesh)),
                            .tolerance = body->deviation,
                            .deviation = body->deviation};
    bodies.stock = job.stock_body;
}

/// "tools, stock and part".
std::string taken_text(const FreeCadJob& job, const ImportedBodies& bodies) {
    const bool has_part = !bodies.part.empty();
    if (!job.stock) return has_part ? "tools and part" : "tools";
    return has_part ? "tools, stock and part" : "tools and stock";
}

void take_job(FreeCadJob job, const std::string& path, SetupFile& file) {
    ImportedBodies& bodies = file.imported_bodies;
    bodies.document = path;
    if (!job.stock_body.empty()) take_stock_body(path, job, bodies);
    if (!job.part_body.empty() && body_in(path, job.part_body, "part", job.notes))
        bodies.part = job.part_body;
    file.import_notes.push_back(fmt::format("{} are those of the job \"{}\" in {}",
                                            taken_text(job, bodies), job.name, path));
    if (const std::string facts = facts_of(job); !facts.empty())
        file.import_notes.push_back("the job states " + facts);
    for (const std::string& note : job.notes)
        file.import_notes.push_back(fmt::format("{}: {}", path, note));
    file.library = std::move(job.tools);
    if (!job.stock) return;
    file.setup.stock = *std::move(job.stock);
    file.needs_stock = false;
}

core::Result<void> take_import(const gcode::Program& program, const std::string& path,
                               SetupFile& file) {
    if (is_freecad_document(path)) {
        FEELER_TRY(FreeCadJob job, read_freecad_job(path));
        take_job(std::move(job), path, file);
        return {};
    }
    const auto unit = unit_of_program(program, unit_at_start(file.environment));
    FEELER_TRY(file.library, read_tool_library(path, unit));
    file.import_notes.push_back("tools are those of " + path);
    return {};
}

} // namespace

core::Result<SetupFile> infer_setup_with(const gcode::Program& program,
                                         const ProgramSettings& settings, const std::string& path) {
    FEELER_TRY(SetupFile file, bare_setup(settings));
    if (!file.dialect) {
        FEELER_TRY(file.dialect, gcode::supported(gcode::recognise(program)));
    }
    FEELER_TRY(file.environment.dialect, gcode::supported(*file.dialect));
    if (auto taken = take_import(program, path, file); !taken)
        return tl::unexpected(core::in_file(std::move(taken).error(), path));
    file.assumptions.insert(file.assumptions.end(), file.import_notes.begin(),
                            file.import_notes.end());
    if (auto whole = complete_setup(file, program); !whole) return tl::unexpected(whole.error());
    return file;
}

} // namespace app
