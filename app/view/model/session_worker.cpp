#include "app/view/model/session_worker.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "app/check/block_events.h"
#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/check/prepared_check.h"
#include "app/debug/debug_session.h"
#include "app/view/model/program_track.h"
#include "app/view/model/program_zero.h"
#include "app/view/model/scene_of.h"
#include "core/base/file_reads.h"
#include "core/cad/cad_file.h"
#include "render/setup_scene.h"
#include "render/stock_surface.h"

namespace app::viewer {

namespace {

/// Duration of one slice of recording, seconds. A request waits for one slice at most.
constexpr double slice = 0.01;
constexpr auto walk_slice = std::chrono::milliseconds(30);
constexpr auto publish_interval = std::chrono::milliseconds(60);
constexpr auto cad_interval = std::chrono::milliseconds(250); // most files take less

/// "vise.step: meshing, 40 %".
std::string reading_text(const core::CadProgress& progress) {
    return fmt::format("{}: {}, {:.0f} %",
                       std::filesystem::path(progress.file).filename().generic_string(),
                       progress.step, 100.0 * progress.fraction);
}

/// The tool that a block moves: the new one if the block changes tools.
std::optional<core::ToolNumber> tool_of(const std::vector<core::Event>& events,
                                        std::optional<core::ToolNumber> before) {
    for (const core::Event& event : events)
        if (const auto* change = std::get_if<core::ToolChange>(&event)) before = change->tool;
    return before;
}

/// The values of the control that a view shows.
struct ControlValues {
    std::vector<NamedValue> modal, offsets, parameters;
};

/// The values at the position of a session.
ControlValues values_of(const DebugSession& session) {
    const gcode::InterpreterState& control = session.control();
    const gcode::Environment& environment = session.environment();
    return {modal_values(control, environment), offset_values(control),
            parameter_values(control, environment)};
}

} // namespace

WorkerSession::WorkerSession(std::function<bool()> is_interrupted)
    : is_interrupted_(std::move(is_interrupted)),
      surface_(std::make_unique<render::StockSurface>()),
      surfaces_(std::make_unique<render::SurfaceMaker>()) {}

WorkerSession::~WorkerSession() = default;

const CheckRun* WorkerSession::checked() const { return session_ ? &session_->record() : nullptr; }

bool WorkerSession::has_work() const { return session_ && (walk_ || !session_->is_recorded()); }

void WorkerSession::begin(const CheckJob& job, bool is_again) {
    session_.reset();
    walk_.reset();
    scenes_.clear();
    surface_->reset();
    program_ = job.program;
    is_shown_ = is_again;
    news_ = {};
    news_.opening = ++openings_;
    news_.has_news = news_.is_busy = true;
    news_.is_again = is_again;
}

void WorkerSession::open(const CheckJob& wanted, const std::function<void()>& publish,
                         const std::function<bool()>& is_superseded) {
    const bool is_again = is_shown_ && wanted.program == program_;
    if (!is_again) {
        begin(wanted, false);
        publish();
    }
    CheckJob job = wanted;
    job.is_stopped = is_superseded;
    std::set<std::string> read;
    const core::FileAccessObserver listening([&read](const core::FileAccess& access) {
        if (access.question == core::FileAccessKind::content) read.insert(access.path);
    });
    const core::CadReadObserver observer([&](const core::CadProgress& progress) {
        if (Clock::now() - last_publish_ < cad_interval) return !is_superseded();
        last_publish_ = Clock::now();
        news_.reading = reading_text(progress);
        news_.has_news = news_.is_busy = true;
        publish();
        return !is_superseded();
    });
    last_publish_ = Clock::now();
    auto check = read_check(job);
    if (is_superseded()) return;
    news_.files.assign(read.begin(), read.end());
    if (!check) return fail(check.error(), is_again);
    if (auto why = is_again ? why_nothing_runs(*check) : std::nullopt) {
        if (why->file.empty()) why->file = job.program;
        return fail(*why, true);
    }
    if (is_again) begin(job, true);
    job.is_stopped = wanted.is_stopped;
    OpenedProgram opened = opened_program(job, *check, surfaces_.get());
    scenes_.emplace_back(0, opened.scene);
    show_early(track_of(*check, opened.scene->setup, is_superseded));
    news_.files.assign(read.begin(), read.end()); // also subprograms
    news_.opened = std::make_shared<const OpenedProgram>(opened);
    news_.has_news = news_.is_busy = true;
    is_shown_ = true;
    publish();
    if (is_superseded()) return;
    auto session = DebugSession::open(job, *std::move(check));
    if (!session) return fail(session.error(), is_again);
    session_ = *std::move(session);
    session_->is_interrupted = [this] { return is_interrupted_() || Clock::now() > walk_rests_; };
    news_.has_news = true;
    set_breakpoints(breakpoints_);
}

void WorkerSession::fail(const core::Error& error, bool is_again) {
    (is_again ? news_.setup_error : news_.failure) = error;
    is_shown_ = is_again;
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
    for (const AppliedChange& change : session_->changes())
        if (change.block <= block) first = std::max(first, change.block);
    for (const auto& [known, scene] : scenes_)
        if (known == first) return scene;
    scenes_.emplace_back(first, make_scene_setup(session_->setup_at(block), surfaces_.get()));
    return scenes_.back().second;
}

std::vector<ShownValue> WorkerSession::watched_values() const {
    std::vector<ShownValue> values;
    for (const std::string& expression : watched_) {
        const auto value = value_of(expression, session_->control(), session_->environment());
        values.push_back({expression, value ? value->text : value.error().message, false});
    }
    return values;
}

void WorkerSession::show(const ShowRequest& request) {
    if (!session_ || session_->record().blocks.empty()) return;
    auto view = std::make_shared<BlockState>();
    view->block = std::min(request.block, session_->record().blocks.size() - 1);
    view->at_end = request.at_end;
    view->serial = ++views_;
    if (const auto gone = session_->go_to(view->block); !gone) return refuse(gone.error());
    view->scene = scene_at(view->block);
    const ControlValues before = values_of(*session_);
    const auto ahead =
        first_block([&](const BlockVisit& visit) { session_->visit_ahead(visit); }, true);
    const std::vector<core::Event> events = ahead ? ahead->events : std::vector<core::Event>();
    view->poses = poses_of(view->scene->setup.machine, events);
    view->tool = tool_of(events, session_->tool());
    if (!request.at_end) surface_->update(session_->stock());
    // If the control refuses the block there is no state after it: show the one before it.
    if (ahead) static_cast<void>(session_->go_to(view->block + 1));
    if (request.at_end) surface_->update(session_->stock());
    view->stock = surface_->bricks();
    view->standing = known_values(view->scene->setup.machine, session_->position());
    view->mounted_fixtures = session_->mounted_fixtures();
    view->zero = program_zero(session_->control());
    view->offsets_in_effect = offsets_in_effect(session_->control(), view->scene->setup.machine);
    const ControlValues after = values_of(*session_);
    view->modal = compared(before.modal, after.modal);
    view->offsets = compared(before.offsets, after.offsets);
    view->parameters = compared(before.parameters, after.parameters);
    view->watched = watched_values();
    news_.block_state = std::move(view);
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
    const Stop stop = way.walk == Walk::go_on ? session_->go_on() : session_->reverse_resume();
    way.block = session_->at();
    if (stop.reason == StopReason::interrupted && !is_interrupted_()) return publish_if_due();
    news_.walk = RunEnd{way.number, session_->at(), stop};
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
    restart_following();
}

void WorkerSession::take_back() {
    if (!session_ || session_->changes().empty()) return;
    if (const auto back = session_->take_back(); !back) return refuse(back.error());
    restart_following();
}

void WorkerSession::restart_following() {
    walk_.reset();
    scenes_.clear();
    surface_->reset();
    const size_t block = session_->at();
    ProgramTrack track(session_->setup_at(block), block, session_->tool());
    session_->visit_ahead(
        [&](const gcode::BlockCommands& ahead, std::span<const core::Event> events) {
            return track.add(ahead, events);
        });
    const size_t count = block + track.rows.size();
    publisher_.begin_again(block, track.points, count);
    news_.rows.append({block, std::move(track.rows), count});
    publisher_.publish(*session_, news_);
    std::vector<std::string> changes;
    for (const AppliedChange& change : session_->changes())
        changes.push_back(text_of(change.change));
    news_.changes = std::move(changes);
    news_.has_news = true;
}

void WorkerSession::refuse(const core::Error& error) {
    news_.refusal = error.message;
    news_.has_news = true;
}

SessionUpdate WorkerSession::take_update() {
    SessionUpdate news = std::move(news_);
    news_ = {};
    news_.opening = news.opening = openings_;
    news_.fraction = news.fraction;
    news_.verdict = news.verdict;
    news_.is_recorded = news.is_recorded;
    return news;
}

/// State shared by the two threads.
struct SessionWorker::State {
    using Task = std::function<void(WorkerSession&)>;

