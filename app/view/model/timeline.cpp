#include "app/view/model/timeline.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/base/math.h"

namespace app::viewer {
namespace {

constexpr double least_width = 10.0;

/// The range from `first` with this width, clamped to the program.
TimelineRange within(double first, double width, size_t blocks) {
    const double count = std::max(static_cast<double>(blocks), 1.0);
    width = std::clamp(width, std::min(least_width, count), count);
    first = std::clamp(first, 0.0, count - width);
    return {first, first + width};
}

} // namespace

TimelineRange whole(size_t blocks) { return {0.0, std::max(static_cast<double>(blocks), 1.0)}; }

TimelineRange zoomed(const TimelineRange& range, size_t blocks, double at, double factor) {
    const double fixed = range.first + at * range.width();
    const double count = std::max(static_cast<double>(blocks), 1.0);
    const double width = std::clamp(range.width() * factor, std::min(least_width, count), count);
    return within(fixed - at * width, width, blocks);
}

TimelineRange moved(const TimelineRange& range, size_t blocks, double by) {
    return within(range.first + by * range.width(), range.width(), blocks);
}

TimelineRange showing(const TimelineRange& range, size_t blocks, size_t block) {
    const auto at = static_cast<double>(block);
    if (at < range.first) return within(at, range.width(), blocks);
    if (at + 1.0 > range.last) return within(at + 1.0 - range.width(), range.width(), blocks);
    return range;
}

size_t block_at(const TimelineRange& range, size_t blocks, double at) {
    const double block = range.first + at * range.width();
    if (!(block > 0.0)) return 0;
    return std::min(static_cast<size_t>(block), blocks - 1);
}

double column_of(const TimelineRange& range, size_t block) {
    return (static_cast<double>(block) + 0.5 - range.first) / range.width();
}

std::vector<TimelineCell> columns(const MinimumTree& tree, const TimelineRange& range,
                                  size_t pixels) {
    std::vector<TimelineCell> cells(pixels);
    const double step = range.width() / static_cast<double>(std::max<size_t>(pixels, 1));
    for (size_t i = 0; i < pixels; ++i) {
        const double begin = range.first + static_cast<double>(i) * step;
        const auto first = static_cast<size_t>(std::max(begin, 0.0));
        const auto last = static_cast<size_t>(std::max(std::ceil(begin + step), 0.0));
        cells[i] = tree.over(first, std::max(last, first + 1));
    }
    return cells;
}

double slack_height(double seconds) {
    if (!(seconds > least_slack)) return 0.0;
    return std::min(core::log10(seconds / least_slack) / core::log10(most_slack / least_slack),
                    1.0);
}

std::vector<ToolBand> tool_bands(const std::vector<BlockRow>& rows) {
    std::vector<ToolBand> bands;
    for (size_t i = 0; i < rows.size(); ++i) {
        if (bands.empty() || bands.back().tool != rows[i].tool)
            bands.push_back({i, i, rows[i].tool});
        bands.back().last = i + 1;
    }
    return bands;
}

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
