#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

#include "app/viewer/session_update.h"
#include "app/viewer/worker_session.h"

namespace app::viewer {

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
