#pragma once

#include <memory>
#include <variant>

#include "core/dbm/dbm.h"
#include "core/geom/mesh.h"

namespace core {

/// A box along the axes of the stock's frame.
struct SolidBox {
    Aabb box;
};

/// A cylinder that stands on `base` and reaches `height` along +axis.
struct SolidCylinder {
    Vec3 base = Vec3(0.0);
    double radius = 0.0;
    double height = 0.0;
    int axis = 2;
};

/// Whether the point lies inside the mesh; either answer for a point on its surface.
bool holds(const SolidMesh& solid, const Vec3& point);

/// A stock before anything is cut from it.
struct Solid {
    std::variant<SolidBox, SolidCylinder, SolidMesh> shape;
    double tolerance = 0.0; // the real stock may reach this much farther all round, mm
};

/// A square of the XY plane, closed.
struct Square {
    double x0, x1, y0, y1;
};

/// The box of the nominal solid, without its tolerance.
Aabb bounds(const Solid& solid);

/// What a line meets of the nominal solid.
IntervalList line_of(const Solid& solid, int axis, double u, double v);

/// Heights outside of which the solid, tolerance included, has no point above the square.
///
/// Proof for a mesh: slide a point of the solid sideways within the square to a corner. Either it
/// stays inside, then the corner's line holds its height; or it crosses a triangle, then the range
/// of heights of that triangle within the square does.
IntervalList column_of(const Solid& solid, const Square& square);

/// The scan lines of the nominal solid.
Result<Dbm> scan(const Solid& solid, double spacing, double memory_limit = default_memory_limit);

} // namespace core
