#include "render/setup_scene.h"

#include <algorithm>
#include <span>
#include <string_view>

#include "core/base/text.h"
#include "core/motion/machine.h"
#include "core/sim/moving_body.h"
#include "render/body_mesh.h"
#include "render/coarse_mesh.h"

namespace render {
namespace {

SharedMesh shared(TriangleMesh mesh) {
    return std::make_shared<const TriangleMesh>(std::move(mesh));
}

BodyRole role_of(core::PartKind kind) {
    switch (kind) {
    case core::PartKind::flutes:
        return BodyRole::flutes;
    case core::PartKind::shank:
        return BodyRole::shank;
    case core::PartKind::holder:
        return BodyRole::holder;
    case core::PartKind::nose:
        return BodyRole::nose;
    case core::PartKind::machine:
        break;
    }
    return BodyRole::machine;
}

Body make_body(std::string name, BodyRole role, SharedMesh mesh, const core::Transform& pose) {
    return {.name = std::move(name),
            .role = role,
            .mesh = std::move(mesh),
            .stock_from_body = pose,
            .alpha = usual_alpha(role)};
}

BodyRole fixture_role(const core::Fixture& fixture) {
    if (fixture.is_machine) return BodyRole::machine;
    if (is_clamp(fixture.name)) return BodyRole::clamp;
    return is_vise(fixture.name) ? BodyRole::vise : BodyRole::fixture;
}

bool has_word(const std::string& name, std::span<const std::string_view> words) {
    const std::string lower = core::lower_case(name);
    return std::any_of(words.begin(), words.end(), [&](std::string_view word) {
        return lower.find(word) != std::string::npos;
    });
}

} // namespace

bool is_clamp(const std::string& name) {
    constexpr std::string_view words[] = {"clamp", "strap"};
    return has_word(name, words);
}

bool is_vise(const std::string& name) {
    constexpr std::string_view words[] = {"vise", "vice", "jaw", "chuck"};
    return has_word(name, words);
}

SetupMeshes setup_meshes(const core::Setup& setup) {
    SetupMeshes meshes;
    for (const core::Fixture& fixture : setup.fixtures)
        meshes.fixtures.push_back(shared(mesh_of(fixture.body)));
    for (const core::MachineBody& body : setup.machine.bodies)
        meshes.machine.push_back(shared(mesh_of(body.body)));
    meshes.raw_stock = shared(mesh_of(setup.stock));
    if (setup.part) meshes.part = shared(mesh_of(core::ExactBody(setup.part->solid)));
    return meshes;
}

SharedMesh SurfaceMaker::surface_of(const core::ExactBody& body) {
    constexpr size_t many = 100'000, few = 40'000; // triangles
    const auto* solid = std::get_if<core::SolidMesh>(&body);
    if (!solid || solid->mesh->triangles.size() < many) return shared(mesh_of(body));
    if (const auto made = made_.find(solid->mesh); made != made_.end())
        return now_[solid->mesh] = made->second;
    TriangleMesh surface = mesh_of(body);
    const TriangleMesh* const part = &surface;
    surface.rough = shared(coarse(std::span(&part, 1), few));
    return now_[solid->mesh] = made_[solid->mesh] = shared(std::move(surface));
}

SetupMeshes SurfaceMaker::meshes_of(const core::Setup& setup) {
    now_.clear();
    SetupMeshes meshes;
    for (const core::Fixture& fixture : setup.fixtures)
        meshes.fixtures.push_back(surface_of(fixture.body));
    for (const core::MachineBody& body : setup.machine.bodies)
        meshes.machine.push_back(surface_of(body.body));
    meshes.raw_stock = shared(mesh_of(setup.stock));
    if (setup.part) meshes.part = surface_of(core::ExactBody(setup.part->solid));
    made_ = now_;
    return meshes;
}

std::vector<SharedMesh> tool_meshes(const core::ToolAssembly& tool) {
    std::vector<SharedMesh> meshes;
    for (const core::ToolPart& part : tool.parts) meshes.push_back(shared(mesh_of(part.profile)));
    return meshes;
}

core::Transform stock_from_mount(const core::Setup& setup, const core::Mount& mount,
                                 const core::AxisValues& values) {
    return core::target_from_mover(setup.machine, setup.stock_mount, mount, values);
}

std::vector<Body> setup_bodies(const core::Setup& setup, const SetupMeshes& meshes,
                               const core::AxisValues& values, const std::vector<bool>& is_there) {
    std::vector<Body> bodies;
    for (size_t i = 0; i < setup.fixtures.size(); ++i) {
        const core::Fixture& fixture = setup.fixtures[i];
        if (i < is_there.size() ? !is_there[i] : !fixture.is_there) continue;
        bodies.push_back(make_body(fixture.name, fixture_role(fixture), meshes.fixtures[i],
                                   stock_from_mount(setup, fixture.mount, values)));
    }
    for (const core::MovingBody& moving : core::moving_bodies(setup, {})) {
        if (moving.body == nullptr) continue;
        bodies.push_back(make_body(setup.machine.bodies[moving.carried].name, role_of(moving.kind),
                                   meshes.machine[moving.carried],
                                   stock_from_mount(setup, moving.mover.mount, values)));
    }
    return bodies;
}

std::vector<Body> tool_bodies(const core::Setup& setup, const core::ToolAssembly& tool,
                              const std::vector<SharedMesh>& meshes,
                              const core::AxisValues& values) {
    std::vector<Body> bodies;
    for (const core::MovingBody& moving : core::moving_bodies(setup, tool)) {
        if (moving.profile == nullptr) continue;
        bodies.push_back(make_body(core::name_of(moving.kind), role_of(moving.kind),
                                   meshes[bodies.size()],
                                   stock_from_mount(setup, moving.mover.mount, values)));
    }
    return bodies;
}

core::Transform stock_from_tip(const core::Setup& setup, double tool_length,
                               const core::AxisValues& values) {
    return stock_from_mount(
        setup, {setup.machine.spindle, core::translation({0.0, 0.0, -tool_length})}, values);
}

core::Vec3 tip_in_stock(const core::Setup& setup, double tool_length,
                        const core::AxisValues& values) {
    return stock_from_tip(setup, tool_length, values).translation;
}

} // namespace render
