#pragma once

#include <memory>
#include <variant>

#include "core/dbm/dbm.h"
#include "core/geom/gjk.h"
#include "core/geom/mesh.h"

namespace core {

/// An axis-aligned box in the frame of the stock.
struct SolidBox {
    Aabb box;
};

/// A cylinder from `base` to `height` along +axis.
struct SolidCylinder {
    Vec3 base = Vec3(0.0);
    double radius = 0.0;
    double height = 0.0;
    int axis = 2;
};

/// Whether the point is inside the mesh; unspecified for a point on its surface.
bool holds(const SolidMesh& solid, const Vec3& point);

/// Raw stock.
struct Solid {
    std::variant<SolidBox, SolidCylinder, SolidMesh> shape;
    double tolerance = 0.0; // the real stock may be larger by this on all sides, mm
    Play play = {};         // the real stock may stand anywhere on this segment
    double deviation = 0.0; // of the mesh of a CAD file, mm: it may also be smaller by this
};

/// A closed square of the XY plane.
struct Square {
    double x0, x1, y0, y1;
};

/// The box of the nominal solid, without its tolerance and its play.
Aabb bounds(const Solid& solid);

/// A box that contains the real solid, with tolerance and play.
Aabb outer_bounds(const Solid& solid);

/// The intersection of a line with the nominal solid.
IntervalList line_of(const Solid& solid, int axis, double u, double v);

/// Heights that contain all of the solid above and below the square, tolerance and play included.
///
/// Proof for tolerance and play: a point of the displaced solid above the square is displaced from
/// a point of the nominal one above the square widened by the displacements, and by as much in
/// height. Proof for a mesh: move a point of the solid sideways within the square to a corner.
/// Either it stays inside, then the line at the corner contains its height; or it crosses a
/// triangle, then the range of heights of that triangle within the square does.
IntervalList column_of(const Solid& solid, const Square& square);

/// The scan lines of the nominal solid, on a grid that covers its play.
Result<Dbm> scan(const Solid& solid, double spacing, double memory_limit = default_memory_limit);

} // namespace core
