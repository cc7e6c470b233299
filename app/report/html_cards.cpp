#include "app/report/html_cards.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/report/html_text.h"
#include "app/report/text_layout.h"

namespace app {
namespace {

using viewer::FindingGroup;
using viewer::FindingStretch;

constexpr size_t most_places = 12; // of a card; the table has them all

const BlockView* view_of(const ReportViews& views, size_t block) {
    for (const BlockView& view : views.views)
        if (view.block == block) return &view;
    return nullptr;
}

/// "line 23", or "O1000.nc, line 23" in a subprogram's file.
std::string line_of(const CheckedBlock& block) {
    const std::string line = fmt::format("line {}", block.line);
    return block.file.empty() ? line : html_text(block.file) + ", " + line;
}

std::string picture_of(const CheckRun& run, const FindingGroup& group, size_t block,
                       const ReportViews& views) {
    const BlockView* view = view_of(views, block);
    if (!view || view->picture.empty()) return "";
    return fmt::format(
        R"(<button type="button" class="shot" data-block="{0}" aria-label="Show block {0} in 3D">)"
        R"(<img alt="{1} in block {0}, {2}" src="data:image/jpeg;base64,{3}"></button>)",
        block, html_text(group.rule), line_of(run.blocks[block]), base64(view->picture));
}

std::string clearance_of(const FindingStretch& stretch) {
    return stretch.clearance ? fmt::format(" \xC2\xB7 {:.3f} mm", *stretch.clearance)
                             : std::string();
}

std::string place_button(const CheckRun& run, const FindingStretch& stretch) {
    const CheckedBlock &first = run.blocks[stretch.first], &last = run.blocks[stretch.last];
    std::string lines = line_of(first);
    if (last.line != first.line) lines += fmt::format("\xE2\x80\x93{}", last.line);
    return fmt::format(R"(<li><button type="button" data-block="{}">{}{}</button></li>)",
                       stretch.worst, lines, clearance_of(stretch));
}

std::string places_of(const CheckRun& run, const FindingGroup& group) {
    if (group.stretches.size() < 2) return "";
    std::string list = R"(<ul class="places">)";
    for (size_t i = 0; i < std::min(group.stretches.size(), most_places); ++i)
        list += place_button(run, group.stretches[i]);
    if (group.stretches.size() > most_places)
        list += fmt::format(R"(<li><button type="button" data-rule="{}">and {} more</button></li>)",
                            html_text(group.rule), group.stretches.size() - most_places);
    return list + "</ul>";
}

std::string heading_of(const FindingGroup& group) {
    const char* severity = core::name_of(group.severity);
    std::string heading = fmt::format(R"(<header><span class="badge {0}">{0}</span><h3>{1}</h3>)",
                                      severity, html_text(group.rule));
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
    const CheckedBlock& block = run.blocks[worst.worst];
    card += picture_of(run, group, worst.worst, views) + said(worst.message, worst.cure);
    card += fmt::format(
        R"(<p class="where"><button type="button" data-block="{}">Block {}, {}{}</button> )"
        R"(<code>{}</code>{}</p>)",
        worst.worst, worst.worst, line_of(block), clearance_of(worst),
        html_text(trimmed(block.text)),
        group.count > 1 ? fmt::format(" The worst of {} blocks.", group.count) : std::string());
    return card + places_of(run, group) + "</article>\n";
}

} // namespace

std::vector<FindingGroup> finding_groups(const CheckRun& run) {
    std::vector<viewer::BlockRow> rows;
    rows.reserve(run.blocks.size());
    for (const CheckedBlock& block : run.blocks) rows.push_back(viewer::row_of(run.setup, block));
    return viewer::grouped(rows, run.findings);
}

std::vector<size_t> blocks_to_show(const std::vector<FindingGroup>& groups, size_t most) {
    std::vector<size_t> blocks;
    const auto add = [&](size_t block) {
        if (blocks.size() < most && std::find(blocks.begin(), blocks.end(), block) == blocks.end())
            blocks.push_back(block);
    };
    for (const FindingGroup& group : groups)
        if (!group.stretches.empty()) add(group.stretches[group.worst].worst);
    for (const FindingGroup& group : groups)
        for (size_t i = 0; i < std::min(group.stretches.size(), most_places); ++i)
            add(group.stretches[i].worst);
    return blocks;
}

bool has_card(const std::vector<FindingGroup>& groups, size_t block) {
    return std::any_of(groups.begin(), groups.end(), [&](const FindingGroup& group) {
        return !group.stretches.empty() && group.stretches[group.worst].worst == block;
    });
}

std::string html_cards(const CheckRun& run, const ReportViews& views) {
    std::string cards;
    for (const FindingGroup& group : finding_groups(run)) cards += card_of(run, group, views);
    return cards.empty() ? R"(<p class="none">Nothing was found.</p>)" : cards;
}

} // namespace app
