#include "app/viewer/session_publisher.h"

#include <algorithm>
#include <limits>

#include "core/sim/timing.h"

namespace app::viewer {
namespace {

render::ClearanceState state_of(const BlockRow& row) {
    if (is_offending(row)) return render::ClearanceState::violation;
    if (is_near(row)) return render::ClearanceState::near;
    if (!row.is_judged || row.verdict == core::Verdict::undecided)
        return render::ClearanceState::none;
    return render::ClearanceState::clear;
}

} // namespace

void SessionPublisher::begin(ProgramTrack track) {
    *this = {};
    rows_ = track.rows.size();
    points_ = std::move(track.points);
}

void SessionPublisher::begin_again(size_t block, ProgramTrack track) {
    rows_ = block + track.rows.size();
    const auto from = std::find_if(points_.begin(), points_.end(),
                                   [&](const auto& point) { return point.block >= block; });
    points_.erase(from, points_.end());
    painted_ = std::min(painted_, points_.size());
    points_.insert(points_.end(), track.points.begin(), track.points.end());
    durations_.resize(std::min(durations_.size(), block));
    states_.resize(std::min(states_.size(), block));
    findings_ = std::numeric_limits<size_t>::max(); // send them again
    is_whole_ = false;
    last_path_ = {};
}

size_t SessionPublisher::first_changed(const CheckRun& run) const {
    // A time is settled when `look_ahead` motions have come after it, at the latest at the end.
    size_t known = durations_.size();
    const size_t limit = is_whole_ ? known : known - std::min(known, 2 * core::look_ahead);
    size_t first = known;
    for (; known > limit; --known)
        if (durations_[known - 1] != run.blocks[known - 1].result.duration) first = known - 1;
    return first;
}

void SessionPublisher::add_rows(const DebugSession& session, const core::Setup& setup,
                                SessionUpdate& news) {
    const CheckRun& run = session.record();
    if (durations_.size() > run.blocks.size()) durations_.resize(run.blocks.size());
    RowsUpdate update;
    update.first = first_changed(run);
    durations_.resize(update.first);
    states_.resize(std::min(states_.size(), update.first));
    for (size_t i = update.first; i < run.blocks.size(); ++i) {
        update.rows.push_back(row_of(setup, run.blocks[i]));
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

void SessionPublisher::paint_path(const DebugSession& session, SessionUpdate& news) {
    const Clock::time_point now = Clock::now();
    const bool is_due = last_path_ == Clock::time_point{}
                        || now - last_path_ > std::chrono::milliseconds(300) + 20 * path_cost_;
    if (!is_due && !(session.is_recorded() && !is_whole_)) return;
    while (painted_ < points_.size() && points_[painted_].block < states_.size()) {
        points_[painted_].state = states_[points_[painted_].block];
        ++painted_;
    }
    news.path = std::make_shared<const render::ToolPath>(render::tool_path(points_));
    last_path_ = Clock::now();
    path_cost_ = last_path_ - now;
}

void SessionPublisher::publish(const DebugSession& session, const core::Setup& setup,
                               SessionUpdate& news) {
    add_rows(session, setup, news);
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
