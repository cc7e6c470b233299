#pragma once

#include <memory>
#include <vector>

#include "core/base/vec.h"

namespace core {

struct CutModel;

/// A stock's matter that hangs together, as far as the scan lines show.
struct StockPiece {
    double volume = 0.0;    // mm3
    Aabb box;               // round its lines along Z
    Vec3 place = Vec3(0.0); // a point of it
};

/// What is known about how the matter of a model hangs together, tile by tile of its lines along Z.
/// A plain value; copies share what neither has changed since.
class PieceMap {
public:
    /// Notes that matter in a box may have gone.
    void note_cut(const CutModel& model, const Aabb& box);

    /// The pieces, the largest first. Crumbs, shorter than four mesh sizes across or smaller than
    /// eight cells, do not count: the lines are too far apart for them.
    ///
    /// Result: two stretches of neighbouring lines along Z hang together where a line across them
    ///         has matter from one to the other; where none runs between, if they overlap.
    /// Cost:   some 40 us for each tile that was cut since the last call, and a little for all.
    std::vector<StockPiece> pieces(const CutModel& model);

    /// The stretches of lines along Z that make up piece `number` of the last call to pieces().
    std::vector<std::pair<Vec3, Vec3>> stretches(const CutModel& model, size_t number) const;

private:
    struct Tile;
    friend class PieceWork;

    std::vector<std::shared_ptr<const Tile>> tiles_;
    std::vector<uint8_t> changed_;
    std::vector<uint32_t> piece_of_; // of each part of each tile; none for crumbs
};

/// Whether a cut within `box` can have parted nothing: below it and below all that was cut there
/// before, lines along X and Y show one layer of matter all over the box and one mesh size round
/// it, and all lines along Z stand on that.
/// Cost: some microseconds; false says nothing.
bool cannot_have_parted(const CutModel& model, const Aabb& box);

} // namespace core
