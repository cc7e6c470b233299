#include "gcode/exec/modes.h"

#include <cmath>

#include <fmt/format.h>

#include "core/base/math.h"
#include "gcode/exec/execution.h"
#include "gcode/language/control.h"

namespace gcode {

using core::ErrorCode;

core::Result<void> set_feed_mode(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::feed_mode);
    if (!entry) return {};
    const FeedMode before = execution.modal().feed_mode;
    FeedMode& mode = execution.modal().feed_mode;
    switch (entry->code->number) {
    case g_code(93):
        mode = FeedMode::inverse_time;
        break;
    case g_code(95):
        mode = FeedMode::per_turn;
        break;
    default:
        mode = FeedMode::per_minute;
        break;
    }
    // A feed rate of one mode has no meaning in another.
    const bool clears = execution.dialect.feed_mode_clears_feed && mode != FeedMode::inverse_time;
    if (mode != before || clears) execution.modal().feed.reset();
    return {};
}

core::Result<void> set_feed(Execution& execution) {
    const Word* word = execution.statement.word('F');
    if (!word) return {};
    if (word->value < 0.0)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{}: a feed rate must not be negative", written(*word)),
                          word->span);
    ModalState& modal = execution.modal();
    const CodeWord* units = execution.statement.of(ModalGroup::units);
    LengthUnit unit = modal.unit;
    if (units && !execution.dialect.feed_before_units)
        unit = units->code->number == g_code(20) ? LengthUnit::inch : LengthUnit::mm;
    modal.feed = modal.feed_mode == FeedMode::inverse_time ? word->value : to_mm(word->value, unit);
    modal.feed_unit = unit;
    return {};
}

core::Result<void> set_speed(Execution& execution) {
    const Word* word = execution.statement.word('S');
    if (!word) return {};
    if (word->value < 0.0)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{}: a spindle speed must not be negative", written(*word)),
                          word->span);
    ModalState& modal = execution.modal();
    modal.speed = word->value;
    if (modal.spindle != core::SpindleDirection::stopped
        && !execution.statement.of(ModalGroup::spindle))
        execution.emit(Spindle{modal.spindle, modal.speed});
    return {};
}

namespace {

/// Checks M19 R P Q: angle, direction, and maximum time.
core::Result<void> check_orientation(const Execution& execution, const CodeWord& entry) {
    if (entry.code->number != m_code(19)) return {};
    const Word* angle = execution.statement.word('R');
    if (angle && (angle->value < 0.0 || angle->value > 360.0))
        return core::fail(
            ErrorCode::invalid_value,
            fmt::format("{}: the angle of M19 must be from 0 to 360 degrees", written(*angle)),
            angle->span);
    const Word* way = execution.statement.word('P');
    if (way && way->value != 0.0 && way->value != 1.0 && way->value != 2.0
        && execution.dialect.surface_speed_needs_s)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{}: M19 takes P0 for the shortest way, P1 for clockwise or "
                                      "P2 for counterclockwise",
                                      written(*way)),
                          way->span);
    return {};
}

} // namespace

core::Result<void> turn_spindle(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::spindle);
    if (!entry) return {};
    ModalState& modal = execution.modal();
    if (auto checked = check_orientation(execution, *entry); !checked) return checked;
    switch (entry->code->number) {
    case m_code(3):
        modal.spindle = core::SpindleDirection::clockwise;
        break;
    case m_code(4):
        modal.spindle = core::SpindleDirection::counterclockwise;
        break;
    default:
        modal.spindle = core::SpindleDirection::stopped;
        break; // M5, and M19 turns to an angle
    }
    const bool stopped = modal.spindle == core::SpindleDirection::stopped;
    execution.emit(Spindle{modal.spindle, stopped ? 0.0 : modal.speed});
    return {};
}

core::Result<void> set_coolant(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::coolant);
    if (!entry) return {};
    ModalState& modal = execution.modal();
    switch (entry->code->number) {
    case m_code(7):
        modal.mist = true;
        break;
    case m_code(8):
        modal.flood = true;
        break;
    default:
        modal.mist = modal.flood = false;
        break;
    }
    execution.emit(Coolant{modal.mist, modal.flood});
    return {};
}

core::Result<double> dwell_time(const Execution& execution, const Word& word) {
    if (word.value < 0.0)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{}: a time must not be negative", written(word)), word.span);
    const bool milliseconds =
        execution.dialect.dwell_without_point_is_milliseconds && !word.has_point;
    return milliseconds ? word.value / 1000.0 : word.value;
}

