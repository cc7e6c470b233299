#pragma once

#include <map>
#include <memory>

#include "app/session/inspected_value.h"
#include "render/setup_scene.h"
#include "render/stock_brick.h"

namespace app::viewer {

/// A set-up with all that is drawn of it, made once and shared.
struct SceneSetup {
    core::Setup setup;
    render::SetupMeshes meshes;
    std::map<core::ToolNumber, std::vector<render::SharedMesh>> tools;
};

std::shared_ptr<const SceneSetup> make_scene_setup(const core::Setup& setup);

/// Where the axes are at a moment of a block.
struct Pose {
    double time = 0.0; // seconds after the block's start
    core::AxisValues values{};
};

/// The poses of a block in order of time, every motion from end to end; empty when nothing moves or
/// an axis may stand anywhere.
std::vector<Pose> poses_of(const core::Machine& machine, std::span<const core::Event> events);

/// Where the axes are at a share of a block's time, 0..1.
std::optional<core::AxisValues> pose_at(const std::vector<Pose>& poses, double share);

/// A value with a name, and whether the block has changed it.
struct ShownValue {
    std::string name, text;
    bool changed = false;
};

/// Values after a block, marked where they differ from those before.
std::vector<ShownValue> compared(const std::vector<NamedValue>& before,
                                 const std::vector<NamedValue>& after);

/// A block and the state round it, for the window. It never changes once it is made.
struct PlaceView {
    size_t block = 0;
    bool at_end = true; // the stock is as the block leaves it; false: as it found it
    std::shared_ptr<const SceneSetup> scene;
    std::vector<Pose> poses;                  // of the block
    std::optional<core::AxisValues> standing; // where the axes are after it
    std::optional<core::ToolNumber> tool;     // that moves in it
    std::vector<bool> fixtures_there;
    render::StockBricks stock;
    std::vector<ShownValue> modal, axes, offsets, parameters;
    std::vector<ShownValue> watched;
    uint64_t serial = 0; // counts views
};

} // namespace app::viewer
