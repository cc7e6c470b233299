#include "core/dbm/stock_pieces.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "core/base/union_find.h"
#include "core/dbm/cut_model.h"

namespace core {
namespace {

constexpr uint32_t no_piece = ~uint32_t{0};
constexpr int tile_side = ScanLines::tile_side;

/// The first and the last line whose position along `axis` is within lower .. upper, widened by
/// `more` lines; first > last if there is none.
std::pair<int, int> lines_within(const ScanGrid& grid, int axis, double lower, double upper,
                                 int more) {
    const double first = grid.coordinate(axis, 0), last = grid.count(axis) - 1;
    const double from = std::ceil((lower - first) / grid.spacing) - more;
    const double to = std::floor((upper - first) / grid.spacing) + more;
    return {static_cast<int>(std::clamp(from, 0.0, last + 1.0)),
            static_cast<int>(std::clamp(to, -1.0, last))};
}

template <typename Line>
bool covers(const Line& line, double lower, double upper) {
    for (const Interval& matter : line)
        if (matter.lower <= lower && matter.upper >= upper) return true;
    return false;
}

const ScanLines& family(const CutModel& model, int axis) {
    return model.lines.families[static_cast<size_t>(axis)];
}

/// Calls `act(a, b)` for the segments of two lines that overlap or touch.
template <typename Act>
void for_overlaps(const LineView& one, const LineView& other, const Act& act) {
    for (size_t a = 0, b = 0; a < one.size() && b < other.size();) {
        if (one[a].lower <= other[b].upper && other[b].lower <= one[a].upper) act(a, b);
        one[a].upper < other[b].upper ? ++a : ++b;
    }
}

/// Finds lines along X or Y that connect neighbouring lines along Z in one row of them. The
/// connecting line found last is tried first, for it usually connects the next lines, too.
class RowOfLines {
public:
    /// The lines (.., row) of the Z family if `towards` is X, (row, ..) if it is Y.
    RowOfLines(const CutModel& model, int towards, int row)
        : grid_(model.lines.grid),
          across_(family(model, towards)),
          places_(model.positions[static_cast<size_t>(towards)].data()),
          towards_(towards),
          row_(row) {}

    /// Whether material of line number `step` is connected to material of the next one that
    /// overlaps or touches it.
    bool hang_together(int step, const Interval& a, const Interval& b) {
        const double lower = std::max(a.lower, b.lower), upper = std::min(a.upper, b.upper);
        const double here = places_[step], there = places_[step + 1];
        for (const Bridge& bridge : bridges_)
            if (bridge.height >= lower && bridge.height <= upper && bridge.matter.lower <= here
                && bridge.matter.upper >= there)
                return true;
        const auto [first, last] = lines_within(grid_, 2, lower, upper, 0);
        if (first > last) return true;
        for (int k = first; k <= last; ++k)
            for (const Interval& matter :
                 towards_ == 0 ? across_.line(row_, k) : across_.line(k, row_))
                if (matter.lower <= here && matter.upper >= there) {
                    bridges_[next_] = {grid_.coordinate(2, k), matter};
                    next_ = (next_ + 1) % bridges_.size();
                    return true;
                }
        return false;
    }

private:
    /// Material of a line along X or Y at a height.
    struct Bridge {
        double height = infinity;
        Interval matter{infinity, -infinity};
    };

