#include "core/distance/tiled_points.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <numeric>

#include "core/distance/point_tree.h"
#include "core/distance/rounding.h"

namespace core {

namespace {

constexpr uint32_t tile_lanes = PointTree::width;

std::vector<LineTile> tiles_of(const Dbm& dbm) {
    std::vector<LineTile> tiles;
    for (const ScanLines& family : dbm.families)
        for (int v = 0; v < family.v_count(); v += ScanLines::tile_side)
            for (int u = 0; u < family.u_count(); u += ScanLines::tile_side)
                tiles.push_back({family.axis(), u, v});
    return tiles;
}

std::vector<Vec3> points_of(const Dbm& dbm, const LineTile& tile) {
    const ScanLines& family = dbm.families[static_cast<size_t>(tile.axis)];
    std::vector<Vec3> points;
    const int u_end = std::min(tile.u + ScanLines::tile_side, family.u_count());
    const int v_end = std::min(tile.v + ScanLines::tile_side, family.v_count());
    for (int v = tile.v; v < v_end; ++v)
        for (int u = tile.u; u < u_end; ++u)
            for (const Interval& matter : family.line(u, v))
                for (const double along : {matter.lower, matter.upper})
                    points.push_back(point_on_line(dbm.grid, tile.axis, u, v, along));
    return points;
}

/// The bits of x and y, one by one in turn: neighbours in the plane stay neighbours.
uint64_t interleaved(uint32_t x, uint32_t y) {
    uint64_t bits = 0;
    for (uint32_t i = 0; i < 32; ++i)
        bits |= (static_cast<uint64_t>((x >> i) & 1U) << (2 * i))
                | (static_cast<uint64_t>((y >> i) & 1U) << (2 * i + 1));
    return bits;
}

Vec3 origin_of(const ScanGrid& grid, const LineTile& tile) {
    const int half = ScanLines::tile_side / 2;
    return point_on_line(grid, tile.axis, tile.u + half, tile.v + half, grid.centre[tile.axis]);
}

Aabb box_of(const PointTree::Node& node) {
    Aabb box;
    for (uint32_t left = node.used; left != 0; left &= left - 1) {
        const auto lane = static_cast<size_t>(std::countr_zero(left));
        const Vec3 centre =
            node.origin + Vec3(node.centre[0][lane], node.centre[1][lane], node.centre[2][lane]);
        const Vec3 half(node.half[0][lane], node.half[1][lane], node.half[2][lane]);
        box.extend({centre - half, centre + half});
    }
    return box;
}

/// The numbers of the tiles so that neighbours in the list are neighbours in the grid.
std::vector<uint32_t> in_order(const std::vector<LineTile>& tiles) {
    std::vector<uint32_t> order(tiles.size());
    std::iota(order.begin(), order.end(), uint32_t{0});
    const auto key = [&](uint32_t i) {
        return interleaved(static_cast<uint32_t>(tiles[i].u / ScanLines::tile_side),
                           static_cast<uint32_t>(tiles[i].v / ScanLines::tile_side));
    };
    std::sort(order.begin(), order.end(), [&](uint32_t i, uint32_t j) {
        if (tiles[i].axis != tiles[j].axis) return tiles[i].axis < tiles[j].axis;
        return key(i) < key(j);
    });
    return order;
}

} // namespace

/// Lays out the upper tree over tiles in the order given, eight to a node.
struct TiledPoints::Builder {
    const Dbm& dbm;
    const std::vector<LineTile> tiles = tiles_of(dbm);
    const std::vector<uint32_t> order = in_order(tiles);
    Layout layout{std::vector<Place>(tiles.size()), {}};
    std::vector<PointTree::Node> nodes{};

    /// Adds the node over some of the tiles, and all below it; returns its number.
    uint32_t add(std::span<const uint32_t> group, Place above) {
        const auto id = static_cast<uint32_t>(nodes.size());
        nodes.emplace_back();
        layout.above_node.push_back(above);
        size_t below = 1; // tiles that a child holds at most
        while (below * tile_lanes < group.size()) below *= tile_lanes;
        for (uint32_t lane = 0; lane * below < group.size(); ++lane) {
            const auto part =
                group.subspan(lane * below, std::min(below, group.size() - lane * below));
            const Place here = {id, lane};
            if (below == 1) layout.above_tile[part[0]] = here;
            const uint32_t child = below == 1 ? part[0] | PointTree::tile_flag : add(part, here);
            nodes[id].child[lane] = child;
        }
        nodes[id].origin = origin_of(dbm.grid, tiles[group[group.size() / 2]]);
        return id;
    }
};

Result<TiledPoints> TiledPoints::of(const Dbm& dbm) {
    FEELER_TRY([[maybe_unused]] const size_t count, checked_points(boundary_points(dbm)));
    Builder builder{dbm};
    builder.add(builder.order, {});
    TiledPoints body;
    body.lines_ = dbm;
    body.layout_ = std::make_shared<const Layout>(std::move(builder.layout));
    body.top_ = std::make_shared<PointTree>();
    body.top_->nodes = std::move(builder.nodes);
    body.tiles_.resize(builder.tiles.size());
    for (uint32_t tile = 0; tile < body.tiles_.size(); ++tile) {
        body.build_tile(tile, builder.tiles[tile]);
        body.refit_above(tile);
    }
    return body;
}

size_t TiledPoints::update(const Dbm& dbm) {
    assert(dbm.grid == lines_.grid);
    const std::vector<LineTile> ids = tiles_of(dbm);
    std::vector<uint32_t> changed;
    for (uint32_t tile = 0; tile < ids.size(); ++tile) {
        const auto& [axis, u, v] = ids[tile];
        const auto family = static_cast<size_t>(axis);
        if (!dbm.families[family].shares_tile(lines_.families[family], u, v))
            changed.push_back(tile);
    }
    lines_ = dbm;
    if (changed.empty()) return 0;
    if (top_.use_count() > 1) top_ = std::make_shared<PointTree>(*top_);
    for (const uint32_t tile : changed) {
        build_tile(tile, ids[tile]);
        refit_above(tile);
    }
    return changed.size();
}

void TiledPoints::build_tile(uint32_t tile, const LineTile& id) {
    const std::vector<Vec3> points = points_of(lines_, id);
    tiles_[tile] = points.empty()
                       ? nullptr
                       : std::make_shared<const PointTree>(point_tree(points, tile).value());
}

/// The boxes from a tile up to the root.
void TiledPoints::refit_above(uint32_t tile) {
    Place place = layout_->above_tile[tile];
    Aabb box = tiles_[tile] ? tiles_[tile]->box : Aabb();
    while (true) {
        PointTree::Node& node = top_->nodes[place.node];
        const uint32_t bit = 1U << place.lane;
        node.used = box.empty() ? node.used & ~bit : node.used | bit;
        if (!box.empty()) set_box(node, place.lane, turned_box(box, node.origin));
        box = box_of(node);
        if (place.node == 0) break;
        place = layout_->above_node[place.node];
    }
    top_->box = box;
}

} // namespace core
