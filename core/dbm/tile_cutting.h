#pragma once

#include "core/dbm/cut_model.h"
#include "core/dbm/lane_cut.h"

namespace core {

/// What was removed from one family, before it is made a volume.
struct LineSums {
    double length = 0.0; // mm of lines
    double points = 0.0; // grid points, counted by the lines along Z

    void add(const LineSums& b) {
        length += b.length;
        points += b.points;
    }
};

/// A sweep ready for cutting: where it can remove anything, and the mark for the ends it makes.
struct ReadySweep {
    const CutterSweep* sweep = nullptr;
    Aabb front;
    uint32_t mark = 0;
};

/// The tiles of a family that a range of lines touches: first .. last - 1 in both directions.
LineRange tiles_of(const LineRange& lines);

/// The lines of a family whose places lie in the box, the cells that meet it.
LineRange lines_in(const CutModel& model, int axis, const Aabb& box);
LineRange cells_in(const CutModel& model, const Aabb& box);

/// Takes a convex piece out of those lines of one tile that are in the range.
LineSums cut_lines(CutModel& model, size_t tile, const LineRange& range, const LanePlan& plan,
                   const ReadySweep& ready);

/// Takes a convex piece out of those columns of one tile that are in the range.
void cut_columns(CutModel& model, size_t tile, const LineRange& range, const LanePlan& plan,
                 const ReadySweep& ready);

} // namespace core