    const ScanGrid& grid_;
    const ScanLines& across_;
    const double* places_;
    int towards_, row_;
    std::array<Bridge, 2> bridges_; // one for the material below, one for what hangs above it
    size_t next_ = 0;
};

/// The stretches of material on the lines along Z of a range, grouped by what hangs together
/// within it.
struct Stretches {
    std::vector<uint32_t> first; // number of the first stretch of each line; one more at the end
    UnionFind groups{0};
    size_t group_count = 0;
};

Stretches stretches_in(const CutModel& model, const LineRange& range) {
    const ScanLines& z = family(model, 2);
    const auto width = static_cast<size_t>(range.u_last - range.u_first);
    std::vector<LineView> lines;
    lines.reserve(width * static_cast<size_t>(range.v_last - range.v_first));
    Stretches all;
    all.first.reserve(lines.capacity() + 1);
    uint32_t count = 0;
    for (int v = range.v_first; v < range.v_last; ++v)
        for (int u = range.u_first; u < range.u_last; ++u) {
            lines.push_back(z.line(u, v));
            all.first.push_back(count);
            count += static_cast<uint32_t>(lines.back().size());
        }
    all.first.push_back(count);
    all.groups = UnionFind(count);
    all.group_count = count;
    const auto join = [&](RowOfLines& row, int step, size_t at, size_t next) {
        for_overlaps(lines[at], lines[next], [&](size_t a, size_t b) {
            if (row.hang_together(step, lines[at][a], lines[next][b]))
                all.group_count -= all.groups.join(all.first[at] + static_cast<uint32_t>(a),
                                                   all.first[next] + static_cast<uint32_t>(b));
        });
    };
    for (int v = range.v_first; v < range.v_last; ++v) {
        RowOfLines row(model, 0, v);
        size_t at = static_cast<size_t>(v - range.v_first) * width;
        for (int u = range.u_first; u + 1 < range.u_last; ++u, ++at) join(row, u, at, at + 1);
    }
    for (int u = range.u_first; u < range.u_last; ++u) {
        RowOfLines row(model, 1, u);
        auto at = static_cast<size_t>(u - range.u_first);
        for (int v = range.v_first; v + 1 < range.v_last; ++v, at += width)
            join(row, v, at, at + width);
    }
    return all;
}

} // namespace

/// The material of a tile of lines along Z: its parts.
struct PieceMap::Tile {
    std::vector<uint32_t> first;   // number of the first stretch of each line; one more at the end
    std::vector<uint32_t> part;    // part to which each stretch belongs
    std::vector<StockPiece> parts; // volume stored as length until they are joined
};

/// A map during an update.
class PieceWork {
public:
    PieceWork(const CutModel& model, PieceMap& map)
        : model_(model),
          z_(family(model, 2)),
          map_(map),
          u_tiles_((z_.u_count() + tile_side - 1) / tile_side),
          v_tiles_((z_.v_count() + tile_side - 1) / tile_side) {}

    /// Brings the parts of changed tiles up to date; these tiles.
    std::vector<uint32_t> update();
    bool hangs_together_around(const std::vector<uint32_t>& changed) const;
    std::vector<StockPiece> put_together();

private:
    using Tile = PieceMap::Tile;

    uint32_t index(int tu, int tv) const { return static_cast<uint32_t>(tu + tv * u_tiles_); }
    LineRange lines_of(uint32_t tile) const {
        const int tu = static_cast<int>(tile) % u_tiles_, tv = static_cast<int>(tile) / u_tiles_;
        return {tu * tile_side, std::min((tu + 1) * tile_side, z_.u_count()), tv * tile_side,
                std::min((tv + 1) * tile_side, z_.v_count())};
    }
    static size_t line_index(const LineRange& range, int u, int v) {
        return static_cast<size_t>((u - range.u_first)
                                   + (v - range.v_first) * (range.u_last - range.u_first));
    }
    /// The next tile along X or Y, if there is one.
    std::optional<uint32_t> next(uint32_t tile, size_t towards) const {
        const int tu = static_cast<int>(tile) % u_tiles_, tv = static_cast<int>(tile) / u_tiles_;
        if (towards == 0) return tu + 1 < u_tiles_ ? std::optional(tile + 1) : std::nullopt;
        return tv + 1 < v_tiles_ ? std::optional(index(tu, tv + 1)) : std::nullopt;
    }
    /// The tile before this one along X or Y, if there is one.
    std::optional<uint32_t> previous(uint32_t tile, size_t towards) const {
        const int tu = static_cast<int>(tile) % u_tiles_, tv = static_cast<int>(tile) / u_tiles_;
        if (towards == 0) return tu > 0 ? std::optional(tile - 1) : std::nullopt;
        return tv > 0 ? std::optional(index(tu, tv - 1)) : std::nullopt;
    }
    std::shared_ptr<Tile> parts_of(uint32_t tile) const;
    void number_parts(Tile& tile, const LineRange& range, UnionFind& groups) const;
    void link(uint32_t tile, size_t towards);
    bool is_crumb(const StockPiece& piece) const;

