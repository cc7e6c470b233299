#pragma once

#include "tests/support/true_part.h"

namespace test_support {

inline Real box_to_box(const TrueBox& a, const TrueBox& b, const RealPose& a_from_b) {
    const auto of_a = corners(a, {}), of_b = corners(b, a_from_b);
    std::array<RealVec, 8> a_in_b;
    for (size_t i = 0; i < 8; ++i) a_in_b[i] = a_from_b.back(of_a[i]);
    Real least = real_infinity;
    // Two boxes intersect only if an edge of one has a point in the other.
    for (const auto& [i, j] : box_edges)
        if (meets(a, of_b[i], of_b[j]) || meets(b, a_in_b[i], a_in_b[j])) return 0;
    for (size_t i = 0; i < 8; ++i)
        least = std::min({least, point_to(a, of_b[i]), point_to(b, a_in_b[i])});
    for (const auto& [i, j] : box_edges)
        for (const auto& [k, l] : box_edges)
            least = std::min(least, segment_to_segment(of_a[i], of_a[j], of_b[k], of_b[l]));
    return least;
}

/// Whether distance() supports the pair: at least one is a capsule, or both are boxes; a torus
/// needs a ball.
inline bool is_known(const TruePart& a, const TruePart& b) {
    if (std::holds_alternative<TrueBox>(a) && std::holds_alternative<TrueBox>(b)) return true;
    const auto* capsule = std::get_if<TrueCapsule>(&a);
    const TruePart& other = capsule ? b : a;
    if (!capsule) capsule = std::get_if<TrueCapsule>(&b);
    return capsule && (!std::holds_alternative<TrueTorus>(other) || capsule->a == capsule->b);
}

/// The distance of a capsule to a part in another frame, which has the pose `pose`.
inline Real distance(const TrueCapsule& c, const TruePart& part, const RealPose& pose) {
    const RealVec a = pose.back(c.a), b = pose.back(c.b);
    Real apart = 0;
    if (const auto* torus = std::get_if<TrueTorus>(&part)) apart = point_to(*torus, a);
    if (const auto* box = std::get_if<TrueBox>(&part)) apart = segment_to(*box, a, b);
    if (const auto* cylinder = std::get_if<TrueCylinder>(&part))
        apart = segment_to(*cylinder, a, b);
    if (const auto* other = std::get_if<TrueCapsule>(&part)) apart = segment_to(*other, a, b);
    return std::max<Real>(0, apart - c.radius);
}

inline Real distance(const TruePart& a, const TruePart& b, const RealPose& a_from_b) {
    if (const auto* capsule = std::get_if<TrueCapsule>(&a)) return distance(*capsule, b, a_from_b);
    if (const auto* capsule = std::get_if<TrueCapsule>(&b))
        return distance({a_from_b * capsule->a, a_from_b * capsule->b, capsule->radius}, a, {});
    return box_to_box(std::get<TrueBox>(a), std::get<TrueBox>(b), a_from_b);
}

} // namespace test_support
