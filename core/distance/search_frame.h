#pragma once

#include <array>

#include "core/base/transform.h"

namespace core {

/// Three directions at right angles, in which a search compares its boxes, seen from both bodies.
struct SearchFrame {
    std::array<Vec3, 3> in_a{}, in_b{};
    Vec3 origin = Vec3(0.0); // in the frame of A
    Vec3 sweep = Vec3(0.0);  // B's, along the directions
};

/// The frame whose first direction is `across` and whose second lies near `along`; for a moving
/// body as near as possible to its way. Neither needs unit length.
SearchFrame search_frame(const Vec3& across, const Vec3& along, const Vec3& origin,
                         const Transform& a_from_b, const Vec3& sweep);

} // namespace core