    const CutModel& model_;
    const ScanLines& z_;
    PieceMap& map_;
    int u_tiles_, v_tiles_;
};

std::shared_ptr<PieceMap::Tile> PieceWork::parts_of(uint32_t number) const {
    const auto tile = std::make_shared<Tile>();
    const LineRange range = lines_of(number);
    Stretches all = stretches_in(model_, range);
    tile->first = std::move(all.first);
    number_parts(*tile, range, all.groups);
    return tile;
}

void PieceWork::number_parts(Tile& tile, const LineRange& range, UnionFind& groups) const {
    const double* const xs = model_.positions[0].data();
    const double* const ys = model_.positions[1].data();
    tile.part.resize(tile.first.back());
    uint32_t stretch = 0;
    for (int v = range.v_first; v < range.v_last; ++v)
        for (int u = range.u_first; u < range.u_last; ++u)
            for (const Interval& matter : z_.line(u, v)) {
                const uint32_t root = groups.root(stretch);
                const Vec3 low(xs[u], ys[v], matter.lower), high(xs[u], ys[v], matter.upper);
                if (root == stretch) { // the first of its group
                    tile.part[stretch] = static_cast<uint32_t>(tile.parts.size());
                    tile.parts.push_back({0.0, {}, 0.5 * (low + high)});
                }
                const uint32_t number = tile.part[root];
                StockPiece& part = tile.parts[number];
                part.volume += matter.length();
                part.box.extend(low);
                part.box.extend(high);
                tile.part[stretch++] = number;
            }
}

/// Finds connections across the border to the next tile.
void PieceWork::link(uint32_t number, size_t towards) {
    const std::optional<uint32_t> neighbour = next(number, towards);
    if (!neighbour) return;
    const Tile& tile = *map_.tiles_[number];
    const Tile& beyond = *map_.tiles_[*neighbour];
    const LineRange range = lines_of(number), far = lines_of(*neighbour);
    PieceMap::Links links;
    const int count = towards == 0 ? range.v_last - range.v_first : range.u_last - range.u_first;
    for (int i = 0; i < count; ++i) {
        const int u = towards == 0 ? range.u_last - 1 : range.u_first + i;
        const int v = towards == 1 ? range.v_last - 1 : range.v_first + i;
        const int u2 = u + (towards == 0), v2 = v + (towards == 1);
        const auto line = z_.line(u, v), other = z_.line(u2, v2);
        RowOfLines row(model_, static_cast<int>(towards), towards == 0 ? v : u);
        for_overlaps(line, other, [&](size_t a, size_t b) {
            const std::pair joined{tile.part[tile.first[line_index(range, u, v)] + a],
                                   beyond.part[beyond.first[line_index(far, u2, v2)] + b]};
            if (std::find(links.rbegin(), links.rend(), joined) != links.rend()) return;
            if (row.hang_together(towards == 0 ? u : v, line[a], other[b])) links.push_back(joined);
        });
    }
    std::sort(links.begin(), links.end());
    auto& known = map_.links_[towards][number];
    if (!known || *known != links)
        known = std::make_shared<const PieceMap::Links>(std::move(links));
}

std::vector<uint32_t> PieceWork::update() {
    const size_t count = index(0, v_tiles_);
    if (map_.tiles_.empty()) {
        map_.tiles_.resize(count);
        map_.changed_.assign(count, 1);
        for (auto& links : map_.links_) links.resize(count);
        map_.changed_tiles_.resize(count);
        std::iota(map_.changed_tiles_.begin(), map_.changed_tiles_.end(), 0U);
    }
    std::vector<uint32_t> changed = std::exchange(map_.changed_tiles_, {});
    for (const uint32_t tile : changed) map_.tiles_[tile] = parts_of(tile);
    for (const uint32_t tile : changed)
        for (const size_t towards : {0U, 1U}) {
            link(tile, towards);
            const auto before = previous(tile, towards);
            if (before && !map_.changed_[*before]) link(*before, towards);
        }
    for (const uint32_t tile : changed) map_.changed_[tile] = 0;
    return changed;
}

bool PieceWork::is_crumb(const StockPiece& piece) const {
    const double h = model_.lines.grid.spacing;
    return piece.volume < 8.0 * h * h * h || glm::length(piece.box.size()) < 4.0 * h;
}

/// Whether all parts in the changed tiles and those next to them are connected there, crumbs within
/// the changed ones aside. Then any connection elsewhere that led through changed material still
/// exists: it enters and leaves these tiles in those next to the changed ones, which are as before.
bool PieceWork::hangs_together_around(const std::vector<uint32_t>& changed) const {
    std::vector<uint32_t> around = changed;
    for (const uint32_t tile : changed)
        for (const size_t towards : {0U, 1U})
            for (const auto& neighbour : {next(tile, towards), previous(tile, towards)})
                if (neighbour) around.push_back(*neighbour);
    std::sort(around.begin(), around.end());
    around.erase(std::unique(around.begin(), around.end()), around.end());
    std::vector<uint32_t> first(1, 0);
    for (const uint32_t tile : around)
        first.push_back(first.back() + static_cast<uint32_t>(map_.tiles_[tile]->parts.size()));
    UnionFind groups(first.back());
    for (size_t i = 0; i < around.size(); ++i)
        for (const size_t towards : {0U, 1U}) {
            const auto neighbour = next(around[i], towards);
            if (!neighbour) continue;
            const auto at = std::lower_bound(around.begin(), around.end(), *neighbour);
            if (at == around.end() || *at != *neighbour) continue;
            const uint32_t beyond = first[static_cast<size_t>(at - around.begin())];
            for (const auto& [a, b] : *map_.links_[towards][around[i]])
                groups.join(first[i] + a, beyond + b);
        }
    struct Group {
        StockPiece piece;
        bool may_go_on = false; // beyond these tiles
    };
    std::vector<Group> all(first.back());
    for (size_t i = 0; i < around.size(); ++i) {
        const bool is_changed = std::binary_search(changed.begin(), changed.end(), around[i]);
        for (size_t p = 0; p < map_.tiles_[around[i]]->parts.size(); ++p) {
            const StockPiece& part = map_.tiles_[around[i]]->parts[p];
            Group& group = all[groups.root(first[i] + static_cast<uint32_t>(p))];
            group.piece.volume += part.volume;
            group.piece.box.extend(part.box);
            group.may_go_on |= !is_changed;
        }
    }
    const double h = model_.lines.grid.spacing;
    size_t count = 0;
    for (Group& group : all) {
        group.piece.volume *= h * h;
        count += group.may_go_on || !is_crumb(group.piece);
    }
    return count <= 1;
}

std::vector<StockPiece> PieceWork::put_together() {
    std::vector<uint32_t> first(1, 0);
    for (const auto& tile : map_.tiles_)
        first.push_back(first.back() + static_cast<uint32_t>(tile->parts.size()));
    UnionFind groups(first.back());
    for (int tv = 0; tv < v_tiles_; ++tv)
        for (int tu = 0; tu < u_tiles_; ++tu)
            for (size_t towards = 0; towards < 2; ++towards)
                if (const auto neighbour = next(index(tu, tv), towards))
                    for (const auto& [a, b] : *map_.links_[towards][index(tu, tv)])
                        groups.join(first[index(tu, tv)] + a, first[*neighbour] + b);
    std::vector<StockPiece> whole(first.back());
    for (size_t t = 0; t < map_.tiles_.size(); ++t)
        for (size_t p = 0; p < map_.tiles_[t]->parts.size(); ++p) {
            const StockPiece& part = map_.tiles_[t]->parts[p];
            const auto number = first[t] + static_cast<uint32_t>(p);
            StockPiece& piece = whole[groups.root(number)];
            if (groups.root(number) == number) piece.position = part.position;
            piece.volume += part.volume;
            piece.box.extend(part.box);
        }
    const double h = model_.lines.grid.spacing;
    std::vector<uint32_t> order;
    for (uint32_t i = 0; i < whole.size(); ++i) {
        whole[i].volume *= h * h;
        if (groups.root(i) == i && !is_crumb(whole[i])) order.push_back(i);
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](uint32_t a, uint32_t b) { return whole[a].volume > whole[b].volume; });
    std::vector<StockPiece> pieces;
    std::vector<uint32_t> rank(whole.size(), no_piece);
    for (const uint32_t i : order) {
        rank[i] = static_cast<uint32_t>(pieces.size());
        pieces.push_back(whole[i]);
    }
    map_.piece_of_.resize(whole.size());
    for (uint32_t i = 0; i < whole.size(); ++i) map_.piece_of_[i] = rank[groups.root(i)];
    return pieces;
}

