#pragma once

#include <vector>

#include "app/view/model/block_row.h"

namespace app::viewer {

/// A stretch of blocks as a column of the timeline.
struct TimelineCell {
    double least = core::infinity; // margin, mm, or slack, s; infinite: nothing is near
    bool moves = false;            // any of them
    bool known = false;            // any of them is checked
    bool near = false;
    bool offending = false;

    bool operator==(const TimelineCell&) const = default;
};

TimelineCell cell_of(const BlockRow& row);
TimelineCell merged(const TimelineCell& a, const TimelineCell& b);

/// The cell of any stretch of blocks in logarithmic time, while the check continues.
class MinimumTree {
public:
    /// New blocks are empty.
    void resize(size_t count);
    size_t size() const { return count_; }
    void set(size_t block, const TimelineCell& cell);
    /// Of blocks first .. last - 1.
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

/// All of it.
TimelineRange whole(size_t blocks);

/// Zoomed in (factor below 1) or out, with the block at a share of the width fixed. At least ten
/// blocks, at most all.
TimelineRange zoomed(const TimelineRange& range, size_t blocks, double at, double factor);

/// Moved by a share of its width, within the program.
TimelineRange moved(const TimelineRange& range, size_t blocks, double by);

/// Moved as little as possible so that a block is in it.
TimelineRange showing(const TimelineRange& range, size_t blocks, size_t block);

/// The block at a share of the width; beyond the end, the last one. There must be blocks.
size_t block_at(const TimelineRange& range, size_t blocks, double at);

/// The middle of a block as a share of the width.
double place_of(const TimelineRange& range, size_t block);

/// A cell for each pixel, with the least value of all blocks that the pixel covers, so that no
/// block is lost.
std::vector<TimelineCell> columns(const MinimumTree& tree, const TimelineRange& range,
                                  size_t pixels);

/// The height of the bar for a slack, as a share of its row: logarithmic, from `least_slack` to
/// `most_slack` seconds.
double slack_height(double seconds);
constexpr double least_slack = 1e-4, most_slack = 100.0;

/// Successive blocks with one tool in the spindle.
struct ToolBand {
    size_t first = 0, last = 0; // one past the last
    std::optional<core::ToolNumber> tool;
};
std::vector<ToolBand> tool_bands(const std::vector<BlockRow>& rows);

} // namespace app::viewer
