#pragma once

#include <map>
#include <optional>

#include "app/session/control_walk.h"
#include "app/session/debug_session.h"
#include "app/session/inspected_value.h"

namespace app {

/// One walk of a session, forwards or back, to the first place that something speaks for stopping
/// at.
class SessionWalk {
public:
    explicit SessionWalk(DebugSession& session);

    /// What is walked to, besides breakpoints and watches: asked of every block on the way, in
    /// order, with the control before it where `asks_control`.
    struct Goal {
        std::function<bool(size_t block, const gcode::InterpreterState* control)> is_reached;
        bool asks_control = false;
        StopReason reason = StopReason::found;
    };
    Stop forwards(const Goal& goal);
    Stop backwards(const Goal& goal);

    /// Whether a finding of severity error is about a block, or it is not proven to keep its
    /// allowances.
    bool offends(size_t block);
    bool changes_tool(size_t block) const;
    /// How many subprograms deep a block is; 0 for one that is not known.
    size_t depth(size_t block) const;

private:
    /// The findings about a block.
    struct Findings {
        std::vector<std::string> rules;
        bool has_error = false;
    };

    bool asks_control(const Goal& goal) const;
    bool is_interrupted() const;
    Stop stop_at(size_t place, Stop stop);
    /// Behind the last block that can be run.
    Stop stop_at_end(size_t place);
    /// The breakpoint that a block is at, as far as its conditions go.
    Breakpoint* breakpoint_at(size_t block, const gcode::InterpreterState* control);
    /// The same on the way forwards, where it may let so many runs pass.
    Breakpoint* breakpoint_reached(size_t block, const gcode::InterpreterState* control);
    bool stops_before(const Breakpoint& breakpoint, size_t block,
                      const gcode::InterpreterState* control);
    /// What speaks for stopping before a block, if it is reached going back.
    std::optional<Stop> found_going_back(size_t block, const gcode::InterpreterState* control,
                                         const Goal& goal);
    /// The values of all watches.
    std::vector<InspectedValue> values(const gcode::InterpreterState* control) const;
    std::optional<Stop> changed_watch(const std::vector<InspectedValue>& before,
                                      const std::vector<InspectedValue>& after) const;
    /// The last place of a stretch, ends included, that a walk back stops at.
    std::optional<std::pair<size_t, Stop>> last_stop(size_t first, size_t last, const Goal& goal);
    const Findings* findings_of(size_t block);

    DebugSession& session_;
    std::map<uint32_t, Findings> findings_ = {};
    size_t findings_read_ = 0;
    bool read_complete_ = false;
};

} // namespace app