core::Result<void> dwell(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::action);
    if (!entry || entry->code->number != g_code(4)) return {};
    const Word* word = execution.statement.word('P');
    if (!word && execution.dialect.dwell_takes_x_and_u) {
        word = execution.statement.word('X');
        if (!word) word = execution.statement.word('U');
    }
    if (!word)
        return core::fail(ErrorCode::missing_value, "G4 has no time: it needs a P word",
                          entry->word->span);
    FEELER_TRY(const double seconds, dwell_time(execution, *word));
    execution.emit(Dwell{seconds});
    return {};
}

core::Result<void> select_plane(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::plane);
    if (!entry) return {};
    Plane& plane = execution.modal().plane;
    switch (entry->code->number) {
    case g_code(17):
        plane = Plane::xy;
        break;
    case g_code(18):
        plane = Plane::zx;
        break;
    case g_code(19):
        plane = Plane::yz;
        break;
    case g_code(17, 1):
        plane = Plane::uv;
        break;
    case g_code(18, 1):
        plane = Plane::wu;
        break;
    default:
        plane = Plane::vw;
        break;
    }
    execution.emit(SelectPlane{plane});
    return {};
}

namespace {

/// Reinterprets the stored words of a cycle after a change of units: LinuxCNC keeps the numbers, so
/// the lengths change.
void keep_numbers(CannedCycle& cycle, LengthUnit from, LengthUnit to) {
    const auto again = [&](double& length) { length = to_mm(from_mm(length, from), to); };
    for (std::optional<double>* word : {&cycle.bottom, &cycle.r, &cycle.peck, &cycle.initial_level})
        if (*word) again(**word);
    for (double& word : cycle.shift) again(word);
}

} // namespace

core::Result<void> set_units(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::units);
    if (!entry) return {};
    const bool inch = entry->code->number == g_code(20);
    const LengthUnit unit = inch ? LengthUnit::inch : LengthUnit::mm;
    if (execution.modal().cycle && execution.dialect.cycles_are_rs274)
        keep_numbers(*execution.modal().cycle, execution.modal().unit, unit);
    const bool changes = unit != execution.modal().unit;
    const bool has_offset = execution.modal().offsets.tool != AxisValues{};
    if (changes && has_offset && execution.dialect.system_parameters == SystemParameters::rs274)
        execution.warn(
            entry->word->span,
            fmt::format("{} while a tool length offset is on: LinuxCNC keeps the number of the "
                        "offset but reads it in the new units, so the next G43, G49 or G28 goes to "
                        "a different place than here; program G49 first",
                        written(*entry->word)));
    execution.modal().unit = unit;
    execution.modal().unit_said = true;
    return {};
}

core::Result<void> set_distance_mode(Execution& execution) {
    const auto mode_of = [](const CodeWord& entry, CodeNumber absolute) {
        return entry.code->number == absolute ? DistanceMode::absolute : DistanceMode::incremental;
    };
    if (const CodeWord* entry = execution.statement.of(ModalGroup::distance)) {
        ModalState& modal = execution.modal();
        modal.distance = mode_of(*entry, g_code(90));
        modal.incremental_stays =
            modal.distance == DistanceMode::absolute
            || !find_parameter(ControlQuestion::incremental_acts_once, execution.dialect.id);
    }
    if (const CodeWord* entry = execution.statement.of(ModalGroup::arc_distance))
        execution.modal().arc_distance = mode_of(*entry, g_code(90, 1));
    return {};
}

core::Result<void> set_retract_mode(Execution& execution) {
    if (const CodeWord* entry = execution.statement.of(ModalGroup::retract))
        execution.modal().retract =
            entry->code->number == g_code(98) ? RetractMode::initial_level : RetractMode::r_level;
    return {};
}