void PieceMap::note_cut(const CutModel& model, const Aabb& box) {
    if (changed_.empty()) return; // nothing is known yet
    const ScanLines& z = family(model, 2);
    // A cut line along X or Y separates the lines along Z on both sides of it.
    const auto [u_first, u_last] = lines_within(model.lines.grid, 0, box.min.x, box.max.x, 1);
    const auto [v_first, v_last] = lines_within(model.lines.grid, 1, box.min.y, box.max.y, 1);
    const int u_tiles = (z.u_count() + tile_side - 1) / tile_side;
    for (int tv = v_first / tile_side; tv <= v_last / tile_side && v_first <= v_last; ++tv)
        for (int tu = u_first / tile_side; tu <= u_last / tile_side && u_first <= u_last; ++tu)
            if (const auto tile = static_cast<uint32_t>(tu + tv * u_tiles); !changed_[tile]) {
                changed_[tile] = 1;
                changed_tiles_.push_back(tile);
            }
}

bool PieceMap::may_have_separated(const CutModel& model) {
    const bool is_new = tiles_.empty();
    PieceWork work(model, *this);
    std::vector<uint32_t> changed = work.update();
    std::sort(changed.begin(), changed.end());
    return is_new || !work.hangs_together_around(changed);
}

std::vector<StockPiece> PieceMap::pieces(const CutModel& model) {
    PieceWork work(model, *this);
    work.update();
    return work.put_together();
}

