#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace app::viewer {
struct FindingGroup;
}

namespace app {

struct CheckRun;

/// The picture and scene of one block in a report.
struct BlockView {
    size_t block = 0;
    std::string picture; // a JPEG's bytes; empty: there is none
    std::string scene;   // a JSON object for the page's 3D view; empty: there is none
};

/// Pictures and scenes of a report.
struct ReportViews {
    std::vector<BlockView> views;
    std::string meshes;      // a JSON array that the scenes refer to
    std::string no_pictures; // why there are none, in a sentence; else empty
};

/// The report of a check as one self-contained HTML file.
///
/// Result: verdict, findings with what `views` has of their blocks, charts, a table of all blocks,
///         assumptions, and how near the bounds are to each other and why.
std::string html_report(const CheckRun& run, const ReportViews& views);

/// All blocks of a check as columns of numbers, for the script of the page: a JSON object.
///
/// Units:  um, 0.1 ms and 0.01 mm3, as integers. A lower bound is rounded down and an upper one up:
///         what is shown encloses what is known.
/// Result: `lower` is -1 where nothing is known, `width` (upper less lower) -1 beyond the search
///         limit. Columns with many equal values are runs (NumberRuns, StepRuns).
/// Cost:   linear; some 20 bytes for a block, and each different text once.
std::string blocks_json(const CheckRun& run);

/// The findings of a check as the window groups them.
std::vector<viewer::FindingGroup> finding_groups(const CheckRun& run);

/// The blocks that have a card of their own: the worst one of each group of findings; without any,
/// the block with the least margin.
std::vector<size_t> blocks_of_cards(const CheckRun& run);

/// The blocks that a report should show, at most `most`: first those of cards, then the other
/// stretches of the groups.
std::vector<size_t> blocks_to_show(const CheckRun& run, size_t most);

/// A card for each group of findings, as HTML.
std::string html_cards(const CheckRun& run, const ReportViews& views);

} // namespace app
