#include "core/geom/profile.h"

namespace core {

Aabb bounds(const ProfileElement& element) {
    const double r = std::max(element.r0, element.r1) + element.margin;
    return {{-r, -r, element.z0 - element.margin}, {r, r, element.z1 + element.margin}};
}

Aabb bounds(const RevolvedProfile& profile) {
    Aabb box;
    for (const ProfileElement& element : profile.elements) box.extend(bounds(element));
    return box;
}

} // namespace core
