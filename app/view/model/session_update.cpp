#include "app/view/model/session_update.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/check/prepared_check.h"
#include "app/check/setup_sheet.h"
#include "app/debug/debug_session.h"
#include "app/view/model/program_track.h"
#include "app/view/model/scene_of.h"
#include "core/motion/path.h"
#include "core/motion/timing.h"
#include "gcode/language/dialect.h"

namespace app::viewer {

OpenedProgram opened_program(const CheckJob& job, const PreparedCheck& check,
                             render::SurfaceMaker* surfaces) {
    OpenedProgram opened;
    opened.program = job.program;
    opened.setup = job.setup;
    const gcode::Dialect& dialect = gcode::dialect(check.run.dialect);
    opened.dialect = dialect.name;
    opened.counts_blocks = dialect.language == gcode::Language::klartext;
    opened.assumptions = check.run.assumptions;
    opened.is_inferred = check.file.is_inferred;
    opened.is_inch = check.is_in_inches();
    opened.coverage = check.run.coverage;
    for (const auto& [number, tool] : check.run.setup.tools)
        if (!tool.description.holder.empty()) opened.tools_with_holder.insert(number);
    opened.scene = make_scene_setup(check.run.setup, surfaces);
    opened.proposed_path = setup_path(job);
    opened.setup_text = job.setup_text.value_or("");
    opened.sheet = std::make_shared<const SetupSheet>(sheet_of(check.file, check.run.setup));
    return opened;
}

void RowsUpdate::append(RowsUpdate later) {
    if (later.count)
        count = later.count;
    else if (count)
        count = std::max(*count, later.first + later.rows.size());
    if (later.rows.empty()) return;
    if (rows.empty() || later.first <= first) {
        // Earlier rows beyond the end of the later ones stay valid.
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
    if (later.answered != 0) news.answered = later.answered;
    take(news.opened, later.opened);
    news.rows.append(std::move(later.rows));
    take(news.findings, later.findings);
    take(news.path, later.path);
    take(news.block_state, later.block_state);
    take(news.walk, later.walk);
    take(news.breakpoints, later.breakpoints);
    if (later.changes) news.stopped.reset(); // the program takes another course now
    take(news.changes, later.changes);
    if (!later.files.empty()) news.files = std::move(later.files);
    take(news.failure, later.failure);
    take(news.refusal, later.refusal);
    take(news.setup_error, later.setup_error);
    take(news.stopped, later.stopped);
    news.reading = std::move(later.reading);
    news.fraction = later.fraction;
    news.verdict = later.verdict;
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
        if (leg.straight && leg.positions.size() == 2)
            poses.push_back({begin + leg.end, leg.positions[1]});
    poses.push_back({begin + path.duration, *to});
}

} // namespace

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

std::optional<core::AxisValues> pose_at(const std::vector<Pose>& poses, double fraction) {
    if (poses.empty()) return {};
    const double time = std::clamp(fraction, 0.0, 1.0) * poses.back().time;
    const auto after = std::lower_bound(poses.begin(), poses.end(), time,
                                        [](const Pose& pose, double t) { return pose.time < t; });
    if (after == poses.begin()) return fraction >= 1.0 ? poses.back().values : poses.front().values;
    if (after == poses.end() || fraction >= 1.0) return poses.back().values;
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

void SessionPublisher::begin(std::vector<render::PathPoint> points, size_t rows) {
    *this = {};
    rows_ = rows;
    points_ = std::move(points);
}

void SessionPublisher::begin_again(size_t block, const std::vector<render::PathPoint>& points,
                                   size_t rows) {
    rows_ = rows;
    const auto from = std::find_if(points_.begin(), points_.end(),
                                   [&](const auto& point) { return point.block >= block; });
    points_.erase(from, points_.end());
    points_.insert(points_.end(), points.begin(), points.end());
    durations_.resize(std::min(durations_.size(), block));
    states_.resize(std::min(states_.size(), block));
    findings_ = std::numeric_limits<size_t>::max(); // forces sending them again
    is_whole_ = false;
    last_path_ = {};
}

size_t SessionPublisher::first_changed(const CheckRun& run) const {
    // A block's time is final once `look_ahead` motions follow it, at the latest at the end.
    size_t first = durations_.size(), motions_after = 0;
    if (is_whole_) return first;
    for (size_t i = first; i-- > 0 && motions_after <= core::look_ahead;) {
        const core::BlockResult result = run.blocks[i].result;
        if (durations_[i] != result.duration) first = i;
        if (result.motion != core::BlockMotion::none) ++motions_after;
    }
    return first;
}

void SessionPublisher::add_rows(const DebugSession& session, SessionUpdate& news) {
    const CheckRun& run = session.record();
    if (durations_.size() > run.blocks.size()) durations_.resize(run.blocks.size());
    RowsUpdate update;
    update.first = first_changed(run);
    durations_.resize(update.first);
    states_.resize(std::min(states_.size(), update.first));
    for (size_t i = update.first; i < run.blocks.size(); ++i) {
        const CheckedBlock block = run.blocks[i];
        update.rows.push_back(row_of(session.setup_at(i), block));
        durations_.push_back(block.result.duration);
        states_.push_back(state_of(update.rows.back()));
    }
    rows_ = std::max(rows_, run.blocks.size());
    if (session.is_recorded() && rows_ != run.blocks.size()) {
        rows_ = run.blocks.size();
        update.count = rows_;
    }
    if (!update.empty()) news.rows.append(std::move(update));
}

std::vector<render::ClearanceState> SessionPublisher::clearance_states(const CheckRun& run) const {
    std::vector<render::ClearanceState> states = states_;
    for (const core::Finding& finding : run.findings) {
        if (finding.severity != core::Severity::error || !finding.block) continue;
        const size_t block = core::value_of(*finding.block);
        if (block < states.size()) states[block] = render::ClearanceState::violation;
    }
    return states;
}

void SessionPublisher::paint_path(const DebugSession& session, SessionUpdate& news) {
    const Clock::time_point now = Clock::now();
    const bool is_due = last_path_ == Clock::time_point{}
                        || now - last_path_ > std::chrono::milliseconds(300) + 20 * path_cost_;
    if (!is_due && !(session.is_recorded() && !is_whole_)) return;
    const std::vector<render::ClearanceState> states = clearance_states(session.record());
    for (render::PathPoint& point : points_)
        if (point.block < states.size()) point.state = states[point.block];
    news.path = std::make_shared<const render::ToolPath>(render::tool_path(points_));
    last_path_ = Clock::now();
    path_cost_ = last_path_ - now;
}

void SessionPublisher::publish(const DebugSession& session, SessionUpdate& news) {
    add_rows(session, news);
    const CheckRun& run = session.record();
    if (run.findings.size() != findings_ || (session.is_recorded() && !is_whole_)) {
        news.findings = run.findings;
        findings_ = run.findings.size();
    }
    if (!is_whole_) paint_path(session, news);
    if (session.is_recorded() && !is_whole_) news.stopped = run.stopped;
    is_whole_ = session.is_recorded();
    news.fraction = session.recorded_fraction();
    news.verdict = run.verdict;
    news.is_recorded = is_whole_;
    news.has_news = true;
}

} // namespace app::viewer
