#include "app/check/dog_legs.h"

#include <algorithm>

#include "app/check/block_runner.h"
#include "core/motion/kinematics.h"
#include "core/motion/path.h"
#include "core/sim/clearance.h"
#include "core/sim/moving_body.h"
#include "gcode/language/control.h"
#include "gcode/language/environment.h"

namespace app {
namespace {

/// Whether a dog-leg differs from the straight motion.
bool may_bend(const core::Event& event) {
    const auto* motion = std::get_if<core::Motion>(&event);
    if (!motion || motion->kind != core::MotionKind::rapid || motion->tip) return false;
    size_t moving = 0;
    for (size_t axis = 0; axis < core::axis_count; ++axis)
        moving += motion->from[axis] && motion->to[axis] && motion->from[axis] != motion->to[axis];
    return moving > 1;
}

/// Whether a body comes near the stock or a fixture on a leg, by their boxes.
bool comes_near(const core::Setup& setup, const core::MovingBody& body, const core::Leg& leg,
                const core::Aabb& stock) {
    constexpr double slack = 1.0; // mm
    core::Pair pair{body.kind, {}, body.carried};
    const auto is_near = [&](const core::Aabb& box) {
        const core::RelativeLeg way = core::leg_against(setup, pair.fixture, body, leg);
        const double margin = core::allowance_of(setup, pair).distance + slack;
        return core::overlaps(core::bounds(body, way).grown(margin), box);
    };
    if (is_near(stock)) return true;
    for (size_t i = 0; i < setup.fixtures.size(); ++i) {
        const core::Fixture& fixture = setup.fixtures[i];
        pair.fixture = i;
        if (!core::is_exempt(setup.machine, body, fixture) && is_near(core::bounds(fixture.body)))
            return true;
    }
    return false;
}

/// Whether all rapids of a block stay far from everything also as dog-legs, by boxes alone. False
/// if that is not known.
bool stays_away(const core::Setup& setup, const core::BlockEvents& block,
                const core::SimulatorState& before) {
    const auto tool = before.tool ? setup.tools.find(*before.tool) : setup.tools.end();
    if (tool == setup.tools.end() || setup.machine.has_rotary()) return false;
    const std::vector<core::MovingBody> bodies = core::moving_bodies(setup, tool->second);
    for (const core::Event& event : block.events) {
        const auto* motion = std::get_if<core::Motion>(&event);
        if (!motion || motion->stops_at_contact || before.spread != core::AxisSpread{})
            return false;
        if (!may_bend(event)) continue;
        const core::Path path =
            core::path_of(*motion, setup.machine, core::chord_error(setup.mesh_size));
        for (const core::Leg& leg : path.legs)
            for (const core::MovingBody& body : bodies)
                if (comes_near(setup, body, leg, before.stock.outer_box)) return false;
        if (path.legs.empty()) return false;
    }
    return true;
}

} // namespace

const gcode::ControlParameter* open_rapid_parameter(const gcode::Environment& environment) {
    constexpr auto question = gcode::ControlQuestion::rapids_are_straight;
    const gcode::ControlSettings& control = environment.control;
    if (!control.reports_premises || control.number(question)) return nullptr;
    const auto* parameter = gcode::find_parameter(question, environment.dialect);
    return parameter && parameter->is_open() ? parameter : nullptr;
}

DogLegTrial::DogLegTrial(const core::Setup& setup) : setup_(setup) {
    setup_.machine.rapid = core::RapidStyle::dogleg;
    setup_.detail = core::Detail::verdict;
}

std::optional<core::BlockResult> DogLegTrial::run(const core::BlockEvents& block,
                                                  const core::SimulatorState& before) const {
    if (block.path != core::PathCertainty::known) return std::nullopt;
    const auto last = std::find_if(block.events.rbegin(), block.events.rend(), may_bend);
    if (last == block.events.rend()) return std::nullopt;
    if (stays_away(setup_, block, before)) return std::nullopt;
    core::BlockEvents trial = block;
    trial.events = block.events.first(static_cast<size_t>(block.events.rend() - last));
    trial.judgement = nullptr;
    trial.is_trial = true;
    core::SimulatorState state = before;
    return core::run_block(setup_, trial, state);
}

std::optional<DogLegResult> worse_than(const core::BlockResult& straight,
                                       const core::BlockResult& dog_leg) {
    if (dog_leg.verdict <= straight.verdict) return std::nullopt;
    DogLegResult result{dog_leg.verdict, {}};
    for (const core::Finding& finding : dog_leg.findings) {
        const auto is_same = [&](const core::Finding& other) {
            return other.rule == finding.rule && other.pair == finding.pair;
        };
        if (finding.severity == core::Severity::error
            && std::none_of(straight.findings.begin(), straight.findings.end(), is_same))
            result.errors.push_back(finding);
    }
    return result;
}

} // namespace app
