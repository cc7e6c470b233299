#include "app/commands/job_file.h"

#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/check/check_job.h"
#include "app/check/prepared_check.h"
#include "app/commands/setup_control.h"
#include "app/report/text/offset_report.h"
#include "app/report/text/text_report.h"
#include "app/setup/control/offset_differences.h"
#include "app/setup/coverage.h"
#include "app/setup/inference/imported_setup.h"
#include "app/setup/setup_file.h"
#include "app/setup/setup_text.h"
#include "app/setup/stated_setup.h"
#include "app/setup/toml_file.h"
#include "app/view/model/file_watch.h"

namespace app {
namespace {

std::string name_of_file(const std::string& path) {
    return std::filesystem::path(path).filename().generic_string();
}

/// Adds to a text what it lacks of an imported set-up: the tools that the program uses, the stock.
core::Result<std::string> with_import(std::string text, const SetupFile& import,
                                      const std::string& folder, std::vector<std::string>& added) {
    const StatedSetup stated = stated_in(text);
    if (!text.ends_with('\n')) text += '\n';
    for (const auto& [number, found] : import.library) {
        if (stated.has_tool(number) || !import.tools_used.contains(number)) continue;
        text += tool_text(import, number);
        added.push_back(fmt::format("tool {}", core::value_of(number)));
    }
    const bool has_stock = import.stock_known == Known::described;
    if (const std::string table = has_stock ? stock_text(import, folder) : "";
        !stated.stock && !table.empty()) {
        text += table;
        added.emplace_back("the stock");
    }
    if (const std::string table = part_text(import, folder); !stated.part && !table.empty()) {
        text += table;
        added.emplace_back("the part");
    }
    FEELER_TRY(const toml::table read, parsed_toml(text));
    static_cast<void>(read);
    return text;
}

core::Result<viewer::JobFileNews> import_job(const CheckJob& job, const std::string& path) {
    FEELER_TRY(const PreparedCheck check, read_check(job));
    FEELER_TRY(SetupFile import, infer_setup_with(*check.program, job.settings, path));
    viewer::JobFileNews news;
    news.title = "Import " + name_of_file(path);
    const std::string before = job.setup_text.value_or("");
    const std::string folder =
        std::filesystem::path(setup_path(job)).parent_path().generic_string();
    std::vector<std::string> added;
    if (before.empty()) {
        news.setup_text = setup_text(import, {job.program, job.settings, folder});
        added.emplace_back("a set-up with what the program and the job state");
    } else {
        import.length_unit = stated_in(before).length_unit;
        FEELER_TRY(news.setup_text, with_import(before, import, folder, added));
    }
    news.text = added.empty() ? "The set-up states all of it already.\n"
                              : fmt::format("Added: {}.\n", fmt::join(added, ", "));
    // The first note says what a set-up made of the job alone has from it.
    const size_t first = before.empty() || import.import_notes.empty() ? 0 : 1;
    for (size_t i = first; i < import.import_notes.size(); ++i)
        news.text += import.import_notes[i] + ".\n";
    return news;
}

core::Result<viewer::JobFileNews> compare_file(const CheckJob& job, const std::string& path) {
    FEELER_TRY(const OffsetComparison comparison, comparison_of(job, {path}));
    viewer::JobFileNews news;
    news.title = "Offsets in " + name_of_file(path);
    news.text = offset_text(comparison, {setup_path(job), {path}});
    if (!job.setup_text) return news; // nothing states values that could be replaced
    FEELER_TRY(std::string taken, with_work_offsets(*job.setup_text, comparison));
    if (taken == *job.setup_text) return news;
    news.proposed = std::move(taken);
    news.question = "Take the work offsets";
    news.text +=
        "\n\"Take the work offsets\" states the control's positions of the axes. Rotations of "
        "work offsets, G92,\ntool lengths and diameters stay as they are in the set-up.\n";
    return news;
}

} // namespace

viewer::JobFileNews read_job_file(const CheckJob& job, const std::string& path) {
    auto news = viewer::is_cam_job(path) ? import_job(job, path) : compare_file(job, path);
    if (news) return *std::move(news);
    return {"This file cannot be used", error_text(core::in_file(news.error(), path)), {}};
}

} // namespace app
