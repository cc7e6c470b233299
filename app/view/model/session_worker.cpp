#include "app/view/model/session_worker.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <utility>

#include "app/check/check_job.h"
#include "app/check/prepared_check.h"
#include "app/check/program_runner.h"
#include "app/view/model/program_track.h"
#include "core/motion/timing.h"

namespace app::viewer {
namespace {

/// How long a slice of the record takes, seconds: a request waits for one at most.
constexpr double slice = 0.01;
constexpr auto walk_slice = std::chrono::milliseconds(30);
constexpr auto publish_interval = std::chrono::milliseconds(60);

/// Blocks beyond these are only known once they are checked.
constexpr size_t most_early_blocks = 2'000'000;

OpenedProgram described(const CheckJob& job, const PreparedCheck& check) {
    OpenedProgram opened;
    opened.program = job.program;
    opened.setup = job.setup;
    const gcode::Dialect& dialect = gcode::dialect(check.run.dialect);
    opened.dialect = dialect.name;
    opened.counts_blocks = dialect.language == gcode::Language::klartext;
    opened.assumptions = check.run.assumptions;
    opened.is_inferred = job.setup.empty();
    opened.scene = make_scene_setup(check.run.setup);
    opened.proposed_path = proposed_setup_path(job);
    opened.sheet =
        std::make_shared<const SetupSheet>(sheet_of(check.file, check.run.setup, job.edits));
    return opened;
}

/// The way of a program before its stock is modelled, to its end or its first error.
ProgramTrack track_of(const PreparedCheck& check, const core::Setup& setup,
                      const std::function<bool()>& is_closing) {
    const gcode::Environment& environment = check.file.environment;
    ProgramTrack track(setup);
    BlockRunner(check).visit_ahead(
        gcode::initial_state(environment), gcode::initial_lowering(environment),
        [&](const gcode::BlockCommands& block, std::span<const core::Event> events) {
            track.add(block, events);
            return track.rows.size() < most_early_blocks && !is_closing();
        });
    return track;
}

/// The tool that a block moves: the one that it changes to, if it does.
std::optional<core::ToolNumber> tool_of(const std::vector<core::Event>& events,
                                        std::optional<core::ToolNumber> before) {
    for (const core::Event& event : events)
        if (const auto* change = std::get_if<core::ToolChange>(&event)) before = change->tool;
    return before;
}

} // namespace

void WorkerSession::open(const CheckJob& job, const std::function<void()>& publish) {
    session_.reset();
    walk_.reset();
    scenes_.clear();
    surface_.reset();
    news_ = {};
    news_.opening = ++openings_;
    news_.has_news = news_.is_busy = true;
    publish();
    auto check = read_check(job);
    if (!check) return fail(check.error());
    OpenedProgram opened = described(job, *check);
    scenes_.emplace_back(0, opened.scene);
    show_early(track_of(*check, opened.scene->setup, is_closing_));
    news_.opened = std::make_shared<const OpenedProgram>(opened);
    news_.has_news = news_.is_busy = true;
    publish();
    auto session = DebugSession::open(job, *std::move(check));
    if (!session) return fail(session.error());
    session_ = *std::move(session);
    session_->is_interrupted = [this] { return is_interrupted_() || Clock::now() > walk_rests_; };
    news_.has_news = true;
    set_breakpoints(breakpoints_);
}

void WorkerSession::fail(const core::Error& error) {
    news_.failure = error;
    news_.has_news = true;
    news_.is_busy = false;
}

void WorkerSession::show_early(ProgramTrack track) {
    news_.path = std::make_shared<const render::ToolPath>(render::tool_path(track.points));
    publisher_.begin(std::move(track.points), track.rows.size());
    const size_t count = track.rows.size();
    news_.rows = {0, std::move(track.rows), count};
}

void WorkerSession::record() {
    if (walk_) return walk_on();
    if (has_work()) session_->record_for(slice);
    publish_if_due();
}

void WorkerSession::publish_if_due() {
    if (!session_) return;
    const Clock::time_point now = Clock::now();
    if (!session_->is_recorded() && now - last_publish_ < publish_interval) return;
    last_publish_ = now;
    publisher_.publish(*session_, news_);
}

bool WorkerSession::can_show(const ShowRequest& request) const {
    return session_
           && (session_->is_recorded() || request.block < session_->record().blocks.size());
}

std::shared_ptr<const SceneSetup> WorkerSession::scene_at(size_t block) {
    size_t first = 0;
    for (const MadeChange& change : session_->changes())
        if (change.block <= block) first = std::max(first, change.block);
    for (const auto& [known, scene] : scenes_)
        if (known == first) return scene;
    scenes_.emplace_back(first, make_scene_setup(session_->setup_at(block)));
    return scenes_.back().second;
}

std::vector<ShownValue>
WorkerSession::watched_values(const gcode::InterpreterState& control) const {
    std::vector<ShownValue> values;
    for (const std::string& expression : watched_) {
        const auto value = value_of(expression, control, session_->environment());
        values.push_back({expression, value ? value->text : value.error().message, false});
    }
    return values;
}

void WorkerSession::show(const ShowRequest& request) {
    if (!session_ || session_->record().blocks.empty()) return;
    auto view = std::make_shared<PlaceView>();
    view->block = std::min(request.block, session_->record().blocks.size() - 1);
    view->at_end = request.at_end;
    view->serial = ++views_;
    if (const auto gone = session_->go_to(view->block); !gone) return refuse(gone.error());
    view->scene = scene_at(view->block);
    const gcode::InterpreterState before = session_->place().control;
    const auto ahead = first_events([&](const BlockVisit& look) { session_->visit_ahead(look); });
    const std::vector<core::Event> events = ahead.value_or(std::vector<core::Event>());
    view->poses = poses_of(view->scene->setup.machine, events);
    view->tool = tool_of(events, session_->place().machine.tool);
    if (!request.at_end) surface_.update(session_->place().machine.stock);
    // A block that the control refuses has nothing behind it: the view is then that before it.
    if (ahead) static_cast<void>(session_->go_to(view->block + 1));
    const RunState& after = session_->place();
    if (request.at_end) surface_.update(after.machine.stock);
    view->stock = surface_.bricks();
    view->standing = known_values(view->scene->setup.machine, after.machine.position);
    view->fixtures_there = after.machine.fixtures_there;
    const gcode::Environment& world = session_->environment();
    view->modal = compared(modal_values(before, world), modal_values(after.control, world));
    view->axes = compared(axis_values(before), axis_values(after.control));
    view->offsets = compared(offset_values(before), offset_values(after.control));
    view->parameters =
        compared(parameter_values(before, world), parameter_values(after.control, world));
    view->watched = watched_values(after.control);
    news_.place = std::move(view);
    news_.has_news = true;
    publish_if_due();
}

void WorkerSession::walk(Walk walk, size_t block, uint64_t number) {
    if (session_) walk_ = WalkOnItsWay{walk, block, number};
}

void WorkerSession::walk_on() {
    WalkOnItsWay& way = *walk_;
    if (const auto gone = session_->go_to(way.block); !gone) {
        walk_.reset();
        return refuse(gone.error());
    }
    walk_rests_ = Clock::now() + walk_slice;
    const Stop stop = way.walk == Walk::go_on ? session_->go_on() : session_->go_on_back();
    way.block = session_->at();
    if (stop.reason == StopReason::interrupted && !is_interrupted_()) return publish_if_due();
    news_.walk = WalkEnd{way.number, session_->at(), stop};
    walk_.reset();
    news_.breakpoints = breakpoints_ = session_->breakpoints();
    news_.has_news = true;
    publisher_.publish(*session_, news_);
}

void WorkerSession::set_breakpoints(const std::vector<Breakpoint>& breakpoints) {
    breakpoints_ = breakpoints;
    if (!session_) return;
    session_->breakpoints().clear();
    for (const Breakpoint& breakpoint : breakpoints_) session_->add(breakpoint);
    news_.breakpoints = breakpoints_ = session_->breakpoints();
    news_.has_news = true;
}

void WorkerSession::change(const WhatIf& change, size_t block) {
    if (!session_) return;
    if (const auto gone = session_->go_to(block); !gone) return refuse(gone.error());
    if (const auto made = session_->change(change); !made) return refuse(made.error());
    follow_anew();
}

void WorkerSession::take_back() {
    if (!session_ || session_->changes().empty()) return;
    if (const auto back = session_->take_back(); !back) return refuse(back.error());
    follow_anew();
}

void WorkerSession::save_setup(const SaveRequest& request) {
    SetupSaved saved{request.path, {}, false};
    const auto done =
        app::save_setup(request.job, request.path, request.may_replace, request.write);
    if (!done) {
        std::error_code ignored; // of a name that no file can have, which the refusal tells of
        saved.refusal = done.error();
        saved.exists = !request.may_replace && std::filesystem::exists(request.path, ignored);
    }
    news_.saved = std::move(saved);
    news_.has_news = true;
}

void WorkerSession::follow_anew() {
    walk_.reset();
    scenes_.clear();
    surface_.reset();
    const size_t block = session_->at();
    ProgramTrack track(session_->setup_at(block), block, session_->place().machine.tool);
    session_->visit_ahead(
        [&](const gcode::BlockCommands& ahead, std::span<const core::Event> events) {
            track.add(ahead, events);
            return track.rows.size() < most_early_blocks;
        });
    const size_t count = block + track.rows.size();
    publisher_.begin_again(block, track.points, count);
    news_.rows.append({block, std::move(track.rows), count});
    publisher_.publish(*session_, news_);
    std::vector<std::string> changes;
    for (const MadeChange& change : session_->changes()) changes.push_back(text_of(change.change));
    news_.changes = std::move(changes);
    news_.has_news = true;
}

void WorkerSession::refuse(const core::Error& error) {
    news_.refusal = error.message;
    news_.has_news = true;
}

SessionUpdate WorkerSession::take_news() {
    SessionUpdate news = std::move(news_);
    news_ = {};
    news_.opening = news.opening = openings_;
    news_.share = news.share;
    news_.is_recorded = news.is_recorded;
    return news;
}

SessionWorker::SessionWorker(std::function<void()> wake)
    : wake_(std::move(wake)), thread_([this] { run(); }) {}

SessionWorker::~SessionWorker() {
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void SessionWorker::post(Task task) {
    {
        const std::lock_guard lock(mutex_);
        tasks_.push_back(std::move(task));
    }
    changed_.notify_all();
}

void SessionWorker::open(const CheckJob& job) {
    interrupt();
    post([this, job](WorkerSession& session) {
        const auto publish = [&] { deliver(session.take_news()); };
        session.open(job, publish);
    });
}

void SessionWorker::show(const ShowRequest& request) {
    {
        const std::lock_guard lock(mutex_);
        wanted_ = request;
    }
    changed_.notify_all();
}

uint64_t SessionWorker::walk(Walk walk, size_t block) {
    const uint64_t number = ++walks_;
    post([this, number, walk, block](WorkerSession& session) {
        walking_ = number;
        session.walk(walk, block, number);
    });
    return number;
}

void SessionWorker::set_breakpoints(const std::vector<Breakpoint>& breakpoints) {
    post([breakpoints](WorkerSession& session) { session.set_breakpoints(breakpoints); });
}

void SessionWorker::watch(const std::vector<std::string>& expressions) {
    post([expressions](WorkerSession& session) { session.watch(expressions); });
}

void SessionWorker::change(const WhatIf& change, size_t block) {
    post([change, block](WorkerSession& session) { session.change(change, block); });
}

void SessionWorker::take_back() {
    post([](WorkerSession& session) { session.take_back(); });
}

void SessionWorker::save_setup(const SaveRequest& request) {
    post([request](WorkerSession& session) { session.save_setup(request); });
}

SessionUpdate SessionWorker::take() {
    const std::lock_guard lock(mutex_);
    SessionUpdate news = std::move(news_);
    news_ = {};
    return news;
}

void SessionWorker::deliver(SessionUpdate news) {
    if (!news.has_news) return;
    {
        const std::lock_guard lock(mutex_);
        merge(news_, std::move(news));
    }
    wake_();
}

std::optional<ShowRequest> SessionWorker::wanted(const WorkerSession& session) {
    const std::lock_guard lock(mutex_);
    if (!wanted_ || !session.can_show(*wanted_)) return {};
    return std::exchange(wanted_, std::nullopt);
}

void SessionWorker::run() {
    const auto is_interrupted = [this] {
        return stopping_ || (walking_ != 0 && walking_ <= interrupted_);
    };
    WorkerSession session(is_interrupted, [this] { return stopping_.load(); });
    while (!stopping_) {
        Task task;
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [&] {
                return stopping_ || !tasks_.empty() || session.has_work()
                       || (wanted_ && session.can_show(*wanted_));
            });
            if (!tasks_.empty()) {
                task = std::move(tasks_.front());
                tasks_.pop_front();
            }
        }
        if (stopping_) return;
        if (task) {
            task(session);
        } else if (const auto request = wanted(session)) {
            session.show(*request);
        } else {
            session.record();
        }
        deliver(session.take_news());
    }
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
