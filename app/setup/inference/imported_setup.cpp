#include "app/setup/inference/imported_setup.h"

#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/setup/freecad_job.h"
#include "app/setup/inference/inferred_setup.h"
#include "app/setup/program_settings.h"
#include "app/setup/setup_file.h"
#include "app/setup/tools/program_tools.h"
#include "app/setup/tools/tool_library.h"
#include "core/base/text.h"
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

void take_job(FreeCadJob job, const std::string& path, SetupFile& file) {
    file.import_notes.push_back(fmt::format("tools{} are those of the job \"{}\" in {}",
                                            job.stock ? " and stock" : "", job.name, path));
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
