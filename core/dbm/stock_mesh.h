#pragma once

#include <optional>
#include <vector>

#include "core/geom/mesh.h"

namespace core {

struct CutModel;

/// A place where a scan line passes the surface of a stock.
struct SurfaceSample {
    Vec3 place = Vec3(0.0);
    std::optional<uint32_t> sweep; // what made it, by its number in the log; empty: raw stock
};

/// The surface of a model as triangles.
struct StockMesh {
    Mesh mesh;
    std::vector<SurfaceSample> samples; // sample k lies beside triangles 2 k and 2 k + 1
    double error = 0.0; // mm: every boundary point of the model that is not lost is this near to it
    size_t lost = 0;    // boundary points on details thinner than the mesh size, not in the surface
};

/// The surface of what is left of a stock.
///
/// Shape:  closed: every edge is passed as often one way as the other; triangles face outwards. Two
///         for each place where a scan line passes the surface. Edges and corners of the stock
///         are kept: there is a vertex where the tangent planes meet. Between the lines, a mesh
///         size apart, the surface is what these planes say; what is thinner may be missing.
/// Result: without triangles when nothing is left. The same bits whenever the model is the same.
/// Cost:   memory for the result and for two layers of cells.
/// Source: dual contouring (Ju et al. 2002), with a vertex for each piece of the surface in a cell
///         (Nielson: Dual marching cubes, 2004).
StockMesh stock_mesh(const CutModel& model);

} // namespace core
