#include "app/guard/motion_judge.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/sim/tool_assembly.h"

namespace app {
namespace {

constexpr double no_travel = 1e-6;         // mm or degrees
constexpr double retreat_tolerance = 0.01; // mm

/// What made a motion not clear, for the operator: the first error, else the first warning.
const core::Finding* worst_finding(const core::BlockResult& result) {
    const core::Finding* worst = nullptr;
    for (const core::Finding& finding : result.findings)
        if (finding.severity != core::Severity::off
            && (!worst || finding.severity > worst->severity))
            worst = &finding;
    return worst;
}

bool has_error(const core::BlockResult& result) {
    return std::any_of(result.findings.begin(), result.findings.end(), [](const auto& finding) {
        return finding.severity == core::Severity::error;
    });
}

LiveAnswer answer_of(const core::BlockResult& result) {
    if (result.checked && result.verdict == core::Verdict::clear && !has_error(result))
        return {.may_move = true};
    const core::Finding* const finding = worst_finding(result);
    if (!finding) return {.reason = "Its clearance cannot be proven."};
    return {.reason = finding->message, .cure = finding->cure};
}

/// Whether only Z moves, upwards.
bool is_straight_up(const core::Motion& motion) {
    for (size_t i = 0; i < core::axis_count; ++i)
        if (i != 2 && motion.from[i] && !(std::abs(*motion.to[i] - *motion.from[i]) <= no_travel))
            return false;
    return motion.kind != core::MotionKind::arc && *motion.to[2] >= *motion.from[2];
}

/// The events with a spindle that stands still, and without motions that end at a contact.
std::vector<core::Event> without_cutting(std::vector<core::Event> events) {
    for (core::Event& event : events) {
        if (auto* const spindle = std::get_if<core::SpindleChange>(&event)) *spindle = {};
        if (auto* const motion = std::get_if<core::Motion>(&event))
            motion->stops_at_contact = false;
    }
    events.insert(events.begin(), core::SpindleChange());
    return events;
}

/// The events up to the first motion, which does not move.
std::vector<core::Event> before_motion(const std::vector<core::Event>& events) {
    std::vector<core::Event> before;
    for (const core::Event& event : events) {
        const auto* const motion = std::get_if<core::Motion>(&event);
        if (!motion) {
            before.push_back(event);
            continue;
        }
        core::Motion rest;
        rest.from = rest.to = motion->from;
        before.emplace_back(rest);
        break;
    }
    return before;
}

} // namespace

bool goes_straight_up(const std::vector<core::Event>& events) {
    return std::all_of(events.begin(), events.end(), [](const core::Event& event) {
        const auto* const motion = std::get_if<core::Motion>(&event);
        return !motion || is_straight_up(*motion);
    });
}

void put_at(core::SimulatorState& state, const core::AxisPosition& position) {
    state.position = position;
    state.spread = {};
    state.corners.last = {};
    state.memory.bounds.clear();
}

MotionJudge::MotionJudge(const core::Setup& setup) : setup_(setup) {
    setup_.search_limit = core::search_limit_of(setup);
    setup_.machine.corner_tolerance = 0.0;
    setup_.machine.rapid_corner_tolerance.reset();
    thorough_ = setup_;
    setup_.detail = core::Detail::verdict;
    thorough_.detail = core::Detail::every_pair;
}

/// Runs events as a block. Without measuring, they are taken to be clear.
core::BlockResult MotionJudge::run(const core::Setup& setup, const std::vector<core::Event>& events,
                                   core::SimulatorState& state, bool measures) {
    const core::Judgement clear;
    return core::run_block(setup,
                           {.block = core::BlockIndex{block_++},
                            .events = events,
                            .judgement = measures ? nullptr : &clear},
                           state);
}

void MotionJudge::follow(const std::vector<core::Event>& events, core::SimulatorState& state) {
    run(setup_, events, state, false);
}

LiveAnswer MotionJudge::judge(const std::vector<core::Event>& events, core::SimulatorState& state) {
    return answer_of(run(setup_, events, state, true));
}

LiveAnswer MotionJudge::judge_with_each_tool(std::vector<core::Event> events,
                                             const core::SimulatorState& state) {
    std::erase_if(events, [](const core::Event& event) {
        return std::holds_alternative<core::ToolChange>(event);
    });
    for (const auto& [number, assembly] : setup_.tools) {
        core::SimulatorState with_tool = state;
        with_tool.tool = number;
        with_tool.tool_known = true;
        with_tool.memory.bounds.clear(); // they are of another tool
        LiveAnswer answer = judge(events, with_tool);
        if (!answer.may_move) return answer;
    }
    return {.may_move = true};
}

std::string MotionJudge::problem_beyond_contact(std::vector<core::Event> events,
                                                core::SimulatorState state) {
    for (core::Event& event : events)
        if (auto* const motion = std::get_if<core::Motion>(&event))
            motion->stops_at_contact = false;
    const core::BlockResult result = run(thorough_, events, state, true);
    for (const core::PairClearance& pair : result.pairs) {
        const bool may_touch = pair.pair.part == core::PartKind::flutes && !pair.pair.fixture;
        if (!may_touch && pair.verdict != core::Verdict::clear)
            return fmt::format("If the probe does not touch the work, it brings {} and {} too near "
                               "to each other.",
                               core::part_name(setup_, pair.pair),
                               core::body_name(setup_, pair.pair));
    }
    return result.checked ? "" : "Its clearance cannot be proven.";
}

LiveAnswer MotionJudge::judge_retreat(std::vector<core::Event> events, double rounding,
                                      core::SimulatorState& state) {
    core::SpindleChange spindle = state.spindle; // behind the events
    for (const core::Event& event : events)
        if (const auto* const change = std::get_if<core::SpindleChange>(&event)) spindle = *change;
    events = without_cutting(std::move(events));
    core::SimulatorState now = state;
    const core::BlockResult before = run(thorough_, before_motion(events), now, true);
    const core::BlockResult result = run(thorough_, events, state, true);
    state.spindle = spindle;
    const auto reached = [&](const core::Pair& pair) {
        return std::find_if(reached_.begin(), reached_.end(),
                            [&](const auto& one) { return one.first == pair; });
    };
    for (const core::PairClearance& pair : before.pairs) {
        const auto known = reached(pair.pair);
        if (known == reached_.end())
            reached_.emplace_back(pair.pair, pair.lower);
        else
            known->second = std::max(known->second, pair.lower);
    }
    // Out of what it has cut, or of what the set-up still takes for stock.
    const bool goes_up = goes_straight_up(events);
    const auto held = state.tool ? setup_.tools.find(*state.tool) : setup_.tools.end();
    const bool may_catch =
        held != setup_.tools.end() && !core::leaves_its_cut_upwards(held->second);
    bool is_caught = false, overlaps = false;
    const double slack = retreat_tolerance + rounding;
    const auto comes_nearer = [&](const core::PairClearance& pair) {
        const auto known = std::find_if(before.pairs.begin(), before.pairs.end(),
                                        [&](const auto& one) { return one.pair == pair.pair; });
        const bool is_known = known != before.pairs.end();
        const bool is_within = is_known && known->verdict == core::Verdict::collision;
        if (goes_up && is_within && !pair.pair.fixture) {
            if (!may_catch) return false;
            is_caught = true;
        }
        if (pair.verdict == core::Verdict::collision) {
            overlaps = is_within;
            return true;
        }
        const double limit = std::max(10.0, 2.0 * pair.allowance.distance);
        const auto best = reached(pair.pair);
        const double at_rest = best != reached_.end() ? best->second : core::infinity;
        return pair.lower < limit && pair.lower < at_rest - slack;
    };
    const auto is_other_error = [](const core::Finding& finding) {
        return finding.severity == core::Severity::error && finding.pair[0].empty();
    };
    const auto other = std::find_if(result.findings.begin(), result.findings.end(), is_other_error);
    if (other != result.findings.end()) return {.reason = other->message, .cure = other->cure};
    if (!result.checked) return {.reason = "Its clearance cannot be proven."};
    const auto nearer = std::find_if(result.pairs.begin(), result.pairs.end(), comes_nearer);
    if (nearer == result.pairs.end()) return {.may_move = true};
    if (is_caught)
        return {.reason =
                    "The tool is wider below than above, so stock above its head may hold it.",
                .cure = "Move it out by hand, the way it went in."};
    if (overlaps)
        return {.reason = fmt::format("In the model, {} and {} overlap already.",
                                      core::part_name(setup_, nearer->pair),
                                      core::body_name(setup_, nearer->pair)),
                .cure = "Move the tool out by hand."};
    return {.reason = fmt::format("It brings {} and {} nearer to each other.",
                                  core::part_name(setup_, nearer->pair),
                                  core::body_name(setup_, nearer->pair))};
}

} // namespace app
