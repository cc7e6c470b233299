#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/plane_sum.h"

namespace render {

/// Whole numbers of a cell of a grid, 0 or more.
using CellKey = std::array<uint32_t, 3>;

/// A cell with corners of a mesh in it, and the planes of the triangles at these.
struct ClusterCell {
    CellKey key{};
    PlaneSum planes;
    core::Vec3 sum = core::Vec3(0.0); // of the corners
    size_t corners = 0;

    void add(const ClusterCell& other);
    /// The place that stands for all of its corners, in a cell of this width.
    core::Vec3 place(double width) const;
};

/// The cells that corners end up in.
struct Clusters {
    std::vector<core::Vec3> places;
    std::vector<uint32_t> of_leaf; // the place of each cell that was given
};

/// Joins cells by eight to larger ones, and these again, as long as one place stands for all of
/// their planes. `tolerance`: the most that PlaneSum::at may give there; `width`: of the cells
/// given.
///
/// Cost:   linear, but for sorting.
/// Source: Schaefer and Warren: Adaptive vertex clustering using octrees, 2003.
Clusters joined(const std::vector<ClusterCell>& leaves, double width, double tolerance);

} // namespace render
