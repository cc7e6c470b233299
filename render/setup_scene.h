#pragma once

#include "core/motion/kinematics.h"
#include "core/sim/setup.h"
#include "render/scene.h"

namespace render {

/// The bodies of a set-up with their meshes, made once; where they stand is worked out for each
/// place of the axes.
struct SetupMeshes {
    std::vector<SharedMesh> fixtures; // as in Setup::fixtures
    std::vector<SharedMesh> machine;  // as in Machine::bodies
    SharedMesh raw_stock;
    SharedMesh part; // null: the set-up has none
};

SetupMeshes setup_meshes(const core::Setup& setup);

/// The meshes of a tool's parts, from the flutes up.
std::vector<SharedMesh> tool_meshes(const core::ToolAssembly& tool);

/// Where a mounted body stands, seen from the stock.
core::Transform stock_from_mount(const core::Setup& setup, const core::Mount& mount,
                                 const core::AxisValues& values);

/// Fixtures that are there, and the bodies of the machine, on either side. `is_there` says of each
/// fixture whether it is there now; empty: as at the first block.
std::vector<Body> setup_bodies(const core::Setup& setup, const SetupMeshes& meshes,
                               const core::AxisValues& values,
                               const std::vector<bool>& is_there = {});

/// The parts of a tool in the spindle. The meshes are those of tool_meshes().
std::vector<Body> tool_bodies(const core::Setup& setup, const core::ToolAssembly& tool,
                              const std::vector<SharedMesh>& meshes,
                              const core::AxisValues& values);

/// Where the tip of the tool stands, seen from the stock.
core::Vec3 tip_in_stock(const core::Setup& setup, double tool_length,
                        const core::AxisValues& values);

/// Whether a fixture is a clamp by its name: clamps have a colour of their own.
bool is_clamp(const std::string& name);

} // namespace render
