#pragma once

#include "core/motion/path.h"
#include "core/sim/setup.h"
#include "render/tool_path.h"

namespace render {

/// The attributes of the pieces of a motion.
struct MotionStyle {
    uint32_t block = 0;
    ClearanceState state = ClearanceState::none;
    bool rapid = false;
};

/// Adds the path of the tool tip over a motion. Frame: the stock's.
///
/// Shape:   one piece for each straight leg, so dog-legs and chords of arcs are drawn; pieces of at
///          most 3 degrees where legs rotate. For a leg with an unknown path, only its certain
///          positions are connected. A new path begins where a motion does not start at the end of
///          the last one.
void append_motion(std::vector<PathPoint>& points, const core::Setup& setup, double tool_length,
                   const core::Path& path, const MotionStyle& style);

} // namespace render
