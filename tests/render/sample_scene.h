#pragma once

#include "core/dbm/cut_model.h"
#include "core/sim/setup.h"
#include "render/scene.h"

namespace render {

/// The complete surface of a model.
StockBricks stock_bricks(const core::CutModel& model);

/// A flat cutter with a sharp corner, and a ball.
std::shared_ptr<const core::Cutter> flat_cutter(double radius);
std::shared_ptr<const core::Cutter> ball_cutter(double radius);

/// A block in a vice with a clamp on it, on a table with slots, as a set-up has it.
core::Setup sample_setup();

/// An end mill of 16 mm in a holder with two collars.
core::ToolAssembly sample_tool();

/// The moves of a pocket, two holes and a scalloped flank; `path` gets the points of the tip.
std::vector<core::CutterSweep> sample_moves(std::vector<PathPoint>& path);

/// All of it: the stock cut, the tool near the clamp, the path in the colours of its clearance.
Scene sample_scene(double spacing = 0.5);

} // namespace render
