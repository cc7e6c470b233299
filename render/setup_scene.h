#pragma once

#include <map>
#include <memory>
#include <vector>

#include "core/motion/kinematics.h"
#include "core/sim/setup.h"
#include "render/scene.h"

namespace render {

/// The meshes of the bodies of a set-up, made once; poses are computed for each position of the
/// axes.
struct SetupMeshes {
    std::vector<SharedMesh> fixtures; // as in Setup::fixtures
    std::vector<SharedMesh> machine;  // as in Machine::bodies
    SharedMesh raw_stock;
    SharedMesh part; // null: the set-up has none
};

SetupMeshes setup_meshes(const core::Setup& setup);

/// Makes the same meshes for a window, in which a set-up follows another: large ones are made once
/// and have a rough version for a view that turns.
class SurfaceMaker {
public:
    /// Cost: 0.8 s for a new mesh of a million triangles.
    SetupMeshes meshes_of(const core::Setup& setup);

private:
    SharedMesh surface_of(const core::ExactBody& body);

    std::map<std::shared_ptr<const core::Mesh>, SharedMesh> made_, now_; // by the body's mesh
};

/// The meshes of the parts of a tool, from the flutes up.
std::vector<SharedMesh> tool_meshes(const core::ToolAssembly& tool);

/// The pose of a mounted body relative to the stock.
core::Transform stock_from_mount(const core::Setup& setup, const core::Mount& mount,
                                 const core::AxisValues& values);

/// The mounted fixtures and the machine bodies on both sides. `is_there` states which fixtures are
/// mounted; empty: as at the start of the program.
std::vector<Body> setup_bodies(const core::Setup& setup, const SetupMeshes& meshes,
                               const core::AxisValues& values,
                               const std::vector<bool>& is_there = {});

/// The parts of a tool in the spindle. The meshes are from tool_meshes().
std::vector<Body> tool_bodies(const core::Setup& setup, const core::ToolAssembly& tool,
                              const std::vector<SharedMesh>& meshes,
                              const core::AxisValues& values);

/// The pose of the tool tip relative to the stock. Frame of the tip: Z along the tool, up to the
/// spindle; all axes along those of the machine while its rotary axes are at 0.
core::Transform stock_from_tip(const core::Setup& setup, double tool_length,
                               const core::AxisValues& values);

/// The position of the tool tip. Frame: the stock's.
core::Vec3 tip_in_stock(const core::Setup& setup, double tool_length,
                        const core::AxisValues& values);

/// Whether a fixture is a clamp, by its name: clamps have their own colour.
bool is_clamp(const std::string& name);

/// Whether a fixture is a vise or a chuck, by its name.
bool is_vise(const std::string& name);

} // namespace render
