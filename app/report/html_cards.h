#pragma once

#include <string>
#include <vector>

#include "app/report/report_views.h"
#include "app/viewer/finding_group.h"

namespace app {

/// The findings of a check as the window groups them.
std::vector<viewer::FindingGroup> finding_groups(const CheckRun& run);

/// The blocks that a report should show, at most so many, the most telling ones first: the worst of
/// each group, then those of the other stretches.
std::vector<size_t> blocks_to_show(const std::vector<viewer::FindingGroup>& groups, size_t most);

/// Whether a card shows a picture of a block: the worst one of a group.
bool has_card(const std::vector<viewer::FindingGroup>& groups, size_t block);

/// A card for each group of findings, as HTML.
std::string html_cards(const CheckRun& run, const ReportViews& views);

} // namespace app
