#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

#include "app/check/check_job.h"
#include "app/check/saved_setup.h"
#include "app/view/model/program_track.h"
#include "app/view/model/session_update.h"
#include "render/stock_surface.h"

namespace app::viewer {

/// Turns what a record gains into updates, and keeps what the whole path looks like.
class SessionPublisher {
public:
    /// Another program: all of it is new.
    void begin(std::vector<render::PathPoint> points, size_t rows);
    /// From a block on the program goes another way.
    void begin_again(size_t block, const std::vector<render::PathPoint>& points, size_t rows);

    /// What the record has gained since the last call.
    void publish(const DebugSession& session, SessionUpdate& news);

private:
    using Clock = std::chrono::steady_clock;

    void add_rows(const DebugSession& session, SessionUpdate& news);
    /// The states of the blocks that were checked.
    std::vector<render::ClearanceState> known_states(const CheckRun& run) const;
    void paint_path(const DebugSession& session, SessionUpdate& news);
    /// The first row whose time has been settled since it was sent.
    size_t first_changed(const CheckRun& run) const;

    std::vector<render::PathPoint> points_;
    std::vector<double> durations_;              // as they were sent
    std::vector<render::ClearanceState> states_; // of blocks, but for the findings about them
    size_t rows_ = 0;                            // known to the window
    size_t findings_ = 0;
    bool is_whole_ = false;
    Clock::time_point last_path_ = {};
    Clock::duration path_cost_ = {};
};

/// The set-up of a job that is to be put into a file.
struct SaveRequest {
    CheckJob job;
    std::string path;
    bool may_replace = false;
    FileWriter write;
};

/// What the worker does, all in its thread: a debugging session and what is made of it for the
/// window.
class WorkerSession {
public:
    /// `is_interrupted` is asked on long walks, `is_closing` while a program is opened.
    WorkerSession(std::function<bool()> is_interrupted, std::function<bool()> is_closing)
        : is_interrupted_(std::move(is_interrupted)), is_closing_(std::move(is_closing)) {}

    /// Opens another program; `publish` is called when its path is known, before the stock is.
    void open(const CheckJob& job, const std::function<void()>& publish);
    /// The record as far as it is; null when nothing is open.
    const CheckRun* checked() const { return session_ ? &session_->record() : nullptr; }
    /// Whether there is more to record.
    bool has_work() const { return session_ && (walk_ || !session_->is_recorded()); }
    /// Carries the walk that was asked for on for a slice, else the record.
    void record();
    /// Whether a view needs no more recording.
    bool can_show(const ShowRequest& request) const;
    void show(const ShowRequest& request);
    /// Begins a walk; `record` goes on with it, so that what is found on the way is told.
    void walk(Walk walk, size_t block, uint64_t number);
    void set_breakpoints(const std::vector<Breakpoint>& breakpoints);
    void watch(const std::vector<std::string>& expressions) { watched_ = expressions; }
    void change(const WhatIf& change, size_t block);
    void take_back();
    void save_setup(const SaveRequest& request);

    SessionUpdate take_news();

private:
    using Clock = std::chrono::steady_clock;

    void publish_if_due();
    void walk_on();
    /// The program cannot be opened.
    void fail(const core::Error& error);
    void show_early(ProgramTrack track);
    void refuse(const core::Error& error);
    /// What is drawn of the set-up that a block is run under.
    std::shared_ptr<const SceneSetup> scene_at(size_t block);
    /// The way of the program from the session's place on, which a change has altered.
    void follow_anew();
    std::vector<ShownValue> watched_values(const gcode::InterpreterState& control) const;

    std::function<bool()> is_interrupted_, is_closing_;
    std::unique_ptr<DebugSession> session_;
    SessionPublisher publisher_;
    render::StockSurface surface_;
    std::vector<std::pair<size_t, std::shared_ptr<const SceneSetup>>> scenes_; // by first block
    std::vector<std::string> watched_;
    std::vector<Breakpoint> breakpoints_;
    SessionUpdate news_;
    uint64_t openings_ = 0, views_ = 0;
    /// A walk that has not come to its end, and the block before which it stands.
    struct WalkOnItsWay {
        Walk walk = Walk::go_on;
        size_t block = 0;
        uint64_t number = 0;
    };
    std::optional<WalkOnItsWay> walk_;
    Clock::time_point walk_rests_ = {}; // when others get their turn
    Clock::time_point last_publish_ = {};
};

/// The one thread that owns a debugging session. Requests return at once; what comes of them is in
/// a later update. Between requests the record goes on in slices of some 10 ms, so that a request
/// waits for no more than one of them.
class SessionWorker {
public:
    /// `wake` is called from the thread whenever there is news.
    explicit SessionWorker(std::function<void()> wake);
    /// Ends the check, wherever it is.
    ~SessionWorker();
    SessionWorker(const SessionWorker&) = delete;
    SessionWorker& operator=(const SessionWorker&) = delete;

    void open(const CheckJob& job);
    /// Of several that wait only the last one counts.
    void show(const ShowRequest& request);
    /// From a block on, which itself is passed; what it stops at comes as a WalkEnd with
    /// the number that is returned.
    uint64_t walk(Walk walk, size_t block);
    /// Ends the walks that were asked for so far.
    void interrupt() { interrupted_ = walks_.load(); }
    void set_breakpoints(const std::vector<Breakpoint>& breakpoints);
    /// Expressions that every view shows the values of.
    void watch(const std::vector<std::string>& expressions);
    /// From the place before a block on.
    void change(const WhatIf& change, size_t block);
    void take_back();
    void save_setup(const SaveRequest& request);

    /// What is new since the last call.
    SessionUpdate take();

private:
    using Task = std::function<void(WorkerSession&)>;

    void post(Task task);
    void run();
    void deliver(SessionUpdate news);
    /// The view that is asked for, if it can be made.
    std::optional<ShowRequest> wanted(const WorkerSession& session);

    std::function<void()> wake_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Task> tasks_;
    std::optional<ShowRequest> wanted_;
    SessionUpdate news_;
    std::atomic<bool> stopping_ = false;
    std::atomic<uint64_t> walks_ = 0;       // that were asked for
    std::atomic<uint64_t> interrupted_ = 0; // up to this one
    uint64_t walking_ = 0;                  // the last that was begun, in the worker's thread
    std::thread thread_;                    // last: it uses all of the above
};

} // namespace app::viewer
