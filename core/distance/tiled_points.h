#pragma once

#include <memory>
#include <vector>

#include "core/dbm/dbm.h"
#include "core/distance/point_tree.h"

namespace core {

/// A tile of scan lines: its family and its first line.
struct LineTile {
    int axis = 0, u = 0, v = 0;
};

/// The points of a body that is being cut: a tree to each tile of its scan lines, and above them a
/// tree whose shape is that of the grid and never changes.
///
/// A copy is a snapshot: it shares every tile's tree that neither side has changed since, and costs
/// a pointer per tile.
class TiledPoints {
public:
    /// Errors: no point; a coordinate that is not finite or beyond 1e12 mm.
    static Result<TiledPoints> of(const Dbm& dbm);

    /// Takes over the lines as they are now, and returns how many tiles were rebuilt: those that
    /// the grid does not share any more with the lines taken before.
    ///
    /// Cost: rebuilding these tiles and what is above them; a pointer comparison for all others.
    /// The lines must be of the same grid.
    size_t update(const Dbm& dbm);

    PointTreeView view() const { return {top_.get(), tiles_}; }
    bool empty() const { return top_->nodes[0].used == 0; }

private:
    struct Place {
        uint32_t node = 0;
        uint32_t lane = 0;
    };
    /// The shape of the upper tree.
    struct Layout {
        std::vector<Place> above_tile; // by tile
        std::vector<Place> above_node; // by node; the root's is its own
    };

    struct Builder;

    void build_tile(uint32_t tile, const LineTile& id);
    void refit_above(uint32_t tile);

    Dbm lines_;
    std::shared_ptr<const Layout> layout_;
    std::shared_ptr<PointTree> top_;
    std::vector<std::shared_ptr<const PointTree>> tiles_; // null: no points
};

} // namespace core