namespace {

/// P and Q of G64. In LinuxCNC, P rounds corners between feeds and between rapids, and Q joins
/// feeds.
///
/// Source: tp.c (handleModeChange), interp_convert.cc (Q defaults to P).
void set_blending(Execution& execution, bool rounds) {
    ModalState& modal = execution.modal();
    modal.path_tolerance = modal.naive_tolerance = 0.0;
    modal.corner_tolerances = {};
    if (!rounds) return;
    if (const Word* word = execution.statement.word('P'))
        modal.path_tolerance = modal.naive_tolerance = length_of(execution, *word);
    if (const Word* word = execution.statement.word('Q'))
        modal.naive_tolerance = length_of(execution, *word);
    if (execution.dialect.id != DialectId::linuxcnc) return;
    modal.corner_tolerances.rapids_keep_speed =
        modal.path_tolerance == 0.0 && execution.environment.control.follows_start;
    if (!(modal.path_tolerance > 0.0)) return;
    modal.corner_tolerances.rapid_tolerance = modal.path_tolerance;
    modal.corner_tolerances.blends = true;
}

/// G187 of Haas: E states how far corners may be rounded, until G187 without it, which restores
/// setting 85. With 0, the control stops at each corner.
void set_accuracy(Execution& execution) {
    ModalState& modal = execution.modal();
    modal.path_tolerance =
        execution.environment.control.number(ControlQuestion::corner_tolerance).value_or(0.0);
    modal.path = PathMode::continuous;
    const Word* word = execution.statement.word('E');
    if (!word) return;
    modal.path_tolerance = length_of(execution, *word);
    if (modal.path_tolerance == 0.0) modal.path = PathMode::exact_stop;
}

} // namespace

core::Result<void> set_path_mode(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::path_control);
    if (!entry) return {};
    ModalState& modal = execution.modal();
    const CodeNumber code = entry->code->number;
    if (code == g_code(187)) {
        set_accuracy(execution);
    } else {
        modal.path = PathMode::continuous;
        if (code == g_code(61)) modal.path = PathMode::exact_path;
        if (code == g_code(61, 1) || code == g_code(60)) modal.path = PathMode::exact_stop;
        // E of G187 outlives G61 and G64.
        if (execution.dialect.id != DialectId::haas) set_blending(execution, code == g_code(64));
    }
    execution.column = entry->word->span.column;
    execution.emit(path_mode_of(modal));
    return {};
}

core::Result<void> set_spindle_mode(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::spindle_mode);
    if (!entry) return {};
    ModalState& modal = execution.modal();
    modal.surface_speed = entry->code->number == g_code(96);
    if (modal.surface_speed && execution.dialect.surface_speed_needs_s
        && !execution.statement.word('S'))
        return core::fail(ErrorCode::missing_value,
                          fmt::format("{} needs an S word, the surface speed, in the same block",
                                      written(*entry->word)),
                          entry->word->span);
    const Word* fastest = execution.statement.word('D');
    modal.fastest_speed = modal.surface_speed && fastest ? std::abs(fastest->value) : 0.0;
    execution.column = entry->word->span.column;
    execution.emit(UseSpindleMode{modal.surface_speed, modal.speed, modal.fastest_speed});
    return {};
}

core::Result<void> set_diameter_mode(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::diameter);
    if (entry) execution.modal().diameter_mode = entry->code->number == g_code(7);
    return {};
}

namespace {

bool has_tool_offset(const ModalState& modal) { return modal.offsets.tool != AxisValues{}; }

/// F as stored by the control: in the units and feed mode in which it was programmed.
double feed_number(const ModalState& modal) {
    const double feed = modal.feed.value_or(0.0);
    return modal.feed_mode == FeedMode::inverse_time ? feed : from_mm(feed, modal.unit);
}

/// The feed as restored: rounded to one decimal, and not restored at all from G93.
std::optional<double> restored_feed(const ModalState& now, const ModalState& saved) {
    if (saved.feed_mode == FeedMode::inverse_time) return std::nullopt;
    const double number = feed_number(saved);
    if (number == feed_number(now) && saved.feed_mode == now.feed_mode) return now.feed;
    if (now.feed_mode == FeedMode::inverse_time || number == feed_number(now)) return std::nullopt;
    return to_mm(core::round(number * 10.0) / 10.0, saved.unit);
}

double restored_speed(const ModalState& now, const ModalState& saved) {
    return saved.speed == now.speed ? now.speed : core::round(saved.speed);
}

/// As on LinuxCNC: coolant that was on is switched on; coolant is switched off only if both were
/// off.
void restore_coolant(ModalState& modal, const ModalState& saved) {
    if (!saved.mist && !saved.flood) modal.mist = modal.flood = false;
    modal.mist |= saved.mist;
    modal.flood |= saved.flood;
}

/// Overrides that were on are enabled. A changed feed override also enables the speed override.
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

void announce_modes(BlockCommands& result, uint32_t column, const ModalState& before,
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
        || before.naive_tolerance != after.naive_tolerance
        || before.corner_tolerances != after.corner_tolerances)
        say(path_mode_of(after));
    if (before.mist != after.mist || before.flood != after.flood)
        say(Coolant{after.mist, after.flood});
    announce_overrides(before, after, say);
}

