#include "app/viewer/minimum_tree.h"

#include <algorithm>
#include <bit>

namespace app::viewer {

TimelineCell cell_of(const BlockRow& row) {
    TimelineCell cell;
    cell.moves = moves(row);
    cell.known = row.is_known;
    if (!row.is_known) return cell;
    cell.near = is_near(row);
    cell.offending = is_offending(row);
    if (row.has_pair()) cell.least = *row.lower - *row.allowance;
    return cell;
}

TimelineCell merged(const TimelineCell& a, const TimelineCell& b) {
    return {std::min(a.least, b.least), a.moves || b.moves, a.known || b.known, a.near || b.near,
            a.offending || b.offending};
}

void MinimumTree::resize(size_t count) {
    if (count <= leaves_ && count >= count_) {
        count_ = count;
        return;
    }
    std::vector<TimelineCell> cells(std::min(count, count_));
    std::copy_n(nodes_.begin() + static_cast<ptrdiff_t>(leaves_), cells.size(), cells.begin());
    count_ = count;
    leaves_ = std::bit_ceil(std::max<size_t>(count, 1));
    nodes_.assign(2 * leaves_, {});
    std::copy(cells.begin(), cells.end(), nodes_.begin() + static_cast<ptrdiff_t>(leaves_));
    for (size_t i = leaves_ - 1; i > 0; --i) nodes_[i] = merged(nodes_[2 * i], nodes_[2 * i + 1]);
}

void MinimumTree::set(size_t block, const TimelineCell& cell) {
    size_t node = leaves_ + block;
    nodes_[node] = cell;
    for (node /= 2; node > 0; node /= 2) {
        const TimelineCell both = merged(nodes_[2 * node], nodes_[2 * node + 1]);
        if (both == nodes_[node]) return;
        nodes_[node] = both;
    }
}

TimelineCell MinimumTree::over(size_t first, size_t last) const {
    TimelineCell cell;
    last = std::min(last, count_);
    if (first >= last) return cell;
    for (size_t a = first + leaves_, b = last + leaves_; a < b; a /= 2, b /= 2) {
        if (a % 2 == 1) cell = merged(cell, nodes_[a++]);
        if (b % 2 == 1) cell = merged(cell, nodes_[--b]);
    }
    return cell;
}

} // namespace app::viewer
