#include "app/view/model/session_update.h"

#include <algorithm>
#include <iterator>

#include "app/view/model/program_track.h"
#include "core/motion/path.h"

namespace app::viewer {

void RowsUpdate::append(RowsUpdate later) {
    if (later.count)
        count = later.count;
    else if (count)
        count = std::max(*count, later.first + later.rows.size());
    if (later.rows.empty()) return;
    if (rows.empty() || later.first <= first) {
        // What came before and reaches beyond stays true.
        const size_t end = first + rows.size(), later_end = later.first + later.rows.size();
        if (!rows.empty() && end > later_end && later_end >= first)
            later.rows.insert(later.rows.end(),
                              rows.begin() + static_cast<ptrdiff_t>(later_end - first), rows.end());
        first = later.first;
        rows = std::move(later.rows);
        return;
    }
    const size_t from = later.first - first;
    if (rows.size() < from + later.rows.size()) rows.resize(from + later.rows.size());
    std::move(later.rows.begin(), later.rows.end(), rows.begin() + static_cast<ptrdiff_t>(from));
}

namespace {

template <typename T>
void take(T& known, T& later) {
    if (later) known = std::move(later);
}

} // namespace

void merge(SessionUpdate& news, SessionUpdate later) {
    if (later.opening != news.opening) {
        news = std::move(later);
        return;
    }
    take(news.opened, later.opened);
    news.rows.append(std::move(later.rows));
    take(news.findings, later.findings);
    take(news.path, later.path);
    take(news.place, later.place);
    take(news.walk, later.walk);
    take(news.breakpoints, later.breakpoints);
    if (later.changes) news.stopped.reset(); // it goes another way
    take(news.changes, later.changes);
    take(news.failure, later.failure);
    take(news.refusal, later.refusal);
    take(news.saved, later.saved);
    take(news.stopped, later.stopped);
    news.share = later.share;
    news.is_recorded = later.is_recorded;
    news.is_busy = later.is_busy;
    news.has_news = true;
}

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
