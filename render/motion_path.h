#pragma once

#include "core/motion/path.h"
#include "core/sim/setup.h"
#include "render/tool_path.h"

namespace render {

/// What is said of the pieces of a motion.
struct MotionStyle {
    uint32_t block = 0;
    ClearanceState state = ClearanceState::none;
    bool rapid = false;
};

/// Adds the way of the tool's tip over a motion, as the stock sees it.
///
/// Shape: a piece for each straight leg, so that dog-legs and chords of arcs are drawn; where the
///        legs turn, pieces of at most 3 degrees. Of a leg whose way nobody knows only the places
///        that are certain. The path begins anew where a motion does not start where the last one
///        ended.
void append_motion(std::vector<PathPoint>& points, const core::Setup& setup, double tool_length,
                   const core::Path& path, const MotionStyle& look);

} // namespace render
