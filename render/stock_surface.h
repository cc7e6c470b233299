#pragma once

#include "core/dbm/cut_model.h"
#include "render/brick_contour.h"
#include "render/stock_brick.h"

namespace render {

/// The surface of a stock for the eye, kept up to date while the stock is cut or goes back in time.
///
/// Shape:  that of core::stock_mesh, in bricks of 32 cells that meet without a gap.
/// Result: the same for the same model, whatever was shown before.
class StockSurface {
public:
    /// Shows another state of the stock; any one will do, but only what differs from the last one
    /// costs. Returns how many bricks were made anew.
    ///
    /// Cost: comparing tile pointers; for changed tiles the lines; for touched bricks their
    /// surface.
    size_t update(const core::CutModel& model);

    /// Forgets everything: the next update makes all bricks. For another program or set-up, whose
    /// moves have the same numbers.
    void reset();

    const StockBricks& bricks() const { return shown_; }

private:
    bool is_same_grid(const core::CutModel& model) const;
    void start(const core::CutModel& model);

    core::Dbm lines_; // as they were when the bricks were made
    bool started_ = false;
    std::array<int, 3> counts_{}; // bricks along X, Y, Z
    std::vector<BrickMemory> memory_;
    std::vector<std::shared_ptr<const StockBrick>> bricks_;
    StockBricks shown_;
    BrickWorkspace workspace_;
};

/// The surface of a model made at once.
StockBricks stock_bricks(const core::CutModel& model);

} // namespace render
