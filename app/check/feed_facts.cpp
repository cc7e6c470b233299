#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/check/feed_use.h"
#include "core/base/math.h"
#include "core/motion/event.h"
#include "core/sim/run/simulator.h"
#include "core/sim/setup.h"
#include "gcode/language/modal_state.h"

namespace app {
namespace {

/// Travel of the linear axes, mm; empty if an end is unknown.
std::optional<core::AxisValues> linear_travel(const core::Motion& motion) {
    core::AxisValues by = {};
    for (size_t i = 0; i < core::axis_count; ++i) {
        if (core::is_rotary(i)) continue;
        if (motion.from[i].has_value() != motion.to[i].has_value()) return std::nullopt;
        if (motion.from[i]) by[i] = *motion.to[i] - *motion.from[i];
    }
    return by;
}

bool turns_axes(const core::Motion& motion) {
    for (size_t i = 3; i < 6; ++i)
        if (motion.from[i] != motion.to[i]) return true;
    return false;
}

double length_of(const core::Motion& motion, const core::AxisValues& by) {
    if (!motion.arc) return core::fed_length(by);
    const auto normal = static_cast<size_t>(motion.arc->normal);
    double radius = 0.0;
    for (size_t i = 0; i < 3; ++i)
        if (i != normal)
            radius = core::hypot(radius, *motion.from[i] - motion.arc->centre[static_cast<int>(i)]);
    return core::hypot(radius * motion.arc->angle, by[normal]);
}

/// Whether a motion of the block is not an incremental one by 0.
bool moves(const gcode::ModalState& modal, const core::BlockEvents& block) {
    const bool may_stay = modal.distance == gcode::DistanceMode::incremental && !block.goes_home;
    return std::any_of(block.events.begin(), block.events.end(), [&](const core::Event& event) {
        const auto* motion = std::get_if<core::Motion>(&event);
        return motion && (!may_stay || motion->arc || motion->from != motion->to);
    });
}

/// The fastest feed along a straight line that the rapid speeds of the axes allow, mm/min; empty if
/// an axis that moves has no stated speed.
std::optional<double> fastest_along(const core::Machine& machine, const core::AxisValues& by) {
    const double length = core::fed_length(by);
    double fastest = core::infinity;
    for (size_t i = 0; i < core::axis_count; ++i) {
        if (by[i] == 0.0) continue;
        if (!machine.axes[i].rapid) return std::nullopt;
        fastest = std::min(fastest, *machine.axes[i].rapid * length / std::abs(by[i]));
    }
    return fastest;
}

void keep_greatest(std::optional<ValueInBlock>& greatest, double value, core::BlockIndex block) {
    if (!greatest || value > greatest->value) greatest = {value, block};
}

void note_speeds(FeedFacts& facts, const core::Setup& setup, const core::Motion& motion,
                 const core::AxisValues& by, core::BlockIndex block) {
    keep_greatest(facts.fastest, motion.feed, block);
    constexpr double rounding = 1.001;
    const auto possible = motion.arc ? std::optional<double>() : fastest_along(setup.machine, by);
    if (facts.too_fast || !possible || motion.feed <= rounding * *possible) return;
    facts.too_fast = {motion.feed, block};
    facts.possible = *possible;
}

void note_spindle(FeedFacts& facts, const core::Setup& setup, const core::SimulatorState& state,
                  core::BlockIndex block) {
    keep_greatest(facts.speed, state.spindle.speed, block);
    if (!state.tool) return;
    facts.tools.try_emplace(*state.tool, block);
    const auto tool = setup.tools.find(*state.tool);
    if (tool == setup.tools.end()) return;
    constexpr double mm_per_metre = 1000.0;
    keep_greatest(facts.edge_speed,
                  std::numbers::pi * tool->second.description.diameter * state.spindle.speed
                      / mm_per_metre,
                  block);
}

} // namespace

void note_feeds(FeedFacts& facts, const core::Setup& setup, const gcode::ModalState& modal,
                const core::BlockEvents& block, const core::SimulatorState& state) {
    facts.moves = facts.moves || moves(modal, block);
    for (const core::Event& event : block.events) {
        const auto* motion = std::get_if<core::Motion>(&event);
        if (!motion || motion->kind == core::MotionKind::rapid) continue;
        for (const core::AxisPosition& end : {motion->from, motion->to}) {
            if (!end[0] || !end[1] || !end[2]) continue;
            facts.box.extend(core::Vec3(*end[0], *end[1], *end[2]));
            if (!facts.first) facts.first = block.block;
        }
        const bool is_inch = modal.unit == gcode::LengthUnit::inch;
        (is_inch ? facts.in_inches : facts.in_mm) = true;
        if (state.spindle.direction != core::SpindleDirection::stopped)
            note_spindle(facts, setup, state, block.block);
        const auto by = linear_travel(*motion);
        // The feed of other motions is a time, or counts degrees.
        const bool counts = by && modal.feed_mode != gcode::FeedMode::inverse_time
                            && !turns_axes(*motion) && motion->feed > 0.0;
        const double length = counts ? length_of(*motion, *by) : 0.0;
        if (length <= 0.0) continue;
        note_speeds(facts, setup, *motion, *by, block.block);
        if (core::hypot((*by)[0], (*by)[1]) > 0.0 || motion->arc)
            facts.sideways = std::max(facts.sideways, motion->feed);
        constexpr double by_hand = 1.0; // rev/min, stands for any speed
        if (state.spindle.speed <= by_hand) continue;
        facts.cut_way += length;
        facts.revolutions += length / motion->feed * state.spindle.speed;
    }
}

} // namespace app
