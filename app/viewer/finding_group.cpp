#include "app/viewer/finding_group.h"

#include <algorithm>
#include <map>
#include <tuple>

namespace app::viewer {
namespace {

/// Whether nothing moves between two blocks.
bool follow_each_other(const std::vector<BlockRow>& rows, size_t before, size_t after) {
    for (size_t block = before + 1; block < after; ++block)
        if (moves(rows[block])) return false;
    return true;
}

bool is_of(const BlockRow& row, const core::Finding& finding) {
    return row.lower && row.part == finding.pair[0] && row.body == finding.pair[1];
}

void take_worst(FindingStretch& stretch, size_t block, const BlockRow& row,
                const core::Finding& finding) {
    if (stretch.count > 0 && finding.shortfall <= stretch.shortfall) return;
    stretch.worst = block;
    stretch.shortfall = finding.shortfall;
    stretch.clearance = is_of(row, finding) ? row.lower : std::nullopt;
    stretch.message = finding.message;
    stretch.cure = finding.cure;
}

/// The findings of a group come in the order of their blocks.
void add(FindingGroup& group, const std::vector<BlockRow>& rows, const core::Finding& finding) {
    group.severity = std::max(group.severity, finding.severity);
    if (!finding.block || core::value_of(*finding.block) >= rows.size()) {
        group.message = finding.message;
        group.cure = finding.cure;
        return;
    }
    const size_t block = core::value_of(*finding.block);
    const bool goes_on =
        !group.stretches.empty() && follow_each_other(rows, group.stretches.back().last, block);
    if (!goes_on) {
        FindingStretch fresh;
        fresh.first = fresh.last = fresh.worst = block;
        group.stretches.push_back(fresh);
    }
    FindingStretch& stretch = group.stretches.back();
    take_worst(stretch, block, rows[block], finding);
    if (stretch.count > 0 && stretch.last == block) return; // told twice
    stretch.last = block;
    ++stretch.count;
    ++group.count;
}

/// How much is missing at the worst place.
double shortfall_of(const FindingGroup& group) {
    return group.stretches.empty() ? 0.0 : group.stretches[group.worst].shortfall;
}

size_t first_of(const FindingGroup& group) {
    return group.stretches.empty() ? 0 : group.stretches.front().first;
}

} // namespace

std::vector<FindingGroup> grouped(const std::vector<BlockRow>& rows,
                                  const std::vector<core::Finding>& findings) {
    std::vector<const core::Finding*> sorted;
    for (const core::Finding& finding : findings)
        if (finding.severity > core::Severity::off) sorted.push_back(&finding);
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const auto* a, const auto* b) { return a->block < b->block; });
    std::map<std::tuple<std::string, std::string, std::string>, FindingGroup> found;
    for (const core::Finding* finding : sorted) {
        FindingGroup& group = found[{finding->rule, finding->pair[0], finding->pair[1]}];
        group.rule = finding->rule;
        group.pair = finding->pair;
        add(group, rows, *finding);
    }
    std::vector<FindingGroup> groups;
    for (auto& [key, group] : found) {
        const auto worst = std::max_element(
            group.stretches.begin(), group.stretches.end(),
            [](const auto& a, const auto& b) { return a.shortfall < b.shortfall; });
        group.worst = static_cast<size_t>(worst - group.stretches.begin());
        groups.push_back(std::move(group));
    }
    std::stable_sort(groups.begin(), groups.end(), [](const auto& a, const auto& b) {
        if (a.severity != b.severity) return a.severity > b.severity;
        if (shortfall_of(a) != shortfall_of(b)) return shortfall_of(a) > shortfall_of(b);
        return first_of(a) < first_of(b);
    });
    return groups;
}

std::optional<StretchPlace> stretch_at(const std::vector<FindingGroup>& groups, size_t block) {
    for (size_t group = 0; group < groups.size(); ++group) {
        const auto& all = groups[group].stretches;
        const auto found = std::lower_bound(
            all.begin(), all.end(), block,
            [](const FindingStretch& stretch, size_t wanted) { return stretch.last < wanted; });
        if (found != all.end() && found->first <= block)
            return StretchPlace{group, static_cast<size_t>(found - all.begin())};
    }
    return {};
}

std::optional<StretchPlace> stretch_beside(const std::vector<FindingGroup>& groups,
                                           const std::optional<StretchPlace>& from, bool forward) {
    std::vector<StretchPlace> all;
    for (size_t group = 0; group < groups.size(); ++group)
        for (size_t stretch = 0; stretch < groups[group].stretches.size(); ++stretch)
            all.push_back({group, stretch});
    if (all.empty()) return {};
    const auto here = from ? std::find(all.begin(), all.end(), *from) : all.end();
    if (here == all.end()) return forward ? all.front() : all.back();
    if (forward) return here + 1 == all.end() ? std::nullopt : std::optional(*(here + 1));
    return here == all.begin() ? std::nullopt : std::optional(*(here - 1));
}

} // namespace app::viewer
