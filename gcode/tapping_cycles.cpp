#include "gcode/cycles.h"

namespace gcode {
namespace {

using core::SpindleDirection;

/// Down to a level and out to R, the spindle reversed at the level.
void thread_to(Drilling& hole, double level, SpindleDirection in, SpindleDirection out) {
    hole.feed(level);
    if (level == hole.bottom) hole.dwell();
    hole.turn(out);
    hole.feed(hole.r);
    hole.turn(in);
}

} // namespace

void tap(Drilling& hole) {
    const bool left = hole.cycle.code == tenths(74);
    const SpindleDirection in =
        left ? SpindleDirection::counterclockwise : SpindleDirection::clockwise;
    const SpindleDirection out =
        left ? SpindleDirection::clockwise : SpindleDirection::counterclockwise;
    const SpindleDirection before = hole.execution.modal().spindle;
    if (before != in) hole.turn(in);
    if (const std::optional<double> step = hole.cycle.peck)
        for (double level = hole.r - *step; level > hole.bottom; level -= *step)
            thread_to(hole, level, in, out);
    thread_to(hole, hole.bottom, in, out);
    if (before != in) hole.turn(before);
    if (hole.clear != hole.r) hole.traverse(hole.clear);
}

} // namespace gcode
