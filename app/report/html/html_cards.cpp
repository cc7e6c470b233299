#include <algorithm>

#include <fmt/format.h>

#include "app/base/clearance_text.h"
#include "app/base/text.h"
#include "app/check/check_run.h"
#include "app/report/html/html_report.h"
#include "app/report/html/html_text.h"
#include "app/view/model/finding_group.h"
#include "core/base/rule.h"
#include "core/sim/verdict.h"

namespace app {
namespace {

using viewer::FindingGroup;
using viewer::FindingStretch;

constexpr size_t most_locations = 12; // per card; the table of blocks has all

/// The index of the view of a moment; `views.views.size()` if there is none.
size_t view_of(const ReportViews& views, const ShownMoment& moment) {
    const auto found = std::find_if(views.views.begin(), views.views.end(),
                                    [&](const BlockView& view) { return view.moment == moment; });
    return static_cast<size_t>(found - views.views.begin());
}

/// The attributes of a button that shows a moment.
std::string target_of(const ReportViews& views, const ShownMoment& moment) {
    const size_t view = view_of(views, moment);
    return fmt::format("data-block=\"{}\"", moment.block)
           + (view < views.views.size() ? fmt::format(" data-view=\"{}\"", view) : "");
}

/// "line 23"; in a subprogram's file "O1000.nc, line 23".
std::string line_of(const CheckedBlock& block) {
    const std::string line = fmt::format("line {}", block.line);
    return block.file.empty() ? line : html_text(block.file) + ", " + line;
}

void add_new(std::vector<ShownMoment>& moments, const ShownMoment& moment) {
    if (std::find(moments.begin(), moments.end(), moment) == moments.end())
        moments.push_back(moment);
}

std::string picture_of(const CheckRun& run, const std::string& rule, const ShownMoment& moment,
                       const ReportViews& views) {
    const size_t view = view_of(views, moment);
    if (view == views.views.size() || views.views[view].picture.empty()) return "";
    return fmt::format(
        R"(<button type="button" class="shot" {1} aria-label="Show block {0} in 3D">)"
        R"(<img alt="{2} in block {0}, {3}" src="data:image/jpeg;base64,{4}"></button>)",
        moment.block, target_of(views, moment), html_text(rule), line_of(run.blocks[moment.block]),
        base64(views.views[view].picture));
}

std::string clearance_of(const FindingStretch& stretch) {
    if (stretch.overlap) return " \xC2\xB7 " + core::depth_text(*stretch.overlap) + " mm deep";
    return stretch.clearance ? " \xC2\xB7 " + core::clearance_at_least(*stretch.clearance) + " mm"
                             : std::string();
}

std::string location_button(const CheckRun& run, const FindingStretch& stretch,
                            const std::string& target) {
    const CheckedBlock first = run.blocks[stretch.first], last = run.blocks[stretch.last];
    std::string lines = line_of(first);
    if (last.line != first.line) lines += fmt::format("\xE2\x80\x93{}", last.line);
    return fmt::format(R"(<li><button type="button" {}>{}{}</button></li>)", target, lines,
                       clearance_of(stretch));
}

std::string location_list(const CheckRun& run, const FindingGroup& group,
                          const ReportViews& views) {
    if (group.stretches.size() < 2) return "";
    std::string list = R"(<ul class="places">)";
    for (size_t i = 0; i < std::min(group.stretches.size(), most_locations); ++i)
        list += location_button(run, group.stretches[i],
                                target_of(views, {group.stretches[i].worst, group.pair}));
    if (group.stretches.size() > most_locations)
        list += fmt::format(R"(<li><button type="button" data-rule="{}">and {} more</button></li>)",
                            html_text(group.rule), group.stretches.size() - most_locations);
    return list + "</ul>";
}

std::string heading_of(const FindingGroup& group) {
    const char* severity = core::name_of(group.severity);
    std::string heading =
        fmt::format(R"(<header><span class="badge {0}">{0}</span><h3>{1}</h3><code>{2}</code>)",
                    severity, html_text(core::title_of_rule(group.rule)), html_text(group.rule));
    if (!group.pair[0].empty())
        heading += fmt::format(R"(<span class="pair">{} / {}</span>)", html_text(group.pair[0]),
                               html_text(group.pair[1]));
    return heading + "</header>";
}

std::string said(const std::string& message, const std::string& cure) {
    std::string text = "<p>" + html_text(message) + "</p>";
    if (!cure.empty()) text += R"(<p class="cure"><b>Cure:</b> )" + html_text(cure) + "</p>";
    return text;
}

std::string card_of(const CheckRun& run, const FindingGroup& group, const ReportViews& views) {
    std::string card = fmt::format(R"(<article class="card {}">)", core::name_of(group.severity))
                       + heading_of(group);
    if (group.stretches.empty()) return card + said(group.message, group.cure) + "</article>\n";
    const FindingStretch& worst = group.stretches[group.worst];
    const CheckedBlock block = run.blocks[worst.worst];
    const ShownMoment moment{worst.worst, group.pair};
    card += picture_of(run, group.rule, moment, views) + said(worst.message, worst.cure);
    card += fmt::format(R"(<p class="where"><button type="button" {}>Block {}, {}{}</button> )"
                        R"(<code>{}</code>{}</p>)",
                        target_of(views, moment), worst.worst, line_of(block), clearance_of(worst),
                        html_text(trimmed(block.text)),
                        group.count > 1 ? fmt::format(" The worst of {} blocks.", group.count)
                                        : std::string());
    return card + location_list(run, group, views) + "</article>\n";
}

/// Card of the tightest block, for a program without findings.
std::string tightest_card(const CheckRun& run, const ReportViews& views) {
    const auto nearest = tightest_block(run);
    if (!nearest) return "";
    const ShownMoment moment{core::value_of(nearest->block), {}};
    const core::PairClearance& pair = nearest->result.pairs[*nearest->result.deciding];
    return fmt::format(
               R"(<article class="card"><header><span class="badge">tightest</span><h3>{}</h3>)"
               R"(<span class="pair">{} / {}</span></header>)",
               line_of(*nearest), html_text(core::part_name(run.setup, pair.pair)),
               html_text(core::body_name(run.setup, pair.pair)))
           + picture_of(run, "tightest", moment, views)
           + fmt::format(R"(<p class="where"><button type="button" {3}>Block {0} )"
                         "\xC2\xB7 {1}</button> <code>{2}</code></p></article>\n",
                         moment.block, tightest_words(nearest->result, ClearanceStyle::sentence),
                         html_text(trimmed(nearest->text)), target_of(views, moment));
}

} // namespace

std::vector<FindingGroup> finding_groups(const CheckRun& run) {
    std::vector<viewer::BlockRow> rows;
    rows.reserve(run.blocks.size());
    for (const CheckedBlock& block : run.blocks) rows.push_back(viewer::row_of(run.setup, block));
    return viewer::grouped(rows, run.findings);
}

std::vector<ShownMoment> moments_of_cards(const CheckRun& run) {
    std::vector<ShownMoment> moments;
    for (const FindingGroup& group : finding_groups(run))
        if (!group.stretches.empty())
            add_new(moments, {group.stretches[group.worst].worst, group.pair});
    const auto nearest = tightest_block(run);
    if (moments.empty() && nearest) moments.push_back({core::value_of(nearest->block), {}});
    return moments;
}

std::vector<ShownMoment> moments_to_show(const CheckRun& run, size_t most) {
    std::vector<ShownMoment> moments = moments_of_cards(run);
    for (const FindingGroup& group : finding_groups(run))
        for (size_t i = 0; i < std::min(group.stretches.size(), most_locations); ++i)
            add_new(moments, {group.stretches[i].worst, group.pair});
    if (moments.size() > most) moments.resize(most);
    return moments;
}

std::string html_cards(const CheckRun& run, const ReportViews& views) {
    std::string cards;
    const auto groups = finding_groups(run);
    for (const FindingGroup& group : groups) cards += card_of(run, group, views);
    if (groups.empty()) cards = R"(<p class="none">No findings.</p>)";
    const bool has_block = std::any_of(groups.begin(), groups.end(),
                                       [](const auto& group) { return !group.stretches.empty(); });
    return has_block ? cards : cards + tightest_card(run, views);
}

} // namespace app
