#pragma once

#include <vector>

#include "app/view/model/block_row.h"

namespace app::viewer {

/// What a stretch of blocks comes to: a column of the timeline.
struct TimelineCell {
    double least = core::infinity; // what is kept beyond need: clearance beyond the
                                   // allowance, mm, or slack, s; infinite: nothing is near
    bool moves = false;            // any of them
    bool known = false;            // the check has been at any of them
    bool near = false;
    bool offending = false;

    bool operator==(const TimelineCell&) const = default;
};

TimelineCell cell_of(const BlockRow& row);
TimelineCell merged(const TimelineCell& a, const TimelineCell& b);

/// The cell of any stretch of blocks at the cost of a logarithm, while blocks become known.
class MinimumTree {
public:
    /// Blocks that are new are empty.
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

/// Nearer (factor below 1) or farther, the block at a share of the width staying where it is. Never
/// less than ten blocks, never more than there are.
TimelineRange zoomed(const TimelineRange& range, size_t blocks, double at, double factor);

/// Moved by a share of its width, within the program.
TimelineRange moved(const TimelineRange& range, size_t blocks, double by);

/// Moved as little as possible so that a block is in it.
TimelineRange showing(const TimelineRange& range, size_t blocks, size_t block);

/// The block at a share of the width; the last one beyond the end. There must be blocks.
size_t block_at(const TimelineRange& range, size_t blocks, double at);

/// Where the middle of a block is, as a share of the width.
double place_of(const TimelineRange& range, size_t block);

/// A cell for each of so many pixels: the least clearance of all blocks that a pixel covers, so
/// that no single block is ever overlooked.
std::vector<TimelineCell> columns(const MinimumTree& tree, const TimelineRange& range,
                                  size_t pixels);

/// How high the bar of a slack is, as a share of its row's height: by decades, from `least_slack`
/// seconds to `most_slack`, as slack goes from microseconds to minutes.
double slack_height(double seconds);
constexpr double least_slack = 1e-4, most_slack = 100.0;

/// Blocks in a row with one tool in the spindle.
struct ToolBand {
    size_t first = 0, last = 0; // one past the last
    std::optional<core::ToolNumber> tool;
};
std::vector<ToolBand> tool_bands(const std::vector<BlockRow>& rows);

} // namespace app::viewer
