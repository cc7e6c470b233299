#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/view/model/settings.h"
#include "core/sim/setup.h"
#include "render/scene.h"
#include "render/setup_scene.h"

namespace app::viewer {

struct ViewModel;

/// A set-up with all that is drawn of it, made once and shared.
struct SceneSetup {
    core::Setup setup;
    render::SetupMeshes meshes;
    std::map<core::ToolNumber, std::vector<render::SharedMesh>> tools;
};

std::shared_ptr<const SceneSetup> make_scene_setup(const core::Setup& setup);

/// What is to be seen at the cursor. Cheap: everything large is shared.
render::Scene scene_of(const ViewModel& model);

/// Everything that the picture of a scene follows from: while it is the same, so is the picture.
struct SceneKey {
    uint64_t opening = 0, place = 0;
    const void* path = nullptr;
    size_t block = 0;
    double share = 1.0; // of the block
    render::Camera camera;
    Shown shown;
    render::ColorScheme theme = render::ColorScheme::dark;
    std::optional<size_t> hovered;
    core::Vec3 section = core::Vec3(0.0);
    double section_offset = 0.0;
    std::vector<core::Vec3> measured;
    int width = 0, height = 0;
    bool has_program = false;

    bool operator==(const SceneKey&) const = default;
};

SceneKey key_of(const ViewModel& model, const render::Viewport& size);

/// Where the tip of the tool stands. Frame: that of the stock. Empty when nobody knows.
std::optional<core::Vec3> tip_now(const ViewModel& model);

/// The witness of the current block, if there is one and the view stands at it.
std::optional<render::Witness> witness_of(const ViewModel& model);

/// A view of the closest pair of the current block from where nothing hides it, if there is such a
/// side; the one that turns the camera least. Without a pair the whole block is framed.
///
/// Cost: a ray through the scene for each of some dozens of directions.
render::Camera witness_camera(const ViewModel& model, const render::Viewport& size);

/// What a program is checked with where nobody has said it, in short lines: the stock, the tools,
/// and that no fixtures are known. Empty where a set-up says it, or nothing is open.
std::vector<std::string> inferred_summary(const ViewModel& model);

} // namespace app::viewer
