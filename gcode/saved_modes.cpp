#include <cmath>

#include <fmt/format.h>

#include "gcode/execution.h"
#include "gcode/modes.h"

namespace gcode {
namespace {

bool has_tool_offset(const ModalState& modal) { return modal.offsets.tool != AxisValues{}; }

/// F as the control notes it: a number of the units and the mode it was said in.
double feed_number(const ModalState& modal) {
    const double feed = modal.feed.value_or(0.0);
    return modal.feed_mode == FeedMode::inverse_time ? feed : from_mm(feed, modal.unit);
}

/// The feed comes back with one digit behind the point, and not at all out of G93.
std::optional<double> restored_feed(const ModalState& now, const ModalState& saved) {
    if (saved.feed_mode == FeedMode::inverse_time) return std::nullopt;
    const double number = feed_number(saved);
    if (number == feed_number(now) && saved.feed_mode == now.feed_mode) return now.feed;
    if (now.feed_mode == FeedMode::inverse_time || number == feed_number(now)) return std::nullopt;
    return to_mm(std::round(number * 10.0) / 10.0, saved.unit);
}

double restored_speed(const ModalState& now, const ModalState& saved) {
    return saved.speed == now.speed ? now.speed : std::round(saved.speed);
}

/// Mist is noted before flood: of what was on, only what is noted otherwise now is switched.
void restore_coolant(ModalState& modal, const ModalState& saved) {
    if (!saved.mist && !saved.flood) modal.mist = modal.flood = false;
    modal.mist |= saved.mist;
    modal.flood |= saved.flood;
}

/// What was off stays as it is, and with the feed override both come back.
void restore_overrides(ModalState& modal, const ModalState& saved) {
    if (saved.feed_override != modal.feed_override) {
        modal.feed_override |= saved.feed_override;
        modal.speed_override = true;
    }
    modal.adaptive_feed |= saved.adaptive_feed;
    modal.feed_hold |= saved.feed_hold;
}

void restore_tool_offset(InterpreterState& state, const ModalState& saved) {
    ModalState& modal = state.modal;
    if (has_tool_offset(modal) == has_tool_offset(saved)) return;
    Offsets offsets = modal.offsets;
    offsets.tool = {};
    modal.length_number.reset();
    if (has_tool_offset(saved) && modal.tool) {
        const auto number = core::OffsetNumber(value_of(*modal.tool));
        const auto& lengths = state.tables->lengths;
        if (const auto entry = lengths.find(number); entry != lengths.end())
            offsets.tool = entry->second.shift;
        offsets.tool[2] = length_under(*state.tables, value_of(*modal.tool)).value_or(0.0);
        modal.length_number = number;
    }
    change_offsets(modal, offsets);
}

void restore_offsets(InterpreterState& state, const ModalState& saved) {
    ModalState& modal = state.modal;
    Offsets offsets = modal.offsets;
    if (saved.offsets.active != offsets.active) {
        offsets.active = saved.offsets.active;
        offsets.work = work_offset(*state.tables, offsets.active);
    }
    if (saved.axis_offset_on != modal.axis_offset_on) {
        offsets.axis = saved.axis_offset_on ? modal.suspended_axis : zero_position;
        modal.axis_offset_on = saved.axis_offset_on;
    }
    change_offsets(modal, offsets);
}

void announce_overrides(const ModalState& before, const ModalState& after, auto say) {
    const bool then[] = {before.feed_override, before.speed_override, before.adaptive_feed,
                         before.feed_hold};
    const bool now[] = {after.feed_override, after.speed_override, after.adaptive_feed,
                        after.feed_hold};
    for (size_t kind = 0; kind < 4; ++kind)
        if (then[kind] != now[kind])
            say(EnableOverride{static_cast<OverrideKind>(kind), now[kind]});
}

} // namespace

void announce_modes(BlockResult& result, uint32_t column, const ModalState& before,
                    const ModalState& after) {
    const auto say = [&](CanonicalCommand command) {
        result.commands.push_back(std::move(command));
        result.columns.push_back(column);
    };
    if (before.surface_speed != after.surface_speed || before.fastest_speed != after.fastest_speed)
        say(UseSpindleMode{after.surface_speed, after.speed, after.fastest_speed});
    const bool turns = after.spindle != core::SpindleDirection::stopped;
    if (before.spindle != after.spindle || (turns && before.speed != after.speed))
        say(Spindle{after.spindle, turns ? after.speed : 0.0});
    if (before.plane != after.plane) say(SelectPlane{after.plane});
    if (before.offsets.tool != after.offsets.tool)
        say(UseToolLengthOffset{after.length_number, after.offsets.tool,
                                after.offsets.follows_tip});
    Offsets without_tool = before.offsets;
    without_tool.tool = after.offsets.tool;
    if (without_tool != after.offsets) say(SetOffset{after.offsets});
    if (before.path != after.path || before.path_tolerance != after.path_tolerance
        || before.naive_tolerance != after.naive_tolerance)
        say(SetPathMode{after.path, after.path_tolerance, after.naive_tolerance});
    if (before.mist != after.mist || before.flood != after.flood)
        say(Coolant{after.mist, after.flood});
    announce_overrides(before, after, say);
}

void restore_modes(InterpreterState& state, const ModalState& saved) {
    ModalState& modal = state.modal;
    modal.feed = restored_feed(modal, saved);
    modal.feed_mode = saved.feed_mode;
    modal.speed = restored_speed(modal, saved);
    if (modal.surface_speed != saved.surface_speed) modal.fastest_speed = 0.0;
    modal.surface_speed = saved.surface_speed;
    modal.spindle = saved.spindle;
    modal.unit = saved.unit;
    modal.plane = saved.plane;
    modal.distance = saved.distance;
    modal.arc_distance = saved.arc_distance;
    modal.retract = saved.retract;
    modal.path = saved.path;
    modal.path_tolerance = saved.path_tolerance;
    modal.naive_tolerance = saved.naive_tolerance;
    modal.diameter_mode = saved.diameter_mode;
    if (saved.compensation == Side::none) modal.compensation = Side::none;
    restore_coolant(modal, saved);
    restore_overrides(modal, saved);
    restore_tool_offset(state, saved);
    restore_offsets(state, saved);
}

std::vector<std::string> losses_of_restoring(const ModalState& now, const ModalState& saved) {
    std::vector<std::string> losses;
    const std::optional<double> feed = restored_feed(now, saved);
    if (saved.feed && saved.feed_mode != FeedMode::inverse_time && !feed)
        losses.emplace_back("the feed rate is not brought back: say F before the next feed");
    else if (saved.feed && feed && std::abs(*feed - *saved.feed) > 1e-9)
        losses.push_back(fmt::format("the feed rate comes back as F{:.1f}, rounded from F{:g}",
                                     from_mm(*feed, saved.unit), feed_number(saved)));
    if (restored_speed(now, saved) != saved.speed)
        losses.push_back(fmt::format("the speed comes back as S{:.0f}, rounded from S{:g}",
                                     saved.speed, saved.speed));
    if (saved.surface_speed && !now.surface_speed && saved.fastest_speed > 0.0)
        losses.push_back(fmt::format("G96 comes back without its limit D{:g}: the spindle may run "
                                     "away near the axis",
                                     saved.fastest_speed));
    const bool had = has_tool_offset(saved), has = has_tool_offset(now);
    if (had && !has)
        losses.emplace_back("the tool length offset comes back as that of the tool in the "
                            "spindle, whatever was on");
    else if (had && saved.offsets.tool != now.offsets.tool)
        losses.emplace_back("the tool length offset stays as it is now, another one was saved");
    if (saved.compensation != Side::none && now.compensation == Side::none)
        losses.emplace_back("cutter radius compensation was on when the modes were saved, and is "
                            "left off here");
    return losses;
}

} // namespace gcode
