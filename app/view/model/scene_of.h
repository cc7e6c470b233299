#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/view/model/block_row.h"
#include "app/view/model/settings.h"
#include "core/sim/setup.h"
#include "render/scene.h"
#include "render/setup_scene.h"

namespace app::viewer {

struct ViewModel;

/// A set-up with its meshes, made once and shared.
struct SceneSetup {
    core::Setup setup;
    render::SetupMeshes meshes;
    std::map<core::ToolNumber, std::vector<render::SharedMesh>> tools;
};

/// `surfaces`: makes the meshes; null: they are drawn in pictures that do not turn.
std::shared_ptr<const SceneSetup> make_scene_setup(const core::Setup& setup,
                                                   render::SurfaceMaker* surfaces = nullptr);

/// The scene at the cursor. Cheap, because large data is shared.
render::Scene scene_of(const ViewModel& model);

/// Everything that the picture of a scene depends on: equal keys give equal pictures.
struct SceneKey {
    uint64_t opening = 0, block_state = 0;
    const void* path = nullptr;
    const void* setup = nullptr;
    size_t block = 0;
    BodyNames pair;
    double fraction = 1.0; // of the block's time
    render::Camera camera;
    VisibleParts shown;
    render::ColorScheme theme = render::ColorScheme::dark;
    std::optional<size_t> hovered;
    core::Vec3 section = core::Vec3(0.0);
    double section_offset = 0.0;
    bool section_cuts_tool = false;
    bool inch = false;                    // the unit of the grid
    std::optional<core::Overlap> overlap; // of the shown pair
    std::optional<core::Transform> drag;  // of a body that is placed
    std::optional<core::AxisValues> jog;  // axes that were moved by hand
    std::vector<core::Vec3> measured;     // and the points of a section
    std::string work_offset;              // that is selected in the set-up
    int width = 0, height = 0;
    bool has_program = false;

    bool operator==(const SceneKey&) const = default;
};

SceneKey key_of(const ViewModel& model, const render::Viewport& size);

/// The position of the tool tip, frame of the stock; empty if unknown.
std::optional<core::Vec3> tip_now(const ViewModel& model);

/// The arrows at the zero of the program in the current block; empty if it is unknown.
std::optional<render::Triad> program_triad(const ViewModel& model);

/// The witness of the current block, if it has one and its view is loaded.
std::optional<render::Witness> witness_of(const ViewModel& model);

/// A camera that shows the closest pair of the current block unobstructed, if possible, and turns
/// the view as little as possible. Without a pair it frames the whole block.
///
/// Cost: one ray through the scene for each of up to 48 directions.
render::Camera witness_camera(const ViewModel& model, const render::Viewport& size);

/// The inferred set-up in short lines: the stock, the tools, and that no fixtures are known. Empty
/// if there is a set-up file, or no program.
std::vector<std::string> inferred_summary(const ViewModel& model);

} // namespace app::viewer
