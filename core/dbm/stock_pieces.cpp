#include "core/dbm/stock_pieces.h"

#include <algorithm>
#include <cmath>

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

/// Whether material of line (u, v) along Z is connected to material of the next line along
/// `towards`, X or Y.
bool hang_together(const CutModel& model, int u, int v, int towards, const Interval& a,
                   const Interval& b) {
    const ScanGrid& grid = model.lines.grid;
    const double lower = std::max(a.lower, b.lower), upper = std::min(a.upper, b.upper);
    if (lower > upper) return false;
    const auto [first, last] = lines_within(grid, 2, lower, upper, 0);
    if (first > last) return true;
    const int step = towards == 0 ? u : v;
    const double here = grid.coordinate(towards, step), there = grid.coordinate(towards, step + 1);
    for (int k = first; k <= last; ++k) {
        const bool whole = towards == 0 ? covers(family(model, 0).line(v, k), here, there)
                                        : covers(family(model, 1).line(k, u), here, there);
        if (whole) return true;
    }
    return false;
}

} // namespace

/// The material of a tile of lines along Z: its parts, and their connections to parts of the next
/// tiles along X and Y.
struct PieceMap::Tile {
    std::vector<uint32_t> first;   // number of the first stretch of each line; one more at the end
    std::vector<uint32_t> part;    // part to which each stretch belongs
    std::vector<StockPiece> parts; // volume stored as length until they are joined
    std::array<std::vector<std::pair<uint32_t, uint32_t>>, 2> links;
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

    void update_pieces();
    std::vector<StockPiece> put_together();

private:
    using Tile = PieceMap::Tile;

    size_t index(int tu, int tv) const { return static_cast<size_t>(tu + tv * u_tiles_); }
    LineRange lines_of(int tu, int tv) const {
        return {tu * tile_side, std::min((tu + 1) * tile_side, z_.u_count()), tv * tile_side,
                std::min((tv + 1) * tile_side, z_.v_count())};
    }
    static size_t line_index(const LineRange& range, int u, int v) {
        return static_cast<size_t>((u - range.u_first)
                                   + (v - range.v_first) * (range.u_last - range.u_first));
    }
    std::shared_ptr<Tile> tile_parts(int tu, int tv) const;
    void number_parts(Tile& tile, const LineRange& range, UnionFind& groups) const;
    void link(int tu, int tv, int towards);

    const CutModel& model_;
    const ScanLines& z_;
    PieceMap& map_;
    int u_tiles_, v_tiles_;
};

std::shared_ptr<PieceMap::Tile> PieceWork::tile_parts(int tu, int tv) const {
    const auto tile = std::make_shared<Tile>();
    const LineRange range = lines_of(tu, tv);
    size_t count = 0;
    for (int v = range.v_first; v < range.v_last; ++v)
        for (int u = range.u_first; u < range.u_last; ++u) {
            tile->first.push_back(static_cast<uint32_t>(count));
            count += z_.line(u, v).size();
        }
    tile->first.push_back(static_cast<uint32_t>(count));
    UnionFind groups(count);
    for (int v = range.v_first; v < range.v_last; ++v)
        for (int u = range.u_first; u < range.u_last; ++u)
            for (int towards = 0; towards < 2; ++towards) {
                const int u2 = u + (towards == 0), v2 = v + (towards == 1);
                if (u2 >= range.u_last || v2 >= range.v_last) continue;
                const auto& line = z_.line(u, v);
                const auto& next = z_.line(u2, v2);
                for (size_t a = 0; a < line.size(); ++a)
                    for (size_t b = 0; b < next.size(); ++b)
                        if (hang_together(model_, u, v, towards, line[a], next[b]))
                            groups.join(
                                static_cast<uint32_t>(tile->first[line_index(range, u, v)] + a),
                                static_cast<uint32_t>(tile->first[line_index(range, u2, v2)] + b));
            }
    number_parts(*tile, range, groups);
    return tile;
}

void PieceWork::number_parts(Tile& tile, const LineRange& range, UnionFind& groups) const {
    std::vector<uint32_t> number(tile.first.back(), 0);
    uint32_t stretch = 0;
    for (int v = range.v_first; v < range.v_last; ++v)
        for (int u = range.u_first; u < range.u_last; ++u)
            for (const Interval& matter : z_.line(u, v)) {
                const uint32_t root = groups.root(stretch);
                const ScanGrid& grid = model_.lines.grid;
                const Vec3 low = point_on_line(grid, 2, u, v, matter.lower);
                const Vec3 high = point_on_line(grid, 2, u, v, matter.upper);
                if (root == stretch) { // the first of its group
                    number[stretch] = static_cast<uint32_t>(tile.parts.size());
                    tile.parts.push_back({0.0, {}, 0.5 * (low + high)});
                }
                StockPiece& part = tile.parts[number[root]];
                part.volume += matter.length();
                part.box.extend(low);
                part.box.extend(high);
                tile.part.push_back(number[root]);
                ++stretch;
            }
}

