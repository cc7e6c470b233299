#include "render/scene.h"

namespace render {
namespace {

core::Aabb stock_bounds(const Scene& scene) {
    core::Aabb box;
    if (scene.stock_visible)
        for (const auto& brick : scene.stock) box.extend(brick->mesh.bounds);
    return box;
}

bool holds_work(BodyRole role) {
    return role == BodyRole::fixture || role == BodyRole::vise || role == BodyRole::clamp
           || role == BodyRole::stock || role == BodyRole::part;
}

} // namespace

Role color_role(BodyRole role) {
    switch (role) {
    case BodyRole::fixture:
        return Role::fixture;
    case BodyRole::vise:
        return Role::vise;
    case BodyRole::clamp:
        return Role::clamp;
    case BodyRole::machine:
        return Role::machine;
    case BodyRole::flutes:
        return Role::flutes;
    case BodyRole::shank:
        return Role::shank;
    case BodyRole::holder:
        return Role::holder;
    case BodyRole::nose:
        return Role::nose;
    case BodyRole::stock:
        return Role::stock_raw;
    case BodyRole::part:
        return Role::part;
    }
    return Role::fixture;
}

Role color_role(PairSide side) {
    return side == PairSide::tool ? Role::pair_tool : Role::pair_body;
}

double usual_alpha(BodyRole role) {
    if (role == BodyRole::holder || role == BodyRole::nose) return 0.55;
    return role == BodyRole::part ? 0.4 : 1.0;
}

bool is_cut_by_section(const Scene& scene, BodyRole role) {
    if (!scene.section || role == BodyRole::machine) return false;
    return scene.section_cuts_tool || !is_of_tool(role);
}

core::Aabb bounds(const Body& body) {
    core::Aabb box;
    if (!body.mesh || body.mesh->bounds.empty()) return box;
    const core::Aabb& own = body.mesh->bounds;
    for (int corner = 0; corner < 8; ++corner)
        box.extend(body.stock_from_body
                   * core::Vec3((corner & 1) != 0 ? own.max.x : own.min.x,
                                (corner & 2) != 0 ? own.max.y : own.min.y,
                                (corner & 4) != 0 ? own.max.z : own.min.z));
    return box;
}

core::Aabb bounds(const Scene& scene) {
    core::Aabb box = stock_bounds(scene);
    for (const auto* bodies : {&scene.bodies, &scene.ghost})
        for (const Body& body : *bodies)
            if (body.visible) box.extend(bounds(body));
    if (scene.path && scene.path_visible) box.extend(scene.path->bounds);
    if (scene.witness) {
        box.extend(scene.witness->a);
        box.extend(scene.witness->b);
    }
    for (const core::Vec3& point : scene.measured) box.extend(point);
    return box;
}

core::Aabb work_bounds(const Scene& scene) {
    core::Aabb box = stock_bounds(scene);
    for (const Body& body : scene.bodies)
        if (body.visible && holds_work(body.role)) box.extend(bounds(body));
    if (box.empty() && scene.path && scene.path_visible) box = scene.path->bounds;
    return box.empty() ? bounds(scene) : box;
}

bool is_of_tool(BodyRole role) {
    return role == BodyRole::flutes || role == BodyRole::shank || role == BodyRole::holder
           || role == BodyRole::nose;
}

} // namespace render
