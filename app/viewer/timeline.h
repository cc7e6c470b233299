#pragma once

#include "app/viewer/minimum_tree.h"

namespace app::viewer {

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
