#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/vec.h"

namespace core {

struct Triangle {
    Vec3 a, b, c;

    Aabb bounds() const { return {glm::min(glm::min(a, b), c), glm::max(glm::max(a, b), c)}; }
};

/// A triangle mesh: corners shared between triangles, counter-clockwise seen from outside.
struct Mesh {
    using Corners = std::array<uint32_t, 3>;

    std::vector<Vec3> vertices; // mm
    std::vector<Corners> triangles;

    Triangle triangle(size_t i) const {
        const Corners& t = triangles[i];
        return {vertices[t[0]], vertices[t[1]], vertices[t[2]]};
    }
    Aabb bounds() const;
};

/// Volume enclosed by a closed mesh; negative when its triangles face inwards.
double signed_volume(const Mesh& mesh);

} // namespace core
