#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace app::viewer {
struct FindingGroup;
}

namespace app {

struct CheckRun;

/// What a report shows of a block: the moment at which two bodies are nearest or first collide.
struct ShownMoment {
    size_t block = 0;
    std::array<std::string, 2> pair; // names of the bodies; empty: the pair that decides the block

    bool operator==(const ShownMoment&) const = default;
};

/// The picture and scene of one block in a report.
struct BlockView {
    ShownMoment moment;
    std::string picture; // bytes of a JPEG; empty: none
    std::string scene;   // JSON object for the 3D view; empty: none
};

/// Pictures and scenes of a report.
struct ReportViews {
    std::vector<BlockView> views;
    std::string meshes;      // JSON array that the scenes refer to
    std::string no_pictures; // why pictures are missing; else empty
};

/// The report of a check as one self-contained HTML file.
///
/// Result: verdict; findings with the pictures and scenes in `views`; charts; a table of all
///         blocks; assumptions; the causes of the difference between the bounds.
std::string html_report(const CheckRun& run, const ReportViews& views);

/// All blocks of a check as columns of numbers, for the script of the page: a JSON object.
///
/// Units:  um, 0.1 ms and 0.01 mm3, as integers. Lower bounds are rounded down and upper bounds up,
///         so the interval shown encloses the true one.
/// Result: `lower` is -1 if nothing is known; `width` (upper minus lower) is -1 beyond the search
///         limit. Columns with many equal values are run-length encoded (NumberRuns, DeltaRuns).
/// Cost:   linear; about 20 bytes per block, and each different text once.
std::string blocks_json(const CheckRun& run);

/// The findings of a check as the window groups them.
std::vector<viewer::FindingGroup> finding_groups(const CheckRun& run);

/// The moments that get a card: the worst block of each group of findings, with its pair; without
/// findings, the block with the least margin.
std::vector<ShownMoment> moments_of_cards(const CheckRun& run);

/// The moments that a report should show, at most `most`: first those with cards, then the other
/// stretches of the groups.
std::vector<ShownMoment> moments_to_show(const CheckRun& run, size_t most);

/// A card for each group of findings, as HTML.
std::string html_cards(const CheckRun& run, const ReportViews& views);

} // namespace app