std::vector<std::pair<Vec3, Vec3>> PieceMap::stretches(const CutModel& model, size_t number) const {
    std::vector<std::pair<Vec3, Vec3>> found;
    const ScanLines& z = family(model, 2);
    const int u_tiles = (z.u_count() + tile_side - 1) / tile_side;
    uint32_t first = 0;
    for (size_t t = 0; t < tiles_.size(); ++t) {
        const int u0 = static_cast<int>(t) % u_tiles * tile_side,
                  v0 = static_cast<int>(t) / u_tiles * tile_side;
        size_t stretch = 0;
        for (int v = v0; v < std::min(v0 + tile_side, z.v_count()); ++v)
            for (int u = u0; u < std::min(u0 + tile_side, z.u_count()); ++u)
                for (const Interval& matter : z.line(u, v))
                    if (piece_of_[first + tiles_[t]->part[stretch++]] == number)
                        found.emplace_back(point_on_line(model.lines.grid, 2, u, v, matter.lower),
                                           point_on_line(model.lines.grid, 2, u, v, matter.upper));
        first += static_cast<uint32_t>(tiles_[t]->parts.size());
    }
    return found;
}

namespace {

/// The range of heights that is inside all lines of some range.
struct CommonHeights {
    double low = -infinity, high = infinity;
};

/// What the lines within a range of one tile have in common; empty unless each is a single segment.
/// The loops run over neighbouring lines without branches, so that compilers use vectors.
std::optional<CommonHeights> single_segments(const ScanTile& tile, const LineRange& range) {
    constexpr size_t side = ScanTile::side;
    std::array<double, side> low, high, length, beyond;
    low.fill(-infinity);
    high.fill(infinity);
    length.fill(infinity);
    beyond.fill(-infinity);
    const auto first = static_cast<size_t>(range.u_first), last = static_cast<size_t>(range.u_last);
    for (int v = range.v_first; v < range.v_last; ++v) {
        const size_t row = static_cast<size_t>(v) * side;
        const double* lower = &tile.layers[0].lower[row];
        const double* upper = &tile.layers[0].upper[row];
        for (size_t u = first; u < last; ++u) {
            low[u] = std::max(low[u], lower[u]);
            high[u] = std::min(high[u], upper[u]);
            length[u] = std::min(length[u], upper[u] - lower[u]);
        }
        if (tile.layers.size() < 2) continue;
        lower = &tile.layers[1].lower[row];
        upper = &tile.layers[1].upper[row];
        for (size_t u = first; u < last; ++u) beyond[u] = std::max(beyond[u], upper[u] - lower[u]);
    }
    CommonHeights common;
    for (size_t u = first; u < last; ++u) {
        if (!(length[u] > 0.0) || beyond[u] > 0.0) return std::nullopt;
        common.low = std::max(common.low, low[u]);
        common.high = std::min(common.high, high[u]);
    }
    return common;
}

/// The same for lines of a family in any range, which is not empty.
std::optional<CommonHeights> single_segments(const ScanLines& lines, const LineRange& range) {
    CommonHeights common;
    for (int v0 = range.v_first / tile_side * tile_side; v0 < range.v_last; v0 += tile_side)
        for (int u0 = range.u_first / tile_side * tile_side; u0 < range.u_last; u0 += tile_side) {
            const ScanTile* tile = lines.tile(lines.tile_of(u0, v0));
            if (tile == nullptr) return std::nullopt;
            const auto here = single_segments(
                *tile, {std::max(range.u_first - u0, 0), std::min(range.u_last - u0, tile_side),
                        std::max(range.v_first - v0, 0), std::min(range.v_last - v0, tile_side)});
            if (!here) return std::nullopt;
            common.low = std::max(common.low, here->low);
            common.high = std::min(common.high, here->high);
        }
    return common;
}

} // namespace

