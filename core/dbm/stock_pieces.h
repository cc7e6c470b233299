#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/vec.h"

namespace core {

struct CutModel;

/// A connected piece of the stock, as far as the scan lines show.
struct StockPiece {
    double volume = 0.0;       // mm3
    Aabb box;                  // around its lines along Z
    Vec3 position = Vec3(0.0); // one of its points
};

/// Connectivity of the material of a model, tile by tile of its lines along Z. A plain value;
/// copies share what neither has changed since.
class PieceMap {
public:
    /// Records that material in a box may have been removed.
    void note_cut(const CutModel& model, const Aabb& box);

    /// Whether the cuts recorded since the last call of this or of pieces() can have separated
    /// anything but crumbs: false if everything in the tiles around them is still connected there.
    ///
    /// Cost:    some 10 us for each tile cut since.
    bool may_have_separated(const CutModel& model);

    /// The pieces, the largest first. Crumbs shorter than four mesh sizes or smaller than eight
    /// cells do not count: the lines are too far apart for them.
    ///
    /// Result:  two segments of neighbouring lines along Z are connected if a line across them has
    ///          material from one to the other; where no line runs between them, if they overlap.
    /// Cost:    some 10 us for each tile cut since the last call, and 0.1 us for each tile.
    std::vector<StockPiece> pieces(const CutModel& model);

    /// The segments of lines along Z that make up piece `number` of the last call to pieces(),
    /// which no other call may follow.
    std::vector<std::pair<Vec3, Vec3>> stretches(const CutModel& model, size_t number) const;

private:
    struct Tile;
    using Links = std::vector<std::pair<uint32_t, uint32_t>>;
    friend class PieceWork;

    std::vector<std::shared_ptr<const Tile>> tiles_;
    std::array<std::vector<std::shared_ptr<const Links>>, 2> links_; // to the next tile along X, Y
    std::vector<uint8_t> changed_;
    std::vector<uint32_t> changed_tiles_; // in the order in which they were recorded
    std::vector<uint32_t> piece_of_;      // for each part of each tile; none for crumbs
};

/// Whether a cut within `box` cannot have separated anything: below it and below everything cut
/// there before, lines along X and Y show one layer of material over the whole box and one mesh
/// size around it, and all lines along Z end on that layer.
///
/// Cost:    some microseconds. False proves nothing.
bool is_still_connected(const CutModel& model, const Aabb& box);

/// Whether the material on the lines along Z within `box` and one line around it is connected
/// there, as PieceMap::pieces() says. If all of the stock was connected before a cut within the
/// box, it still is: a connection that led through the box enters and leaves this range on lines
/// that the cut has not reached.
///
/// Cost:    some 20 ns for each line.
bool hangs_together_within(const CutModel& model, const Aabb& box);

} // namespace core
