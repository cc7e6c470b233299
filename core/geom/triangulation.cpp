#include <algorithm>
#include <numeric>
#include <span>

#include <fmt/format.h>

#include "core/geom/orientation.h"
#include "core/geom/polygon_soup.h"

namespace core {
namespace {

/// Cuts the ears off one outline, seen along its normal.
class EarCutter {
public:
    EarCutter(const std::vector<Vec3>& vertices, std::span<const uint32_t> face) : face_(face) {
        Vec3 normal(0.0);
        for (size_t i = 0; i < face.size(); ++i)
            normal += glm::cross(vertices[face[i]] - vertices[face[0]],
                                 vertices[face[(i + 1) % face.size()]] - vertices[face[0]]);
        const Vec3 size = glm::abs(normal);
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (const uint32_t i : face)
            flat_.push_back(normal[axis] < 0.0 ? Vec2(vertices[i][v], vertices[i][u])
                                               : Vec2(vertices[i][u], vertices[i][v]));
        rest_.resize(face.size());
        std::iota(rest_.begin(), rest_.end(), size_t{0});
    }

    /// Adds the triangles; false if at some point no corner can be cut off.
    bool cut_into(std::vector<Mesh::Corners>& triangles) {
        while (rest_.size() > 3) {
            size_t ear = 0;
            while (ear < rest_.size() && !is_ear(ear)) ++ear;
            if (ear == rest_.size()) return false;
            add_ear(ear, triangles);
            rest_.erase(rest_.begin() + static_cast<std::ptrdiff_t>(ear));
        }
        add_ear(1, triangles);
        return true;
    }

private:
    size_t before(size_t i) const { return rest_[(i + rest_.size() - 1) % rest_.size()]; }
    size_t after(size_t i) const { return rest_[(i + 1) % rest_.size()]; }

    bool is_ear(size_t i) const {
        const Vec2 &a = flat_[before(i)], &b = flat_[rest_[i]], &c = flat_[after(i)];
        const double area = orientation(a, b, c);
        if (area < 0.0) return false;
        return std::none_of(rest_.begin(), rest_.end(), [&](size_t other) {
            const Vec2& p = flat_[other];
            if (p == a || p == b || p == c) return false;
            return orientation(a, b, p) >= 0.0 && orientation(b, c, p) >= 0.0
                   && orientation(c, a, p) >= 0.0;
        });
    }

    void add_ear(size_t i, std::vector<Mesh::Corners>& triangles) const {
        triangles.push_back({face_[before(i)], face_[rest_[i]], face_[after(i)]});
    }

    std::span<const uint32_t> face_;
    std::vector<Vec2> flat_;
    std::vector<size_t> rest_; // corners not cut off yet
};

} // namespace

Result<Mesh> triangulated(PolygonSoup soup) {
    constexpr size_t most_corners = 4096; // cutting takes up to the cube of it
    Mesh mesh;
    mesh.vertices = std::move(soup.vertices);
    mesh.triangles.reserve(soup.faces.size());
    for (size_t i = 0; i < soup.faces.size(); ++i) {
        const auto& face = soup.faces[i];
        if (face.size() == 3) {
            mesh.triangles.push_back({face[0], face[1], face[2]});
            continue;
        }
        if (face.size() > most_corners)
            return fail(ErrorCode::unsupported, fmt::format("face {} has {} corners, more than {}",
                                                            i + 1, face.size(), most_corners));
        if (!EarCutter(mesh.vertices, face).cut_into(mesh.triangles))
            return fail(ErrorCode::invalid_value,
                        fmt::format("the outline of face {} crosses itself", i + 1));
    }
    return mesh;
}

} // namespace core
