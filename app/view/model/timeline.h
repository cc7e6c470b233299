#pragma once

#include <vector>

#include "app/view/model/block_row.h"

namespace app::viewer {

/// A stretch of blocks, as one column of the timeline.
struct TimelineCell {
    double least = core::infinity; // least margin, mm, or slack, s; infinite: none
    bool moves = false;            // at least one block does
    bool known = false;            // at least one block is checked
    bool near = false;
    bool offending = false;

    bool operator==(const TimelineCell&) const = default;
};

TimelineCell cell_of(const BlockRow& row);
TimelineCell merged(const TimelineCell& a, const TimelineCell& b);

/// Gives the cell of any stretch of blocks in logarithmic time, also while the check adds blocks.
class MinimumTree {
public:
    /// Sets the number of blocks; new ones are empty.
    void resize(size_t count);
    size_t size() const { return count_; }
    void set(size_t block, const TimelineCell& cell);
    /// The cell of blocks first .. last - 1.
    TimelineCell over(size_t first, size_t last) const;

private:
    size_t count_ = 0;
    size_t leaves_ = 0;               // a power of two
    std::vector<TimelineCell> nodes_; // node 1 is the root, leaf i is leaves_ + i
};

/// The stretch of the program that the timeline shows, in blocks.
struct TimelineRange {
    double first = 0.0, last = 1.0;

    double width() const { return last - first; }
    bool operator==(const TimelineRange&) const = default;
};

/// The range of the whole program.
TimelineRange whole(size_t blocks);

/// The range zoomed in (factor below 1) or out; the block at fraction `at` of the width stays in
/// place. Shows at least ten blocks, at most all.
TimelineRange zoomed(const TimelineRange& range, size_t blocks, double at, double factor);

/// The range moved by a fraction of its width, within the program.
TimelineRange moved(const TimelineRange& range, size_t blocks, double by);

/// The range moved as little as possible so that it contains a block.
TimelineRange showing(const TimelineRange& range, size_t blocks, size_t block);

/// The block at a fraction of the width; beyond the end, the last one. There must be blocks.
size_t block_at(const TimelineRange& range, size_t blocks, double at);

/// The middle of a block, as a fraction of the width.
double column_of(const TimelineRange& range, size_t block);

/// A cell for each pixel with the least value of all blocks that it covers, so that no block is
/// lost.
std::vector<TimelineCell> columns(const MinimumTree& tree, const TimelineRange& range,
                                  size_t pixels);

/// The height of the bar for a slack, as a fraction of the row: logarithmic, from `least_slack` to
/// `most_slack` seconds.
double slack_height(double seconds);
constexpr double least_slack = 1e-4, most_slack = 100.0;

/// Successive blocks with the same tool in the spindle.
struct ToolBand {
    size_t first = 0, last = 0; // one past the last
    std::optional<core::ToolNumber> tool;
};
std::vector<ToolBand> tool_bands(const std::vector<BlockRow>& rows);

} // namespace app::viewer
