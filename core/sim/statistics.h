#pragma once

#include <cstddef>

namespace core {

/// What a check has cost so far.
struct Statistics {
    size_t box_tests = 0;   // pairs of boxes compared
    size_t shape_tests = 0; // exact distances of convex shapes or of a shape and a mesh
    size_t refined = 0;     // squares of the stock worked out afresh at a finer mesh size
    size_t sweeps = 0;      // cuts carried out
};

} // namespace core