bool hangs_together_within(const CutModel& model, const Aabb& box) {
    const ScanGrid& grid = model.lines.grid;
    const auto [u_first, u_last] = lines_within(grid, 0, box.min.x, box.max.x, 1);
    const auto [v_first, v_last] = lines_within(grid, 1, box.min.y, box.max.y, 1);
    if (u_first > u_last || v_first > v_last) return true;
    return stretches_in(model, {u_first, u_last + 1, v_first, v_last + 1}).group_count <= 1;
}

bool is_still_connected(const CutModel& model, const Aabb& box) {
    const ScanGrid& grid = model.lines.grid;
    const auto [u_first, u_last] = lines_within(grid, 0, box.min.x, box.max.x, 1);
    const auto [v_first, v_last] = lines_within(grid, 1, box.min.y, box.max.y, 1);
    if (u_first > u_last || v_first > v_last) return true;
    const auto common =
        single_segments(family(model, 2), {u_first, u_last + 1, v_first, v_last + 1});
    if (!common) return false;
    const double low = common->low, high = std::min(common->high, box.min.z);
    const double below = std::ceil((high - grid.coordinate(2, 0)) / grid.spacing) - 1.0;
    const int k = static_cast<int>(std::clamp(below, -1.0, grid.count(2) - 1.0));
    if (k < 0 || grid.coordinate(2, k) < low) return false;
    for (int v = v_first; v <= v_last; ++v)
        if (!covers(family(model, 0).line(v, k), grid.coordinate(0, u_first),
                    grid.coordinate(0, u_last)))
            return false;
    return covers(family(model, 1).line(k, u_first), grid.coordinate(1, v_first),
                  grid.coordinate(1, v_last));
}

} // namespace core
