#include "app/check/run_state.h"

#include <bit>

#include "core/motion/path.h"
#include "core/sim/setup.h"
#include "gcode/language/environment.h"

namespace app {
namespace {

/// FNV-1a over words of 64 bits.
struct StateDigest {
    uint64_t value = 1469598103934665603ULL;

    void add(uint64_t word) { value = (value ^ word) * 1099511628211ULL; }
    void add(double number) { add(std::bit_cast<uint64_t>(number)); }
};

void add(StateDigest& digest, const core::ScanLines& lines) {
    for (int v = 0; v < lines.v_count(); ++v)
        for (int u = 0; u < lines.u_count(); ++u) {
            const core::LineView line = lines.line(u, v);
            digest.add(line.size());
            for (size_t i = 0; i < line.size(); ++i) {
                digest.add(line[i].lower);
                digest.add(line[i].upper);
                const core::EndMarks marks = lines.marks(u, v, i);
                digest.add(uint64_t(marks.lower) << 32 | marks.upper);
                digest.add(uint64_t(marks.lower_tilt) << 8 | marks.upper_tilt);
            }
        }
}

void add(StateDigest& digest, const core::CutModel& stock) {
    for (const core::ScanLines& family : stock.lines.families) add(digest, family);
    add(digest, stock.columns);
    digest.add(stock.log.size());
    digest.add(stock.volume_owed);
}

void add(StateDigest& digest, const core::CornerLimit& limit) {
    digest.add(limit.deviation);
    digest.add(limit.distance);
    digest.add(limit.blended);
}

void add(StateDigest& digest, const core::RoundedCorners& corners) {
    digest.add(corners.by);
    digest.add(corners.by_arc);
    digest.add(corners.of_cuts);
    digest.add(corners.mode_of_cuts);
    digest.add(corners.by_axes_of_cuts);
    digest.add(uint64_t(corners.has_cut));
    digest.add(corners.own.tool ? uint64_t(core::value_of(*corners.own.tool)) + 1 : 0);
    digest.add(corners.own.by);
    digest.add(uint64_t(corners.own.since_tool));
    digest.add(uint64_t(corners.own.since_mode));
    add(digest, corners.rapids);
    add(digest, corners.mixed);
    add(digest, corners.arcs);
    add(digest, corners.turns);
    digest.add(corners.last.by);
    digest.add(corners.left_after);
    digest.add(corners.off_after);
    for (const core::AxisValues& position : corners.last.joined)
        for (const double value : position) digest.add(value);
    digest.add(corners.last.kind ? uint64_t(*corners.last.kind) + 1 : 0);
    for (const auto* legs : {&corners.last.legs, &corners.last.rest})
        for (const core::Leg& leg : *legs)
            for (const core::AxisValues& position : leg.positions)
                for (const double value : position) digest.add(value);
    digest.add(corners.tool ? uint64_t(core::value_of(*corners.tool)) + 1 : 0);
    digest.add(uint64_t(corners.by_several));
}

void add(StateDigest& digest, const core::SimulatorState& machine) {
    add(digest, machine.stock);
    if (machine.certain_stock) add(digest, *machine.certain_stock);
    digest.add(machine.memory.passages.size());
    for (const auto& [fixture, cuts] : machine.memory.cuts) digest.add(cuts.size());
    digest.add(uint64_t(machine.centre.trail.size()));
    digest.add(machine.centre.top);
    for (const auto& value : machine.position) {
        digest.add(uint64_t(value.has_value()));
        digest.add(value.value_or(0.0));
    }
    for (const core::AxisValues& side : {machine.spread.below, machine.spread.above})
        for (const double by : side) digest.add(by);
    digest.add(machine.tool ? uint64_t(core::value_of(*machine.tool)) + 1 : 0);
    digest.add(uint64_t(machine.tool_known));
    for (const bool is_there : machine.mounted_fixtures) digest.add(uint64_t(is_there));
    for (const bool is_assumed : machine.is_assumed) digest.add(uint64_t(is_assumed));
    digest.add(static_cast<uint64_t>(machine.spindle.direction));
    digest.add(machine.spindle.speed);
    digest.add(machine.length_offset.length);
    digest.add(uint64_t(machine.length_offset.is_assumed));
    digest.add(uint64_t(machine.height_is_assumed));
    digest.add(machine.time);
    add(digest, machine.corners);
}

} // namespace

RunState start_of_program(const gcode::Environment& environment, const core::Setup& setup,
                          core::SimulatorState machine) {
    RunState start{gcode::initial_state(environment), gcode::initial_lowering(environment),
                   std::move(machine), core::start_clock(setup.machine)};
    const gcode::SetPathMode mode = gcode::path_mode_of(start.control.modal);
    if (mode == gcode::path_mode_of({})) return start;
    // Start-up code has set it.
    for (const core::Event& event : gcode::Lowering(start.lowering).lower(mode))
        if (const auto* change = std::get_if<core::PathModeChange>(&event)) {
            core::change_mode(start.machine.corners, *change, setup.machine);
            start.clock.plan.blending = change->blending;
            start.clock.plan.tolerance = change->tolerance.value_or(core::default_blend_tolerance);
        }
    return start;
}

uint64_t digest_of(const RunState& state) {
    StateDigest digest;
    digest.add(gcode::digest_of(state.control));
    digest.add(uint64_t(state.control.next_block));
    add(digest, state.machine);
    digest.add(state.clock.time);
    digest.add(uint64_t(state.said_displaced));
    digest.add(uint64_t(state.clock.first_open));
    return digest.value;
}

} // namespace app
