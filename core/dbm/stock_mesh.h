#pragma once

#include <optional>
#include <vector>

#include "core/geom/mesh.h"

namespace core {

struct CutModel;

/// A point where a scan line crosses the surface of a stock.
struct SurfaceSample {
    Vec3 position = Vec3(0.0);
    std::optional<uint32_t> sweep; // number in the log of the cut that made it; empty: raw stock
};

/// The surface of a model as triangles.
struct StockMesh {
    Mesh mesh;
    std::vector<SurfaceSample> samples; // sample k belongs to triangles 2 k and 2 k + 1
    double error =
        0.0; // mm: every boundary point of the model that is not lost is within this distance
    size_t lost =
        0; // boundary points on details thinner than the mesh size, missing in the surface
};

/// The surface of a stock.
///
/// Shape:   closed: every edge is used equally often in both directions; triangles face outwards.
///          Two triangles for each crossing of a scan line. Edges and corners of the stock are
///          kept: there is a vertex where the tangent planes meet. Between the lines the surface
///          follows these planes; details thinner than a mesh size may be missing.
/// Result:  no triangles if nothing is left. The same bits for the same model.
/// Cost:    memory for the result and for two layers of cells.
/// Source:  dual contouring (Ju et al. 2002), with a vertex for each piece of the surface in a cell
///          (Nielson: Dual marching cubes, 2004).
StockMesh stock_mesh(const CutModel& model);

} // namespace core
