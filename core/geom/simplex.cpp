#include "core/geom/simplex.h"

namespace core {
namespace {

/// Weights of the point of a face, edge or corner that is nearest to the origin; up to three used.
struct Nearest {
    std::array<int, 3> index{};
    std::array<double, 3> weight{};
    int count = 0;
    Vec3 point = Vec3(0.0);
};

Nearest corner(const Simplex& s, int i) {
    return {{i, 0, 0}, {1.0, 0.0, 0.0}, 1, s.vertices[static_cast<size_t>(i)].difference};
}

Nearest nearest_on_edge(const Simplex& s, int i, int j) {
    const Vec3 a = s.vertices[static_cast<size_t>(i)].difference;
    const Vec3 b = s.vertices[static_cast<size_t>(j)].difference;
    const Vec3 ab = b - a;
    const double along = -glm::dot(a, ab);
    const double length = glm::dot(ab, ab);
    if (along <= 0.0 || length == 0.0) return corner(s, i);
    if (along >= length) return corner(s, j);
    const double t = along / length;
    return {{i, j, 0}, {1.0 - t, t, 0.0}, 2, a + t * ab};
}

bool nearer(const Nearest& a, const Nearest& b) {
    return glm::dot(a.point, a.point) < glm::dot(b.point, b.point);
}

Nearest nearest_on_face(const Simplex& s, int i, int j, int k) {
    const Vec3 a = s.vertices[static_cast<size_t>(i)].difference;
    const Vec3 b = s.vertices[static_cast<size_t>(j)].difference;
    const Vec3 c = s.vertices[static_cast<size_t>(k)].difference;
    const Vec3 normal = glm::cross(b - a, c - a);
    const double area = glm::dot(normal, normal);
    // Barycentric coordinates of the origin's projection; all positive means it lies in the face.
    const double u = glm::dot(glm::cross(b, c), normal);
    const double v = glm::dot(glm::cross(c, a), normal);
    const double w = glm::dot(glm::cross(a, b), normal);
    if (area > 0.0 && u > 0.0 && v > 0.0 && w > 0.0) {
        const double sum = u + v + w;
        Nearest inside{{i, j, k}, {u / sum, v / sum, w / sum}, 3, {}};
        inside.point = inside.weight[0] * a + inside.weight[1] * b + inside.weight[2] * c;
        return inside;
    }
    Nearest best = nearest_on_edge(s, i, j);
    for (const Nearest& edge : {nearest_on_edge(s, j, k), nearest_on_edge(s, i, k)})
        if (nearer(edge, best)) best = edge;
    return best;
}

/// Whether the origin lies in the tetrahedron, borders included, never in a flat one; sets the
/// weights of the origin if it does.
bool hold_origin(Simplex& s) {
    const auto at = [&](size_t i) { return s.vertices[i].difference; };
    const auto volume = [](const Vec3& p, const Vec3& q, const Vec3& r) {
        return glm::dot(p, glm::cross(q, r));
    };
    const Vec3 edges[] = {at(1) - at(0), at(2) - at(0), at(3) - at(0)};
    const double all = volume(edges[0], edges[1], edges[2]);
    const double scale = glm::length(edges[0]) * glm::length(edges[1]) * glm::length(edges[2]);
    if (std::abs(all) <= 1e-12 * scale) return false;
    const double weights[] = {volume(at(1), at(2), at(3)) / all, volume(at(0), at(3), at(2)) / all,
                              volume(at(0), at(1), at(3)) / all, volume(at(0), at(2), at(1)) / all};
    for (const double weight : weights)
        if (!(weight >= 0.0)) return false;
    // Of a flat tetrahedron far away these are nothing but rounding. Only the point they stand for
    // proves anything.
    const double sum = weights[0] + weights[1] + weights[2] + weights[3];
    Vec3 point(0.0);
    double reach = 0.0;
    for (size_t i = 0; i < 4; ++i) {
        s.vertices[i].weight = weights[i] / sum;
        point += s.vertices[i].weight * at(i);
        reach = std::max(reach, glm::length(at(i)));
    }
    return glm::length(point) <= 1e-13 * reach;
}

Nearest nearest_on_tetrahedron(const Simplex& s) {
    Nearest best = nearest_on_face(s, 0, 1, 2);
    for (const Nearest& face :
         {nearest_on_face(s, 0, 1, 3), nearest_on_face(s, 0, 2, 3), nearest_on_face(s, 1, 2, 3)})
        if (nearer(face, best)) best = face;
    return best;
}

Nearest nearest_of(const Simplex& s) {
    switch (s.count) {
    case 1:
        return corner(s, 0);
    case 2:
        return nearest_on_edge(s, 0, 1);
    case 3:
        return nearest_on_face(s, 0, 1, 2);
    default:
        return nearest_on_tetrahedron(s);
    }
}

} // namespace

Vec3 reduce_to_nearest(Simplex& simplex) {
    if (simplex.count == 4 && hold_origin(simplex)) return Vec3(0.0);
    const Nearest nearest = nearest_of(simplex);
    Simplex kept;
    kept.count = nearest.count;
    for (size_t i = 0; i < static_cast<size_t>(nearest.count); ++i) {
        kept.vertices[i] = simplex.vertices[static_cast<size_t>(nearest.index[i])];
        kept.vertices[i].weight = nearest.weight[i];
    }
    simplex = kept;
    return nearest.point;
}

} // namespace core
