#include "app/report/html_report.h"

#include <filesystem>

#include <fmt/format.h>

#include "app/report/html_assets.h"
#include "app/report/html_blocks.h"
#include "app/report/html_cards.h"
#include "app/report/html_facts.h"
#include "app/report/html_page.h"
#include "app/report/html_palette.h"
#include "app/report/html_text.h"
#include "app/report/text_report.h"
#include "app/version.h"

namespace app {
namespace {

/// The class by which the page colours the outcome.
const char* verdict_of(const CheckRun& run) {
    const bool is_worse = run.stopped || run.has_errors();
    return run.verdict == core::Verdict::clear && is_worse ? "error" : core::name_of(run.verdict);
}

std::string name_of_file(const std::string& path) {
    const std::string name = std::filesystem::path(path).filename().string();
    return name.empty() ? path : name;
}

std::string list_of(const std::vector<std::string>& lines) {
    std::string list;
    for (const std::string& line : lines) list += "<li>" + html_text(line) + "</li>\n";
    return list;
}

std::string notice_of(const ReportViews& views) {
    std::string notice;
    const auto say = [&](const std::string& text) {
        notice += "<p class=\"notice\">" + html_text(text) + "</p>\n";
    };
    if (!views.no_pictures.empty()) say("There are no pictures: " + views.no_pictures);
    if (view_bundle().empty())
        say("This Feeler was built without its 3D view (npm was not there): the report has "
            "pictures only.");
    return notice;
}

std::string views_json(const ReportViews& views) {
    std::string list;
    for (const BlockView& view : views.views)
        list += fmt::format(R"({}{{"block":{},"scene":{}}})", list.empty() ? "" : ",", view.block,
                            view.scene.empty() ? "null" : view.scene);
    return fmt::format(R"({{"meshes":{},"views":[{}]}})",
                       views.meshes.empty() ? "[]" : views.meshes, list);
}

} // namespace

std::string html_report(const CheckRun& run, const ReportViews& views) {
    const PageAssets assets = page_assets();
    return filled_page(assets.page, {{"version", version},
                                     {"verdict", verdict_of(run)},
                                     {"outcome", html_text(outcome_text(run))},
                                     {"program", html_text(run.program_file)},
                                     {"name", html_text(name_of_file(run.program_file))},
                                     {"palette", html_palette()},
                                     {"style", std::string(assets.style)},
                                     {"summary", html_summary(run)},
                                     {"notice", notice_of(views)},
                                     {"cards", html_cards(run, views)},
                                     {"terms", html_bound_terms(run)},
                                     {"assumptions", list_of(run.assumptions)},
                                     {"blocks", blocks_json(run)},
                                     {"views", views_json(views)},
                                     {"bundle", std::string(view_bundle())},
                                     {"script", std::string(assets.script)}});
}

} // namespace app
