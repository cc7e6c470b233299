#pragma once

#include <vector>

#include "core/dbm/cut_model.h"

namespace test_support {

/// A stock and the moves that finish a surface on it row by row.
struct RasterProgram {
    core::Aabb stock;
    core::Vec3 start;                  // tip before the first move
    std::vector<core::Vec3> positions; // end point of each block
};

/// z = -5 + 3 sin(2 pi x / 25) cos(2 pi y / 25), the surface to be finished.
double raster_surface(double x, double y);

/// The height of a ball's tip over (x, y) at which it touches the surface without gouging.
double raster_tip(double x, double y, double ball_radius);

/// The raster finishing program for a 6 mm ball: block 100 x 100 x 30 with its top at Z 0, rows
/// `stepover` apart along Y, points `spacing` apart along X, back and forth; two blocks down to the
/// first point, three up and back from the last. With 0.4 and 0.25 it has 100,004 blocks.
RasterProgram raster_program(double stepover = 0.4, double spacing = 0.25);

/// The ball end mill of the program, with flutes 30 mm long.
core::RevolvedProfile raster_ball();

/// One sweep for each block, numbered from 0.
std::vector<core::CutterSweep> sweeps_of(const RasterProgram& program,
                                         const core::RevolvedProfile& flutes,
                                         double path_error = 0.0);

} // namespace test_support
