#pragma once

#include <array>

#include "core/base/vec.h"

namespace core {

/// Three directions at right angles, in which a search compares its boxes. Frame: that of A.
struct SearchFrame {
    std::array<Vec3, 3> directions{};
    Vec3 origin = Vec3(0.0);

    /// A vector along the directions.
    Vec3 along(const Vec3& v) const {
        return {glm::dot(directions[0], v), glm::dot(directions[1], v), glm::dot(directions[2], v)};
    }
};

/// The frame whose first direction is `across` and whose second lies near `along`; for a moving
/// body as near as possible to its way, `sweep`. None needs unit length.
SearchFrame search_frame(const Vec3& across, const Vec3& along, const Vec3& origin,
                         const Vec3& sweep);

} // namespace core
