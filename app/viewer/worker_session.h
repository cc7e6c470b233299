#pragma once

#include "app/report/saved_setup.h"
#include "app/viewer/session_publisher.h"
#include "render/stock_surface.h"

namespace app::viewer {

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

} // namespace app::viewer
