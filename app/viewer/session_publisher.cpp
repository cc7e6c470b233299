#include "app/viewer/session_publisher.h"

#include <algorithm>
#include <limits>

#include "core/sim/timing.h"

namespace app::viewer {

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
    findings_ = std::numeric_limits<size_t>::max(); // send them again
    is_whole_ = false;
    last_path_ = {};
}

size_t SessionPublisher::first_changed(const CheckRun& run) const {
    // A time is settled when `look_ahead` motions have come after it, at the latest at the end.
    size_t first = durations_.size(), motions_after = 0;
    if (is_whole_) return first;
    for (size_t i = first; i-- > 0 && motions_after <= core::look_ahead;) {
        const core::BlockResult& result = run.blocks[i].result;
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
        update.rows.push_back(row_of(session.setup_at(i), run.blocks[i]));
        durations_.push_back(run.blocks[i].result.duration);
        states_.push_back(state_of(update.rows.back()));
    }
    rows_ = std::max(rows_, run.blocks.size());
    if (session.is_recorded() && rows_ != run.blocks.size()) {
        rows_ = run.blocks.size();
        update.count = rows_;
    }
    if (!update.empty()) news.rows.append(std::move(update));
}

std::vector<render::ClearanceState> SessionPublisher::known_states(const CheckRun& run) const {
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
    const std::vector<render::ClearanceState> states = known_states(session.record());
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
    news.share = session.recorded_share();
    news.is_recorded = is_whole_;
    news.has_news = true;
}

} // namespace app::viewer