void restore_modes(InterpreterState& state, const ModalState& saved) {
    ModalState& modal = state.modal;
    const std::optional<double> feed = restored_feed(modal, saved);
    if (feed != modal.feed) modal.feed_unit = saved.unit;
    modal.feed = feed;
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
    modal.corner_tolerances = saved.corner_tolerances;
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
        losses.emplace_back("the feed rate is not restored: program F before the next feed move");
    else if (saved.feed && feed && std::abs(*feed - *saved.feed) > 1e-9)
        losses.push_back(fmt::format("the feed rate is restored as F{:.1f}, rounded from F{:g}",
                                     from_mm(*feed, saved.unit), feed_number(saved)));
    if (restored_speed(now, saved) != saved.speed)
        losses.push_back(fmt::format("the spindle speed is restored as S{:.0f}, rounded from S{:g}",
                                     saved.speed, saved.speed));
    if (saved.surface_speed && !now.surface_speed && saved.fastest_speed > 0.0)
        losses.push_back(fmt::format(
            "G96 is restored without its limit D{:g}: the spindle may overspeed near the axis",
            saved.fastest_speed));
    const bool had = has_tool_offset(saved), has = has_tool_offset(now);
    if (had && !has)
        losses.emplace_back("the tool length offset is restored as that of the tool in the "
                            "spindle, whichever was on");
    else if (had && saved.offsets.tool != now.offsets.tool)
        losses.emplace_back("the tool length offset is not restored: the current one stays on");
    if (saved.compensation != Side::none && now.compensation == Side::none)
        losses.emplace_back(
            "cutter radius compensation was on when the modes were saved, but stays off here");
    return losses;
}

namespace {

double work_offset_code(const Offsets& offsets) {
    constexpr size_t fanuc_offsets = 6; // G54 to G59
    return offsets.active < fanuc_offsets ? 54.0 + static_cast<double>(offsets.active) : 54.1;
}

double plane_code(Plane plane) {
    return plane == Plane::xy ? 17.0 : plane == Plane::zx ? 18.0 : 19.0;
}

double feed_code(FeedMode mode) {
    if (mode == FeedMode::inverse_time) return 93.0;
    return mode == FeedMode::per_minute ? 94.0 : 95.0;
}

double length_code(double sign) { return sign == 0.0 ? 49.0 : sign > 0.0 ? 43.0 : 44.0; }

double radius_code(Side side) {
    if (side == Side::none) return 40.0;
    return side == Side::left ? 41.0 : 42.0;
}

/// Vacant for a motion that has no number, such as Siemens' CIP.
Value motion_code(const std::optional<MotionCode>& motion) {
    if (!motion) return 0.0;
    const auto number = number_of(*motion);
    return number ? Value(value_of(*number)) : Value();
}

double path_code(PathMode mode) { return mode == PathMode::continuous ? 64.0 : 61.0; }

} // namespace

Value fanuc_mode(const InterpreterState& state, int group) {
    const ModalState& modal = state.modal;
    switch (group) {
    case 1:
        return motion_code(modal.motion);
    case 2:
        return plane_code(modal.plane);
    case 3:
        return modal.distance == DistanceMode::absolute ? 90.0 : 91.0;
    case 5:
        return feed_code(modal.feed_mode);
    case 6:
        return modal.unit == LengthUnit::inch ? 20.0 : 21.0;
    case 7:
        return radius_code(modal.compensation);
    case 8:
        return length_code(modal.length_sign);
    case 9:
        return modal.cycle ? value_of(modal.cycle->code) : 80.0;
    case 10:
        return modal.retract == RetractMode::initial_level ? 98.0 : 99.0;
    case 12:
        return state.modal_macros.empty() ? 67.0 : 66.0;
    case 13:
        return modal.surface_speed ? 96.0 : 97.0;
    case 14:
        return work_offset_code(modal.offsets);
    case 15:
        return path_code(modal.path);
    default:
        return {};
    }
}

} // namespace gcode