    explicit State(std::function<void()> wake) : wake_(std::move(wake)) {}
    ~State();

    void interrupt() { interrupted_ = walks_.load(); }
    void post(Task task);
    void run();
    uint64_t open(const CheckJob& job);
    void deliver(SessionUpdate news);
    /// The requested view, if it can be made now.
    std::optional<ShowRequest> wanted(const WorkerSession& session);

    std::function<void()> wake_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Task> tasks_;
    std::optional<ShowRequest> wanted_;
    SessionUpdate news_;
    std::atomic<bool> stopping_ = false, rests_ = false;
    std::atomic<uint64_t> opens_ = 0;       // requested
    std::atomic<uint64_t> walks_ = 0;       // requested
    std::atomic<uint64_t> interrupted_ = 0; // walks up to this number
    // The last ones begun; used by the worker's thread only.
    uint64_t opening_ = 0, walking_ = 0;
    std::thread thread_ = std::thread([this] { run(); }); // last: it uses all of the above
};

SessionWorker::State::~State() {
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void SessionWorker::State::post(Task task) {
    {
        const std::lock_guard lock(mutex_);
        tasks_.push_back(std::move(task));
    }
    changed_.notify_all();
}

uint64_t SessionWorker::State::open(const CheckJob& job) {
    const uint64_t number = ++opens_;
    post([this, job, number](WorkerSession& session) {
        const auto is_superseded = [&] { return stopping_ || opens_ != number; };
        if (is_superseded()) return;
        opening_ = number;
        session.open(
            job, [&] { deliver(session.take_update()); }, is_superseded);
    });
    return number;
}

void SessionWorker::State::deliver(SessionUpdate news) {
    if (!news.has_news) return;
    if (news.opened || news.failure || news.setup_error) news.answered = opening_;
    {
        const std::lock_guard lock(mutex_);
        merge(news_, std::move(news));
    }
    wake_();
}

std::optional<ShowRequest> SessionWorker::State::wanted(const WorkerSession& session) {
    const std::lock_guard lock(mutex_);
    if (!wanted_ || !session.can_show(*wanted_)) return {};
    return std::exchange(wanted_, std::nullopt);
}

void SessionWorker::State::run() {
    const auto is_interrupted = [this] {
        return stopping_ || (walking_ != 0 && walking_ <= interrupted_);
    };
    WorkerSession session(is_interrupted);
    while (!stopping_) {
        Task task;
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [&] {
                return stopping_ || !tasks_.empty() || (session.has_work() && !rests_)
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
        deliver(session.take_update());
    }
}

SessionWorker::SessionWorker(std::function<void()> wake)
    : state_(std::make_unique<State>(std::move(wake))) {}

SessionWorker::~SessionWorker() = default;

void SessionWorker::interrupt() { state_->interrupt(); }

uint64_t SessionWorker::open(const CheckJob& job) {
    interrupt();
    return state_->open(job);
}

void SessionWorker::show(const ShowRequest& request) {
    {
        const std::lock_guard lock(state_->mutex_);
        state_->wanted_ = request;
    }
    state_->changed_.notify_all();
}

uint64_t SessionWorker::walk(Walk walk, size_t block) {
    const uint64_t number = ++state_->walks_;
    state_->post([state = state_.get(), number, walk, block](WorkerSession& session) {
        state->walking_ = number;
        session.walk(walk, block, number);
    });
    return number;
}

void SessionWorker::set_breakpoints(const std::vector<Breakpoint>& breakpoints) {
    state_->post([breakpoints](WorkerSession& session) { session.set_breakpoints(breakpoints); });
}

void SessionWorker::watch(const std::vector<std::string>& expressions) {
    state_->post([expressions](WorkerSession& session) { session.watch(expressions); });
}

void SessionWorker::change(const WhatIf& change, size_t block) {
    state_->post([change, block](WorkerSession& session) { session.change(change, block); });
}

void SessionWorker::take_back() {
    state_->post([](WorkerSession& session) { session.take_back(); });
}

void SessionWorker::rest(bool rests) {
    {
        const std::lock_guard lock(state_->mutex_);
        if (state_->rests_ == rests) return;
        state_->rests_ = rests;
    }
    state_->changed_.notify_all();
}

SessionUpdate SessionWorker::take() {
    const std::lock_guard lock(state_->mutex_);
    SessionUpdate news = std::move(state_->news_);
    state_->news_ = {};
    return news;
}

} // namespace app::viewer
