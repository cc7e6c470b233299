#include "app/tolerance/recorded_motions.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "app/check/block_events.h"
#include "app/check/prepared_check.h"
#include "core/base/math.h"
#include "core/motion/machine.h"
#include "core/motion/path.h"
#include "gcode/exec/interpreter.h"
#include "gcode/lower/lowering.h"

namespace app {
namespace {

constexpr size_t most_events = 5'000'000;
constexpr size_t most_kinds = 40;    // of displacements in a program
constexpr double equal_shift = 1e-6; // mm per mm; displacements that differ by less are equal

/// Finds or adds a displacement. Empty if there are too many different ones.
std::optional<uint16_t> kind_of(std::vector<core::AxisValues>& kinds,
                                const core::AxisValues& shift) {
    for (size_t i = 0; i < kinds.size(); ++i) {
        bool equal = true;
        for (size_t axis = 0; axis < core::axis_count; ++axis)
            equal = equal && std::abs(kinds[i][axis] - shift[axis]) < equal_shift;
        if (equal) return static_cast<uint16_t>(i);
    }
    constexpr size_t most = 1000;
    if (kinds.size() == most) return std::nullopt;
    kinds.push_back(shift);
    return static_cast<uint16_t>(kinds.size() - 1);
}

/// The displacement of a position per mm; empty if the positions do not correspond.
std::optional<core::AxisValues> shift_between(const core::AxisPosition& a,
                                              const core::AxisPosition& b, double by) {
    core::AxisValues shift{};
    for (size_t axis = 0; axis < core::axis_count; ++axis) {
        if (a[axis].has_value() != b[axis].has_value()) return std::nullopt;
        if (!a[axis]) continue;
        shift[axis] = (*b[axis] - *a[axis]) / by;
        if (core::is_rotary(axis) && std::abs(shift[axis]) > equal_shift) return std::nullopt;
        // Without this, rounding in the ninth decimal would become a displacement.
        shift[axis] = core::round(shift[axis] * 1e7) * 1e-7;
    }
    return shift;
}

bool equal(double a, double b) { return std::abs(a - b) < 1e-6; }

/// Whether two events other than motions do the same.
bool same_change(const core::Event& a, const core::Event& b) {
    if (const auto* change = std::get_if<core::ToolChange>(&a))
        return change->tool == std::get<core::ToolChange>(b).tool;
    if (const auto* spindle = std::get_if<core::SpindleChange>(&a)) {
        const auto& other = std::get<core::SpindleChange>(b);
        return spindle->direction == other.direction && equal(spindle->speed, other.speed);
    }
    if (const auto* mode = std::get_if<core::PathModeChange>(&a)) {
        const auto& other = std::get<core::PathModeChange>(b);
        return mode->blending == other.blending && mode->tolerance == other.tolerance
               && mode->joining == other.joining && mode->distance == other.distance
               && mode->rapid_tolerance == other.rapid_tolerance
               && mode->rapid_distance == other.rapid_distance
               && mode->between_kinds == other.between_kinds && mode->blends == other.blends
               && mode->blends_at_arcs == other.blends_at_arcs;
    }
    if (const auto* fixture = std::get_if<core::FixtureChange>(&a)) {
        const auto& other = std::get<core::FixtureChange>(b);
        return fixture->fixture == other.fixture && fixture->is_there == other.is_there;
    }
    return true; // a dwell, or a length that the motions show
}

/// Whether two motions have the same form: only their places differ.
bool same_form(const core::Motion& a, const core::Motion& b, const core::AxisValues& from,
               const core::AxisValues& to, double by) {
    if (a.kind != b.kind || a.arc.has_value() != b.arc.has_value()
        || a.tip.has_value() != b.tip.has_value())
        return false;
    if (!a.arc) return true;
    if (a.arc->normal != b.arc->normal || std::abs(a.arc->angle - b.arc->angle) > equal_shift)
        return false;
    for (int axis = 0; axis < 3; ++axis) {
        const double shift = (b.arc->centre[axis] - a.arc->centre[axis]) / by;
        const auto i = static_cast<size_t>(axis);
        if (axis != a.arc->normal
            && (std::abs(shift - to[i]) > 1e-5 || std::abs(from[i] - to[i]) > 1e-5))
            return false;
    }
    return true;
}

core::PathCertainty certainty_of(const PreparedCheck& check, const gcode::BlockCommands& block,
                                 std::span<const core::Event> events) {
    const bool is_displaced = !check.file.has_axes && displaced_axis(events);
    return is_displaced ? std::max(block.path, core::PathCertainty::pose_unknown) : block.path;
}

} // namespace

core::Result<RecordedMotions> record_motions(const PreparedCheck& check,
                                             const gcode::Environment& environment,
                                             const Choices& choices) {
    RecordedMotions recorded{.choices = choices};
    gcode::Environment observed = environment;
    observed.on_system_read = [&](double value) {
        if (recorded.system_reads.size() <= most_events) recorded.system_reads.push_back(value);
    };
    gcode::Interpreter interpreter(*check.library, observed);
    gcode::InterpreterState control = gcode::initial_state(observed);
    if (!choices.empty()) control.readings.write().chosen = choices;
    gcode::Lowering lowering = gcode::initial_lowering(observed);
    core::AxisSet uncertain = 0; // axes that a probing move may have stopped anywhere
    while (true) {
        const auto next = interpreter.next(control);
        if (!next) recorded.alarm = next.error();
        if (!next || !*next) break;
        const gcode::BlockCommands& block = **next;
        const std::vector<core::Event> events =
            events_of(check.run.setup, block, lowering, check.file.speed_by_hand);
        if (events.empty()) continue;
        recorded.blocks.push_back({block.block, block.line, std::string(block.file), block.is_cycle,
                                   block.goes_home, certainty_of(check, block, events)});
        for (const core::Event& event : events) {
            const auto* motion = std::get_if<core::Motion>(&event);
            const core::AxisSet before = uncertain;
            if (motion) uncertain = uncertain_after(*motion, uncertain);
            core::PathCertainty& path = recorded.blocks.back().path;
            if (before != 0 || uncertain != 0) path = std::max(path, core::PathCertainty::doubtful);
            recorded.events.push_back(event);
            recorded.block_of.push_back(static_cast<uint32_t>(recorded.blocks.size() - 1));
        }
        if (std::max(recorded.events.size(), recorded.system_reads.size()) > most_events)
            return core::fail(core::ErrorCode::unsupported,
                              "the program has more than five million motions");
    }
    recorded.met = control.readings->met;
    return recorded;
}

core::Result<std::vector<RecordedMotions>> record_readings(const PreparedCheck& check) {
    constexpr size_t most_recordings = 16;
    std::vector<RecordedMotions> recordings;
    std::vector<Choices> open = {{}};
    for (size_t i = 0; i < open.size(); ++i) {
        FEELER_TRY(RecordedMotions recorded,
                   record_motions(check, check.file.environment, open[i]));
        Choices before = open[i];
        for (const gcode::OpenPremise& premise : recorded.met) {
            if (premise.is_chosen) continue;
            for (size_t other = 0; other < premise.readings.size(); ++other) {
                if (other == premise.taken) continue;
                open.push_back(before);
                open.back()[premise.id] = other;
            }
            before[premise.id] = premise.taken;
        }
        recordings.push_back(std::move(recorded));
        if (open.size() > most_recordings)
            return core::fail(core::ErrorCode::unsupported,
                              "the control may read the program in more than 16 ways");
    }
    return recordings;
}

const RecordedBlock* uncertain_block(const RecordedMotions& motions) {
    for (size_t i = 0; i < motions.events.size(); ++i) {
        const RecordedBlock& block = motions.blocks[motions.block_of[i]];
        if (std::holds_alternative<core::Motion>(motions.events[i])
            && block.path != core::PathCertainty::known)
            return &block;
    }
    return nullptr;
}

std::set<core::OffsetNumber> length_numbers(const RecordedMotions& motions,
                                            std::optional<core::ToolNumber> at_start,
                                            core::ToolNumber tool) {
    std::set<core::OffsetNumber> called, active_on_motions;
    std::optional<core::ToolNumber> now = at_start;
    std::optional<core::OffsetNumber> active;
    for (const core::Event& event : motions.events) {
        if (const auto* change = std::get_if<core::ToolChange>(&event)) now = change->tool;
        if (const auto* length = std::get_if<core::LengthOffsetChange>(&event)) {
            active = length->number;
            if (now == tool && active) called.insert(*active);
        }
        if (now == tool && active && std::holds_alternative<core::Motion>(event))
            active_on_motions.insert(*active);
    }
    // That of the tool before may still be active until the program calls its own.
    return called.empty() ? active_on_motions : called;
}

Shifts no_shifts(const RecordedMotions& motions) {
    Shifts shifts;
    shifts.of.resize(motions.events.size());
    return shifts;
}

namespace {

/// The displacements between the motions of two recordings; empty if there are other differences.
std::optional<Shifts> displacements(const RecordedMotions& nominal, const RecordedMotions& other,
                                    double by) {
    if (nominal.events.size() != other.events.size()) return std::nullopt;
    Shifts shifts;
    uint16_t here = 0;
    for (size_t i = 0; i < nominal.events.size(); ++i) {
        const core::Event &a = nominal.events[i], &b = other.events[i];
        if (a.index() != b.index()) return std::nullopt;
        const auto* motion = std::get_if<core::Motion>(&a);
        if (!motion) {
            if (!same_change(a, b)) return std::nullopt;
            shifts.of.push_back({here, here});
            continue;
        }
        const auto& moved = std::get<core::Motion>(b);
        const auto from = shift_between(motion->from, moved.from, by);
        const auto to = shift_between(motion->to, moved.to, by);
        if (!from || !to || !same_form(*motion, moved, *from, *to, by)) return std::nullopt;
        const auto first = kind_of(shifts.kinds, *from), last = kind_of(shifts.kinds, *to);
        if (!first || !last || shifts.kinds.size() > most_kinds) return std::nullopt;
        shifts.of.push_back({*first, *last});
        here = *last;
    }
    return shifts;
}

} // namespace

bool same_motions(const RecordedMotions& a, const RecordedMotions& b) {
    const auto shifts = displacements(a, b, 1.0);
    return shifts && shifts->none();
}

std::optional<Shifts> shifts_between(const RecordedMotions& nominal, const RecordedMotions& other,
                                     double by) {
    const auto same_premise = [](const gcode::OpenPremise& a, const gcode::OpenPremise& b) {
        return a.id == b.id && a.taken == b.taken;
    };
    if (uncertain_block(other) || nominal.alarm.has_value() != other.alarm.has_value()
        || !std::equal(nominal.met.begin(), nominal.met.end(), other.met.begin(), other.met.end(),
                       same_premise)
        || !std::equal(nominal.system_reads.begin(), nominal.system_reads.end(),
                       other.system_reads.begin(), other.system_reads.end(), equal))
        return std::nullopt;
    return displacements(nominal, other, by);
}

bool same_shifts(const Shifts& a, const Shifts& b) {
    if (a.of.size() != b.of.size()) return false;
    const auto equal = [&](uint16_t i, uint16_t j) {
        for (size_t axis = 0; axis < core::axis_count; ++axis)
            if (std::abs(a.kinds[i][axis] - b.kinds[j][axis]) > 2.0 * equal_shift) return false;
        return true;
    };
    for (size_t i = 0; i < a.of.size(); ++i)
        if (!equal(a.of[i].from, b.of[i].from) || !equal(a.of[i].to, b.of[i].to)) return false;
    return true;
}

Shifts with_tool_shift(const Shifts& shifts, const RecordedMotions& motions,
                       std::optional<core::ToolNumber> at_start, core::ToolNumber tool, double z) {
    Shifts shifted;
    std::optional<core::ToolNumber> now = at_start;
    const auto moved = [&](uint16_t kind) {
        core::AxisValues by = shifts.kinds[kind];
        if (now == tool) by[2] += z;
        return kind_of(shifted.kinds, by).value_or(0);
    };
    for (size_t i = 0; i < shifts.of.size(); ++i) {
        if (const auto* change = std::get_if<core::ToolChange>(&motions.events[i]))
            now = change->tool;
        shifted.of.push_back({moved(shifts.of[i].from), moved(shifts.of[i].to)});
    }
    return shifted;
}

} // namespace app
