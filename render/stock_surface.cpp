#include "render/stock_surface.h"

#include <algorithm>
#include <cmath>

namespace render {
namespace {

using core::Interval;
using core::ScanLines;

/// One end of an interval, with what made it.
struct MarkedEnd {
    double along;
    uint32_t mark;
    uint8_t tilt;

    bool operator==(const MarkedEnd&) const = default;
};

/// The ends on a line, upwards; the same line is asked for its ends again and again.
class LineEnds {
public:
    LineEnds(const ScanLines& lines, int u, int v)
        : lines_(lines), line_(lines.line(u, v)), u_(u), v_(v) {}

    size_t size() const { return 2 * line_.size(); }
    MarkedEnd operator[](size_t i) const {
        const Interval matter = line_[i / 2];
        const core::EndMarks marks = lines_.marks(u_, v_, i / 2);
        return i % 2 == 0 ? MarkedEnd{matter.lower, marks.lower, marks.lower_tilt}
                          : MarkedEnd{matter.upper, marks.upper, marks.upper_tilt};
    }

private:
    const ScanLines& lines_;
    core::LineView line_;
    int u_, v_;
};

/// Where two states of a line differ; empty if they do not.
std::optional<Interval> changed(const ScanLines& was, const ScanLines& is, int u, int v) {
    const LineEnds a(was, u, v), b(is, u, v);
    const size_t common = std::min(a.size(), b.size());
    size_t front = 0, back = 0;
    while (front < common && a[front] == b[front]) ++front;
    if (front == a.size() && front == b.size()) return std::nullopt;
    while (back < common - front && a[a.size() - 1 - back] == b[b.size() - 1 - back]) ++back;
    Interval range{core::infinity, -core::infinity};
    for (const LineEnds* ends : {&a, &b}) {
        if (front >= ends->size() - back) continue;
        range.lower = std::min(range.lower, (*ends)[front].along);
        range.upper = std::max(range.upper, (*ends)[ends->size() - 1 - back].along);
    }
    return range;
}

/// Which bricks hold a node among those first .. last, along one axis.
core::IndexRange bricks_with(int first, int last, int count) {
    const auto floor_div = [](int a, int b) { return a >= 0 ? a / b : -((b - 1 - a) / b); };
    return {std::max(0, -floor_div(brick_cells - first, brick_cells)),
            std::min(count - 1, floor_div(last + 1, brick_cells))};
}

/// Marks the bricks in which a change of one family of lines can be seen.
class TouchedBricks {
public:
    TouchedBricks(const core::ScanGrid& grid, const std::array<int, 3>& counts)
        : grid_(grid),
          counts_(counts),
          touched_(static_cast<size_t>(counts[0]) * static_cast<size_t>(counts[1])
                       * static_cast<size_t>(counts[2]),
                   0) {}

    void compare(const ScanLines& was, const ScanLines& is);
    const std::vector<uint8_t>& touched() const { return touched_; }

private:
    void touch(int axis, int u, int v, const Interval& range);

    const core::ScanGrid& grid_;
    std::array<int, 3> counts_;
    std::vector<uint8_t> touched_;
};

void TouchedBricks::compare(const ScanLines& was, const ScanLines& is) {
    constexpr int tile = ScanLines::tile_side;
    for (int v0 = 0; v0 < is.v_count(); v0 += tile)
        for (int u0 = 0; u0 < is.u_count(); u0 += tile) {
            if (was.shares_tile(is, u0, v0)) continue;
            for (int v = v0; v < std::min(v0 + tile, is.v_count()); ++v)
                for (int u = u0; u < std::min(u0 + tile, is.u_count()); ++u)
                    if (const auto range = changed(was, is, u, v)) touch(is.axis(), u, v, *range);
        }
}

void TouchedBricks::touch(int axis, int u, int v, const Interval& range) {
    std::array<core::IndexRange, 3> bricks;
    const auto place = [&](int along) { return static_cast<size_t>(along); };
    const auto node = [&](double x) { // whose line is at or below x
        const double lines = (x - grid_.coordinate(axis, 0)) / grid_.spacing;
        return static_cast<int>(std::floor(
                   std::clamp(lines, -2.0, static_cast<double>(grid_.count(axis)) + 2.0)))
               + 1;
    };
    // Two nodes more: an end is taken for an edge's own a little beyond it.
    bricks[place(axis)] =
        bricks_with(node(range.lower) - 1, node(range.upper) + 2, counts_[place(axis)]);
    bricks[place(core::u_axis(axis))] =
        bricks_with(u + 1, u + 1, counts_[place(core::u_axis(axis))]);
    bricks[place(core::v_axis(axis))] =
        bricks_with(v + 1, v + 1, counts_[place(core::v_axis(axis))]);
    for (int k = bricks[2].first; k <= bricks[2].last; ++k)
        for (int j = bricks[1].first; j <= bricks[1].last; ++j)
            for (int i = bricks[0].first; i <= bricks[0].last; ++i)
                touched_[place(i + counts_[0] * (j + counts_[1] * k))] = 1;
}

} // namespace

void StockSurface::reset() {
    started_ = false;
    lines_ = {};
    memory_.clear();
    bricks_.clear();
    shown_.clear();
}

bool StockSurface::is_same_grid(const core::CutModel& model) const {
    if (!started_ || !(lines_.grid == model.lines.grid)) return false;
    for (size_t i = 0; i < 3; ++i)
        if (lines_.families[i].u_count() != model.lines.families[i].u_count()
            || lines_.families[i].v_count() != model.lines.families[i].v_count())
            return false;
    return true;
}

void StockSurface::start(const core::CutModel& model) {
    reset();
    for (size_t i = 0; i < 3; ++i) // cells 0 .. count, quads at nodes 0 .. count
        counts_[i] = model.lines.grid.count(static_cast<int>(i)) / brick_cells + 1;
    const size_t count = static_cast<size_t>(counts_[0]) * static_cast<size_t>(counts_[1])
                         * static_cast<size_t>(counts_[2]);
    memory_.resize(count);
    bricks_.resize(count);
    started_ = true;
}

size_t StockSurface::update(const core::CutModel& model) {
    const bool all = !is_same_grid(model);
    if (all) start(model);
    TouchedBricks changes(model.lines.grid, counts_);
    if (!all)
        for (size_t i = 0; i < 3; ++i) changes.compare(lines_.families[i], model.lines.families[i]);
    lines_ = model.lines;
    size_t made = 0;
    for (int k = 0; k < counts_[2]; ++k)
        for (int j = 0; j < counts_[1]; ++j)
            for (int i = 0; i < counts_[0]; ++i) {
                const auto brick = static_cast<size_t>(i + counts_[0] * (j + counts_[1] * k));
                if (!all && changes.touched()[brick] == 0) continue;
                StockBrick surface = contour_brick(model, {i, j, k}, memory_[brick], workspace_);
                bricks_[brick] = surface.blocks.empty()
                                     ? nullptr
                                     : std::make_shared<const StockBrick>(std::move(surface));
                ++made;
            }
    if (made == 0) return 0;
    shown_.clear();
    for (const auto& brick : bricks_)
        if (brick) shown_.push_back(brick);
    return made;
}

StockBricks stock_bricks(const core::CutModel& model) {
    StockSurface surface;
    surface.update(model);
    return surface.bricks();
}

} // namespace render
