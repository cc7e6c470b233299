#include "app/commands/report_formats.h"

#include <algorithm>
#include <cassert>
#include <filesystem>

#include "app/library/result/batch_result.h"
#include "app/report/exchange/exchange_reports.h"
#include "app/report/html/html_batch.h"
#include "app/report/html/html_report.h"
#include "app/report/json/json_report.h"
#include "app/report/text/batch_text.h"
#include "app/report/text/text_report.h"

namespace app {
namespace {

BatchResult batch_of(const ProgramReport& report) {
    BatchResult batch;
    batch.programs.push_back(result_of(report.run, report.setup));
    return batch;
}

std::string sarif_of(const BatchResult& batch) {
    std::error_code ignored;
    return sarif_report(batch, std::filesystem::current_path(ignored).generic_string());
}

constexpr ReportFormat formats[] = {
    {"text", "",
     [](const ProgramReport& report, const TextSink& out) {
         out(text_report(report.run, {.blocks = report.blocks || report.pairs,
                                      .shown_assumptions = report.shown_assumptions,
                                      .width = report.width,
                                      .colour = report.colour}));
     },
     [](const BatchResult& batch, const BatchStyle& style) {
         return batch_text(batch, {.quiet = style.quiet, .verbose = style.verbose});
     }},
    {"json", "",
     [](const ProgramReport& report, const TextSink& out) {
         json_report(report.run, report.pairs, out);
     },
     [](const BatchResult& batch, const BatchStyle&) { return batch_json_report(batch); }},
    {"jsonl", "one object per line",
     [](const ProgramReport& report, const TextSink& out) {
         json_lines_report(report.run, report.pairs, out);
     },
     [](const BatchResult& batch, const BatchStyle&) { return batch_lines_report(batch); }},
    {"csv", "one row per block, or for many programs one per program",
     [](const ProgramReport& report, const TextSink& out) { csv_report(report.run, out); },
     [](const BatchResult& batch, const BatchStyle&) { return batch_csv_report(batch); },
     UnfinishedReport::never},
    {"html", "a page, for one program with pictures and a 3D view",
     [](const ProgramReport& report, const TextSink& out) {
         out(html_report(report.run, report.views));
     },
     [](const BatchResult& batch, const BatchStyle&) { return batch_html_report(batch); }},
    {"sarif", "",
     [](const ProgramReport& report, const TextSink& out) { out(sarif_of(batch_of(report))); },
     [](const BatchResult& batch, const BatchStyle&) { return sarif_of(batch); },
     UnfinishedReport::always},
    {"junit", "",
     [](const ProgramReport& report, const TextSink& out) { out(junit_report(batch_of(report))); },
     [](const BatchResult& batch, const BatchStyle&) { return junit_report(batch); },
     UnfinishedReport::always},
    {"shard", "for feeler merge", nullptr, nullptr},
};

} // namespace

const ReportFormat& report_format(const std::string& name) {
    const auto* const found =
        std::find_if(std::begin(formats), std::end(formats),
                     [&](const ReportFormat& format) { return format.name == name; });
    assert(found != std::end(formats));
    return *found;
}

std::vector<std::string> format_names(bool with_shard) {
    std::vector<std::string> names;
    for (const ReportFormat& format : formats)
        if (with_shard || format.of_batch) names.emplace_back(format.name);
    return names;
}

std::string format_help(bool with_shard) {
    const std::vector<std::string> names = format_names(with_shard);
    std::string text;
    for (const std::string& name : names) {
        if (!text.empty()) text += name == names.back() ? " or " : ", ";
        const std::string help = report_format(name).help;
        text += name + (help.empty() ? help : " (" + help + ")");
    }
    return text;
}

} // namespace app
