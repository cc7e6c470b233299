#include "app/report/html/html_report.h"

#include <filesystem>
#include <map>

#include <fmt/format.h>

#include "app/base/text.h"
#include "app/base/version.h"
#include "app/check/check_run.h"
#include "app/report/html/html_facts.h"
#include "app/report/html/html_page.h"
#include "app/report/html/html_text.h"
#include "app/report/json/json_report.h"
#include "app/report/text/text_report.h"

namespace app {
namespace {

std::string name_of_file(const std::string& path) {
    const std::string name = std::filesystem::path(path).filename().generic_string();
    return name.empty() ? path : name;
}

std::string html_names() {
    return script_names("motions", core::all_block_motions)
           + script_names("verdicts", core::all_verdicts)
           + script_names("severities", core::all_severities);
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
        say("This Feeler was built without the 3D view (npm was missing): the report has "
            "pictures only.");
    return notice;
}

std::string views_json(const ReportViews& views) {
    std::string list;
    for (const BlockView& view : views.views)
        list += fmt::format(R"({}{{"block":{},"pair":[{},{}],"scene":{}}})",
                            list.empty() ? "" : ",", view.moment.block,
                            script_string(view.moment.pair[0]), script_string(view.moment.pair[1]),
                            view.scene.empty() ? "null" : view.scene);
    return fmt::format(R"({{"meshes":{},"views":[{}]}})",
                       views.meshes.empty() ? "[]" : views.meshes, list);
}

} // namespace

std::string html_report(const CheckRun& run, const ReportViews& views) {
    const PageAssets assets = page_assets();
    return filled_page(assets.page, {{"version", version},
                                     {"verdict", verdict_class(run)},
                                     {"outcome", html_text(run.headline())},
                                     {"program", html_text(run.program_file)},
                                     {"name", html_text(name_of_file(run.program_file))},
                                     {"palette", html_palette()},
                                     {"style", std::string(assets.style)},
                                     {"uncovered", uncovered_html(run)},
                                     {"summary", html_summary(run)},
                                     {"notice", notice_of(views)},
                                     {"cards", html_cards(run, views)},
                                     {"terms", html_bound_terms(run)},
                                     {"tolerances", html_tolerances(run)},
                                     {"assumptions", list_of(run.all_assumptions())},
                                     {"blocks", blocks_json(run)},
                                     {"views", views_json(views)},
                                     {"bundle", std::string(view_bundle())},
                                     {"script", html_names() + std::string(assets.script)}});
}

namespace {

/// The pairs that decide blocks, with their minimum clearances.
class PairTable {
public:
    explicit PairTable(const core::Setup& setup) : setup_(setup) {}

    int64_t index_of(const core::PairClearance& pair) {
        const std::string entry = fmt::format(
            "[{},{},{}]", script_string(core::part_name(setup_, pair.pair)),
            script_string(core::body_name(setup_, pair.pair)), um_above(pair.allowance.distance));
        const auto [at, is_new] = known_.try_emplace(entry, static_cast<int64_t>(known_.size()));
        if (is_new) (json_ += json_.empty() ? "" : ",") += entry;
        return at->second;
    }
    std::string json() const { return "[" + json_ + "]"; }

private:
    const core::Setup& setup_;
    std::map<std::string, int64_t> known_;
    std::string json_;
};

struct Columns {
    DeltaRuns line, text;
    NumberRuns file, motion, tool, pair, verdict;
    std::vector<int64_t> time, removed, lower, width;
};

void add_clearance(const CheckRun& run, const core::BlockResult& result, PairTable& pairs,
                   Columns& columns) {
    int64_t lower = -1, width = -1, pair = -1;
    if (result.motion != core::BlockMotion::none && result.checked) {
        if (result.deciding) {
            const core::PairClearance& near = result.pairs[*result.deciding];
            lower = clearance_um(near.lower);
            if (near.found()) width = std::max<int64_t>(um_above(near.upper) - lower, 0);
            pair = pairs.index_of(near);
        } else {
            lower = clearance_um(least_clearance(run.setup, result));
        }
    }
    columns.lower.push_back(lower);
    columns.width.push_back(width);
    columns.pair.add(pair);
}

/// Blocks with findings: "[[block,severity,rule,...],...]", and the names of the rules.
std::string rules_json(const CheckRun& run) {
    std::map<core::BlockIndex, core::Severity> worst;
    for (const core::Finding& finding : run.findings) {
        if (!finding.block) continue;
        core::Severity& severity = worst[*finding.block];
        severity = std::max(severity, finding.severity);
    }
    TextTable names;
    std::string blocks;
    for (const auto& [block, rules] : rules_of_blocks(run)) {
        const auto found = worst.find(block);
        blocks += fmt::format("{}[{},{}", blocks.empty() ? "" : ",", core::value_of(block),
                              found == worst.end() ? 0 : static_cast<int>(found->second));
        for (const std::string& rule : rules) blocks += fmt::format(",{}", names.index_of(rule));
        blocks += ']';
    }
    return fmt::format(R"("rules":{},"found":[{}])", names.json(), blocks);
}

} // namespace

std::string blocks_json(const CheckRun& run) {
    Columns columns;
    TextTable texts, files;
    PairTable pairs(run.setup);
    int64_t last_time = 0, last_removed = 0;
    double removed = 0.0; // running total: rounding this keeps small amounts
    for (const CheckedBlock& block : run.blocks) {
        const core::BlockResult& result = block.result;
        columns.line.add(block.line);
        columns.text.add(texts.index_of(trimmed(block.text)));
        columns.file.add(files.index_of(block.file));
        columns.motion.add(static_cast<int64_t>(result.motion));
        columns.tool.add(result.tool ? int64_t(core::value_of(*result.tool)) : -1);
        columns.verdict.add(static_cast<int64_t>(result.verdict));
        const int64_t time = steps_of(result.time, 1e-4);
        columns.time.push_back(time - last_time);
        last_time = time;
        removed += result.removed;
        const int64_t removed_steps = steps_of(removed, 0.01);
        columns.removed.push_back(removed_steps - last_removed);
        last_removed = removed_steps;
        add_clearance(run, result, pairs, columns);
    }
    std::string json =
        fmt::format(R"({{"count":{},"end":{},"limit":{},)", run.blocks.size(),
                    steps_of(run.cycle_time, 1e-4), um_below(run.setup.search_limit));
    json += R"("line":)" + columns.line.json() + R"(,"text":)" + columns.text.json()
            + R"(,"texts":)" + texts.json() + R"(,"file":)" + columns.file.json() + R"(,"files":)"
            + files.json() + R"(,"motion":)" + columns.motion.json() + R"(,"tool":)"
            + columns.tool.json() + R"(,"verdict":)" + columns.verdict.json() + R"(,"pair":)"
            + columns.pair.json() + R"(,"pairs":)" + pairs.json();
    json += R"(,"time":)" + number_array(columns.time) + R"(,"removed":)"
            + number_array(columns.removed) + R"(,"lower":)" + number_array(columns.lower)
            + R"(,"width":)" + number_array(columns.width);
    return json + "," + rules_json(run) + "}";
}

} // namespace app
