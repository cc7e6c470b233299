#include "app/viewer/place_view.h"

#include <algorithm>

#include "app/viewer/program_track.h"
#include "core/sim/path.h"

namespace app::viewer {
namespace {

void add_motion(const core::Machine& machine, const core::Motion& motion, double begin,
                std::vector<Pose>& poses) {
    const auto from = known_values(machine, motion.from);
    const auto to = known_values(machine, motion.to);
    if (!to) return;
    if (poses.empty()) poses.push_back({begin, from.value_or(*to)});
    if (!from) {
        poses.push_back({begin, *to});
        return;
    }
    const core::Path path = core::path_of(motion, machine, drawing_error);
    for (const core::Leg& leg : path.legs)
        if (leg.straight && leg.places.size() == 2)
            poses.push_back({begin + leg.end, leg.places[1]});
    poses.push_back({begin + path.duration, *to});
}

} // namespace

std::shared_ptr<const SceneSetup> make_scene_setup(const core::Setup& setup) {
    auto scene = std::make_shared<SceneSetup>();
    scene->setup = setup;
    scene->meshes = render::setup_meshes(setup);
    for (const auto& [number, tool] : setup.tools)
        scene->tools.emplace(number, render::tool_meshes(tool));
    return scene;
}

std::vector<Pose> poses_of(const core::Machine& machine, std::span<const core::Event> events) {
    std::vector<Pose> poses;
    double time = 0.0;
    for (const core::Event& event : events) {
        if (const auto* dwell = std::get_if<core::Dwell>(&event)) time += dwell->seconds;
        const auto* motion = std::get_if<core::Motion>(&event);
        if (!motion) continue;
        add_motion(machine, *motion, time, poses);
        if (!poses.empty()) time = std::max(time, poses.back().time);
    }
    return poses;
}

std::optional<core::AxisValues> pose_at(const std::vector<Pose>& poses, double share) {
    if (poses.empty()) return {};
    const double time = std::clamp(share, 0.0, 1.0) * poses.back().time;
    const auto after = std::lower_bound(poses.begin(), poses.end(), time,
                                        [](const Pose& pose, double t) { return pose.time < t; });
    if (after == poses.begin()) return share >= 1.0 ? poses.back().values : poses.front().values;
    if (after == poses.end() || share >= 1.0) return poses.back().values;
    const Pose& before = *(after - 1);
    const double part = (time - before.time) / (after->time - before.time);
    core::AxisValues values{};
    for (size_t i = 0; i < values.size(); ++i)
        values[i] = before.values[i] + part * (after->values[i] - before.values[i]);
    return values;
}

std::vector<ShownValue> compared(const std::vector<NamedValue>& before,
                                 const std::vector<NamedValue>& after) {
    std::map<std::string, std::string> known;
    for (const NamedValue& value : before) known.emplace(value.name, value.value.text);
    std::vector<ShownValue> shown;
    for (const NamedValue& value : after) {
        const auto found = known.find(value.name);
        const bool same = found != known.end() && found->second == value.value.text;
        shown.push_back({value.name, value.value.text, !same});
    }
    return shown;
}

} // namespace app::viewer