/// Finds connections across the border to the next tile.
void PieceWork::link(int tu, int tv, int towards) {
    const int tu2 = tu + (towards == 0), tv2 = tv + (towards == 1);
    if (tu < 0 || tv < 0 || tu2 >= u_tiles_ || tv2 >= v_tiles_) return;
    const auto tile = std::make_shared<Tile>(*map_.tiles_[index(tu, tv)]);
    const Tile& next = *map_.tiles_[index(tu2, tv2)];
    const LineRange range = lines_of(tu, tv), beyond = lines_of(tu2, tv2);
    auto& links = tile->links[static_cast<size_t>(towards)];
    links.clear();
    const int count = towards == 0 ? range.v_last - range.v_first : range.u_last - range.u_first;
    for (int i = 0; i < count; ++i) {
        const int u = towards == 0 ? range.u_last - 1 : range.u_first + i;
        const int v = towards == 1 ? range.v_last - 1 : range.v_first + i;
        const int u2 = u + (towards == 0), v2 = v + (towards == 1);
        const auto& line = z_.line(u, v);
        const auto& other = z_.line(u2, v2);
        for (size_t a = 0; a < line.size(); ++a)
            for (size_t b = 0; b < other.size(); ++b)
                if (hang_together(model_, u, v, towards, line[a], other[b]))
                    links.emplace_back(tile->part[tile->first[line_index(range, u, v)] + a],
                                       next.part[next.first[line_index(beyond, u2, v2)] + b]);
    }
    std::sort(links.begin(), links.end());
    links.erase(std::unique(links.begin(), links.end()), links.end());
    map_.tiles_[index(tu, tv)] = tile;
}

void PieceWork::update_pieces() {
    const size_t count = index(0, v_tiles_);
    if (map_.tiles_.empty()) {
        map_.tiles_.resize(count);
        map_.changed_.assign(count, 1);
    }
    for (int tv = 0; tv < v_tiles_; ++tv)
        for (int tu = 0; tu < u_tiles_; ++tu)
            if (map_.changed_[index(tu, tv)]) map_.tiles_[index(tu, tv)] = tile_parts(tu, tv);
    const auto changed = [&](int tu, int tv) {
        return tu < u_tiles_ && tv < v_tiles_ && map_.changed_[index(tu, tv)] != 0;
    };
    for (int tv = 0; tv < v_tiles_; ++tv)
        for (int tu = 0; tu < u_tiles_; ++tu) {
            if (changed(tu, tv) || changed(tu + 1, tv)) link(tu, tv, 0);
            if (changed(tu, tv) || changed(tu, tv + 1)) link(tu, tv, 1);
        }
    std::fill(map_.changed_.begin(), map_.changed_.end(), uint8_t{0});
}

std::vector<StockPiece> PieceWork::put_together() {
    std::vector<uint32_t> first(1, 0);
    for (const auto& tile : map_.tiles_)
        first.push_back(first.back() + static_cast<uint32_t>(tile->parts.size()));
    UnionFind groups(first.back());
    for (int tv = 0; tv < v_tiles_; ++tv)
        for (int tu = 0; tu < u_tiles_; ++tu)
            for (size_t towards = 0; towards < 2; ++towards)
                for (const auto& [a, b] : map_.tiles_[index(tu, tv)]->links[towards])
                    groups.join(first[index(tu, tv)] + a,
                                first[index(tu + (towards == 0), tv + (towards == 1))] + b);
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
        const bool is_crumb =
            whole[i].volume < 8.0 * h * h * h || glm::length(whole[i].box.size()) < 4.0 * h;
        if (groups.root(i) == i && !is_crumb) order.push_back(i);
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
            changed_[static_cast<size_t>(tu + tv * u_tiles)] = 1;
}

std::vector<StockPiece> PieceMap::pieces(const CutModel& model) {
    PieceWork work(model, *this);
    work.update_pieces();
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

bool is_still_connected(const CutModel& model, const Aabb& box) {
    const ScanGrid& grid = model.lines.grid;
    const auto [u_first, u_last] = lines_within(grid, 0, box.min.x, box.max.x, 1);
    const auto [v_first, v_last] = lines_within(grid, 1, box.min.y, box.max.y, 1);
    if (u_first > u_last || v_first > v_last) return true;
    double low = -infinity, high = box.min.z;
    for (int v = v_first; v <= v_last; ++v)
        for (int u = u_first; u <= u_last; ++u) {
            const auto& line = family(model, 2).line(u, v);
            if (line.size() != 1) return false;
            low = std::max(low, line[0].lower);
            high = std::min(high, line[0].upper);
        }
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
