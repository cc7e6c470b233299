#include "core/dbm/scan_grid.h"

#include <cassert>

namespace core {

ScanGrid scan_grid(const Aabb& bounds, double spacing) {
    assert(spacing > 0.0 && !bounds.empty());
    ScanGrid grid{.centre = bounds.center(), .spacing = spacing, .half_count = {}};
    for (int axis = 0; axis < 3; ++axis) {
        // Line k on one side stands at (k + 0.5) h; a line on the border itself would meet nothing.
        const double half_cells = 0.5 * bounds.size()[axis] / spacing;
        grid.half_count[static_cast<size_t>(axis)] =
            std::max(1, static_cast<int>(std::ceil(half_cells - 0.5)));
    }
    return grid;
}

} // namespace core
