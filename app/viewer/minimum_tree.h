#pragma once

#include <vector>

#include "app/viewer/block_row.h"

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

} // namespace app::viewer
