#include "app/check/run_state.h"

#include <bit>

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

void add(StateDigest& digest, const core::SimulatorState& machine) {
    for (const core::ScanLines& family : machine.stock.lines.families) add(digest, family);
    add(digest, machine.stock.columns);
    digest.add(machine.stock.log.size());
    digest.add(machine.stock.volume_owed);
    for (const auto& value : machine.position) {
        digest.add(uint64_t(value.has_value()));
        digest.add(value.value_or(0.0));
    }
    digest.add(machine.tool ? uint64_t(core::value_of(*machine.tool)) + 1 : 0);
    digest.add(uint64_t(machine.tool_known));
    for (const bool is_there : machine.mounted_fixtures) digest.add(uint64_t(is_there));
    digest.add(static_cast<uint64_t>(machine.spindle.direction));
    digest.add(machine.spindle.speed);
    digest.add(machine.length_offset.length);
    digest.add(machine.time);
    digest.add(machine.corners.by);
    digest.add(machine.corners.of_cuts);
}

} // namespace

RunState start_of_program(const gcode::Environment& environment, const core::Setup& setup,
                          core::SimulatorState machine) {
    return {gcode::initial_state(environment), gcode::initial_lowering(environment),
            std::move(machine), core::start_clock(setup.machine)};
}

uint64_t digest_of(const RunState& state) {
    StateDigest digest;
    digest.add(gcode::digest_of(state.control));
    digest.add(uint64_t(state.control.next_block));
    add(digest, state.machine);
    digest.add(state.clock.time);
    digest.add(uint64_t(state.clock.first_open));
    return digest.value;
}

} // namespace app
