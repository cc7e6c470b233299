#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/debug/what_if.h"
#include "app/view/model/session_update.h"

namespace app {
struct CheckJob;
} // namespace app

namespace render {
class StockSurface;
} // namespace render

namespace app::viewer {

class ProgramTrack;

/// A debugging session and its updates for the window, used by one thread.
class WorkerSession {
public:
    /// `is_interrupted` is polled during long walks.
    explicit WorkerSession(std::function<bool()> is_interrupted);
    ~WorkerSession();

    /// Opens a program. Calls `publish` at the start, and when the path is known, before the stock
    /// model is made. The program that is already open goes on until the new set-up is read, and
    /// stays open if that fails. `is_superseded` is polled: true stops opening.
    void open(const CheckJob& job, const std::function<void()>& publish,
              const std::function<bool()>& is_superseded);
    /// The record so far; null: no program is open.
    const CheckRun* checked() const;
    /// Whether there is more to record.
    bool has_work() const;
    /// Continues the requested walk, or else the recording, for one slice.
    void record();
    /// Whether the record already contains the block of a view.
    bool can_show(const ShowRequest& request) const;
    void show(const ShowRequest& request);
    /// Starts a walk. `record` continues it, so updates are published meanwhile.
    void walk(Walk walk, size_t block, uint64_t number);
    void set_breakpoints(const std::vector<Breakpoint>& breakpoints);
    void watch(const std::vector<std::string>& expressions) { watched_ = expressions; }
    void change(const WhatIf& change, size_t block);
    void take_back();

    SessionUpdate take_update();

private:
    using Clock = std::chrono::steady_clock;

    void publish_if_due();
    void walk_on();
    /// Reports that the program cannot be opened.
    void fail(const core::Error& error, bool is_again);
    /// Forgets the open program.
    void begin(const CheckJob& job, bool is_again);
    void show_early(ProgramTrack track);
    void refuse(const core::Error& error);
    /// The set-up in effect for a block, for drawing.
    std::shared_ptr<const SceneSetup> scene_at(size_t block);
    /// Reads the path from the current block on again after a change.
    void restart_following();
    std::vector<ShownValue> watched_values() const;

    std::function<bool()> is_interrupted_;
    std::unique_ptr<DebugSession> session_;
    std::string program_;   // path of the program that was opened last
    bool is_shown_ = false; // its path and set-up were published
    SessionPublisher publisher_;
    std::unique_ptr<render::StockSurface> surface_;
    std::unique_ptr<render::SurfaceMaker> surfaces_;
    std::vector<std::pair<size_t, std::shared_ptr<const SceneSetup>>> scenes_; // by first block
    std::vector<std::string> watched_;
    std::vector<Breakpoint> breakpoints_;
    SessionUpdate news_;
    uint64_t openings_ = 0, views_ = 0;
    /// A walk in progress and its next block.
    struct WalkOnItsWay {
        Walk walk = Walk::go_on;
        size_t block = 0;
        uint64_t number = 0;
    };
    std::optional<WalkOnItsWay> walk_;
    Clock::time_point walk_rests_ = {}; // end of the current slice
    Clock::time_point last_publish_ = {};
};

/// Owns a debugging session in a separate thread. Requests return at once; their results come in a
/// later update. Between requests the worker continues the check in slices of about 10 ms, so a
/// request waits for one slice at most.
class SessionWorker {
public:
    /// `wake` is called from the thread whenever there is an update.
    explicit SessionWorker(std::function<void()> wake);
    /// Aborts the check.
    ~SessionWorker();

    /// Only the last of several waiting requests is answered. Returns the number of the request.
    uint64_t open(const CheckJob& job);
    /// Only the last of several waiting requests is answered.
    void show(const ShowRequest& request);
    /// Walks on from a block, starting with the block after it. Returns the number of the walk; the
    /// result comes as a RunEnd with this number.
    uint64_t walk(Walk walk, size_t block);
    /// Interrupts the walks requested so far.
    void interrupt();
    void set_breakpoints(const std::vector<Breakpoint>& breakpoints);
    /// Sets the expressions whose values every view includes.
    void watch(const std::vector<std::string>& expressions);
    /// Applies a change that takes effect from a block on.
    void change(const WhatIf& change, size_t block);
    void take_back();

    /// While it rests, the check does not go on; requests are answered as far as it has come.
    void rest(bool rests);

    /// What is new since the last call.
    SessionUpdate take();

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace app::viewer
