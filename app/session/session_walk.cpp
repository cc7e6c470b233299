#include "app/session/session_walk.h"

#include <algorithm>

#include <fmt/format.h>

namespace app {

SessionWalk::SessionWalk(DebugSession& session) : session_(session) {}

size_t SessionWalk::depth(size_t block) const {
    const auto& blocks = session_.record().blocks;
    return block < blocks.size() ? blocks[block].calls.size() : 0;
}

bool SessionWalk::changes_tool(size_t block) const {
    const CheckRun& record = session_.record();
    if (block >= session_.run_->last_place()) return false; // it is not run
    const auto before =
        block == 0 ? record.setup.tool_at_start : record.blocks[block - 1].result.tool;
    return record.blocks[block].result.tool != before;
}

const SessionWalk::Findings* SessionWalk::findings_of(size_t block) {
    const CheckRun& record = session_.record();
    // Once the record is complete, its findings are in another order, and some are taken in.
    if (read_complete_ != session_.is_recorded() || findings_read_ > record.findings.size()) {
        findings_.clear();
        findings_read_ = 0;
        read_complete_ = session_.is_recorded();
    }
    const auto read = [&](const core::Finding& finding, bool is_told) {
        if (!finding.block) return;
        Findings& of_block = findings_[core::value_of(*finding.block)];
        of_block.rules.push_back(finding.rule);
        of_block.has_error |= is_told && finding.severity == core::Severity::error;
    };
    if (findings_read_ == 0)
        for (const core::Finding& finding : record.taken_in) read(finding, false);
    for (; findings_read_ < record.findings.size(); ++findings_read_)
        read(record.findings[findings_read_], true);
    const auto found = findings_.find(static_cast<uint32_t>(block));
    return found == findings_.end() ? nullptr : &found->second;
}

bool SessionWalk::offends(size_t block) {
    const Findings* findings = findings_of(block);
    return (findings && findings->has_error)
           || session_.record().blocks[block].result.verdict != core::Verdict::clear;
}

bool SessionWalk::asks_control(const Goal& goal) const {
    const auto asks = [](const Breakpoint& point) {
        return point.enabled && point.condition && point.condition->asks_control();
    };
    const auto is_on = [](const Watch& watch) { return watch.enabled; };
    return goal.asks_control
           || std::any_of(session_.breakpoints_.begin(), session_.breakpoints_.end(), asks)
           || std::any_of(session_.watches_.begin(), session_.watches_.end(), is_on);
}

bool SessionWalk::is_interrupted() const {
    return session_.is_interrupted && session_.is_interrupted();
}

bool SessionWalk::stops_before(const Breakpoint& breakpoint, size_t block,
                               const gcode::InterpreterState* control) {
    const CheckRun& record = session_.record();
    const CheckedBlock& at = record.blocks[block];
    if (!breakpoint.enabled) return false;
    if (breakpoint.line && (at.line != *breakpoint.line || at.file != breakpoint.file))
        return false;
    if (breakpoint.tool && (at.result.tool != breakpoint.tool || !changes_tool(block)))
        return false;
    if (!breakpoint.rule.empty()) {
        const Findings* findings = findings_of(block);
        const bool any = breakpoint.rule == "finding";
        if (!findings
            || (!any
                && std::find(findings->rules.begin(), findings->rules.end(), breakpoint.rule)
                       == findings->rules.end()))
            return false;
    }
    return !breakpoint.condition
           || breakpoint.condition->holds({record, block, control, &session_.environment()});
}

Breakpoint* SessionWalk::breakpoint_at(size_t block, const gcode::InterpreterState* control) {
    for (Breakpoint& breakpoint : session_.breakpoints_)
        if (stops_before(breakpoint, block, control)) return &breakpoint;
    return nullptr;
}

Breakpoint* SessionWalk::breakpoint_reached(size_t block, const gcode::InterpreterState* control) {
    for (Breakpoint& breakpoint : session_.breakpoints_) {
        if (!stops_before(breakpoint, block, control)) continue;
        if (breakpoint.ignore == 0) return &breakpoint;
        --breakpoint.ignore;
    }
    return nullptr;
}

std::vector<InspectedValue> SessionWalk::values(const gcode::InterpreterState* control) const {
    std::vector<InspectedValue> values;
    for (const Watch& watch : session_.watches_) {
        const bool is_asked = watch.enabled && control;
        values.push_back(is_asked ? value_of(watch.expression, *control, session_.environment())
                                        .value_or(InspectedValue{})
                                  : InspectedValue{});
    }
    return values;
}

std::optional<Stop> SessionWalk::changed_watch(const std::vector<InspectedValue>& before,
                                               const std::vector<InspectedValue>& after) const {
    for (size_t i = 0; i < before.size(); ++i) {
        if (before[i] == after[i]) continue;
        Watch& watch = session_.watches_[i];
        return Stop{StopReason::watch, watch.id,
                    fmt::format("{}: {} -> {}", watch.expression, before[i].text, after[i].text)};
    }
    return std::nullopt;
}

Stop SessionWalk::stop_at(size_t place, Stop stop) {
    [[maybe_unused]] const auto gone = session_.go_to(place);
    if (stop.reason == StopReason::watch)
        for (Watch& watch : session_.watches_)
            if (watch.id == stop.id) ++watch.hits;
    if (stop.reason != StopReason::breakpoint) return stop;
    for (Breakpoint& breakpoint : session_.breakpoints_)
        if (breakpoint.id == stop.id) ++breakpoint.hits;
    std::erase_if(session_.breakpoints_, [&](const Breakpoint& breakpoint) {
        return breakpoint.id == stop.id && breakpoint.temporary;
    });
    return stop;
}

Stop SessionWalk::stop_at_end(size_t place) {
    return stop_at(place, {session_.record().stopped ? StopReason::error : StopReason::end});
}

Stop SessionWalk::forwards(const Goal& goal) {
    std::optional<ControlWalk> walk;
    if (asks_control(goal)) walk.emplace(*session_.run_, session_.at_);
    std::vector<InspectedValue> before = values(walk ? &walk->control() : nullptr);
    for (size_t place = session_.at_ + 1;; ++place) {
        if (!session_.knows(place - 1)) return stop_at_end(place - 1);
        if (walk) walk->advance();
        const gcode::InterpreterState* control = walk ? &walk->control() : nullptr;
        std::vector<InspectedValue> after = values(control);
        if (const auto changed = changed_watch(before, after)) return stop_at(place, *changed);
        before = std::move(after);
        // The block of an alarm is not run, but one may have looked for it.
        const bool is_run = session_.knows(place);
        if (place == session_.record().blocks.size()) return stop_at_end(place);
        if (const Breakpoint* breakpoint = breakpoint_reached(place, control))
            return stop_at(place, {StopReason::breakpoint, breakpoint->id});
        if (goal.is_reached && goal.is_reached(place, control))
            return stop_at(place, {goal.reason});
        if (!is_run) return stop_at_end(place);
        if (is_interrupted()) return stop_at(place, {StopReason::interrupted});
    }
}

std::optional<Stop> SessionWalk::found_going_back(size_t block,
                                                  const gcode::InterpreterState* control,
                                                  const Goal& goal) {
    if (const Breakpoint* breakpoint = breakpoint_at(block, control))
        return Stop{StopReason::breakpoint, breakpoint->id};
    if (goal.is_reached && goal.is_reached(block, control)) return Stop{goal.reason};
    return std::nullopt;
}

std::optional<std::pair<size_t, Stop>> SessionWalk::last_stop(size_t first, size_t last,
                                                              const Goal& goal) {
    std::optional<std::pair<size_t, Stop>> found;
    ControlWalk walk(*session_.run_, first);
    for (size_t place = first; place <= last; ++place) {
        if (const auto stop = found_going_back(place, &walk.control(), goal))
            found.emplace(place, *stop);
        const std::vector<InspectedValue> before = values(&walk.control());
        walk.advance();
        if (const auto changed = changed_watch(before, values(&walk.control())))
            found.emplace(place, *changed);
    }
    return found;
}

Stop SessionWalk::backwards(const Goal& goal) {
    const bool with_control = asks_control(goal);
    size_t behind = session_.at_; // places from here on have been looked at
    while (behind > 0) {
        const size_t last = behind - 1;
        // The control can only be followed forwards, so it is followed from the keyframe before.
        const size_t first = with_control ? session_.run_->keyframes().before(last).blocks : last;
        if (with_control) {
            if (const auto found = last_stop(first, last, goal))
                return stop_at(found->first, found->second);
        } else if (const auto stop = found_going_back(last, nullptr, goal)) {
            return stop_at(last, *stop);
        }
        behind = first;
        if (is_interrupted()) return stop_at(behind, {StopReason::interrupted});
    }
    return stop_at(0, {StopReason::beginning});
}

} // namespace app
