#pragma once

#include <chrono>

#include "app/viewer/program_track.h"
#include "app/viewer/session_update.h"

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

} // namespace app::viewer
