#include "gcode/modes.h"

#include <cmath>

#include <fmt/format.h>

#include "gcode/execution.h"
#include "gcode/rs274_cycles.h"

namespace gcode {

using core::ErrorCode;

core::Result<void> set_feed_mode(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::feed_mode);
    if (!entry) return {};
    const FeedMode before = execution.modal().feed_mode;
    FeedMode& mode = execution.modal().feed_mode;
    switch (entry->code->tenths) {
    case tenths(93):
        mode = FeedMode::inverse_time;
        break;
    case tenths(95):
        mode = FeedMode::per_turn;
        break;
    default:
        mode = FeedMode::per_minute;
        break;
    }
    // A rate of one mode means nothing in another.
    const bool clears = execution.dialect.feed_mode_clears_feed && mode != FeedMode::inverse_time;
    if (mode != before || clears) execution.modal().feed.reset();
    return {};
}

core::Result<void> set_feed(Execution& execution) {
    const Word* word = execution.statement.word('F');
    if (!word) return {};
    if (word->value < 0.0)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{}: a feed rate is not negative", written(*word)),
                          word->span);
    ModalState& modal = execution.modal();
    const CodeWord* units = execution.statement.of(ModalGroup::units);
    LengthUnit unit = modal.unit;
    if (units && !execution.dialect.feed_before_units)
        unit = units->code->tenths == tenths(20) ? LengthUnit::inch : LengthUnit::mm;
    modal.feed = modal.feed_mode == FeedMode::inverse_time ? word->value : to_mm(word->value, unit);
    return {};
}

core::Result<void> set_speed(Execution& execution) {
    const Word* word = execution.statement.word('S');
    if (!word) return {};
    if (word->value < 0.0)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{}: a spindle speed is not negative", written(*word)),
                          word->span);
    ModalState& modal = execution.modal();
    modal.speed = word->value;
    if (modal.spindle != core::SpindleDirection::stopped
        && !execution.statement.of(ModalGroup::spindle))
        execution.emit(Spindle{modal.spindle, modal.speed});
    return {};
}

namespace {

/// M19 R P Q: an angle, the way there and the longest time for it.
core::Result<void> check_orientation(const Execution& execution, const CodeWord& entry) {
    if (entry.code->tenths != tenths(19)) return {};
    const Word* angle = execution.statement.word('R');
    if (angle && (angle->value < 0.0 || angle->value > 360.0))
        return core::fail(
            ErrorCode::invalid_value,
            fmt::format("{}: the angle of M19 is from 0 to 360 degrees", written(*angle)),
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
    switch (entry->code->tenths) {
    case tenths(3):
        modal.spindle = core::SpindleDirection::clockwise;
        break;
    case tenths(4):
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
    switch (entry->code->tenths) {
    case tenths(7):
        modal.mist = true;
        break;
    case tenths(8):
        modal.flood = true;
        break;
    default:
        modal.mist = modal.flood = false;
        break;
    }
    execution.emit(Coolant{modal.mist, modal.flood});
    return {};
}

core::Result<void> dwell(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::action);
    if (!entry || entry->code->tenths != tenths(4)) return {};
    const Word* word = execution.statement.word('P');
    if (!word && execution.dialect.dwell_takes_x_and_u) {
        word = execution.statement.word('X');
        if (!word) word = execution.statement.word('U');
    }
    if (!word)
        return core::fail(ErrorCode::missing_value, "G4 has no time: it needs a P word",
                          entry->word->span);
    if (word->value < 0.0)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{}: a time is not negative", written(*word)), word->span);
    const bool milliseconds =
        execution.dialect.dwell_without_point_is_milliseconds && !word->has_point;
    execution.emit(Dwell{milliseconds ? word->value / 1000.0 : word->value});
    return {};
}

core::Result<void> select_plane(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::plane);
    if (!entry) return {};
    Plane& plane = execution.modal().plane;
    switch (entry->code->tenths) {
    case tenths(17):
        plane = Plane::xy;
        break;
    case tenths(18):
        plane = Plane::zx;
        break;
    case tenths(19):
        plane = Plane::yz;
        break;
    case tenths(17, 1):
        plane = Plane::uv;
        break;
    case tenths(18, 1):
        plane = Plane::wu;
        break;
    default:
        plane = Plane::vw;
        break;
    }
    execution.emit(SelectPlane{plane});
    return {};
}

core::Result<void> set_units(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::units);
    if (!entry) return {};
    const bool inch = entry->code->tenths == tenths(20);
    const LengthUnit unit = inch ? LengthUnit::inch : LengthUnit::mm;
    if (execution.modal().cycle && execution.dialect.cycles_are_rs274)
        keep_numbers(*execution.modal().cycle, execution.modal().unit, unit);
    const bool changes = unit != execution.modal().unit;
    const bool has_offset = execution.modal().offsets.tool != AxisValues{};
    if (changes && has_offset && execution.dialect.system_parameters == SystemParameters::rs274)
        execution.warn(entry->word->span,
                       fmt::format("{} while a tool length offset is on: LinuxCNC goes on with its "
                                   "number in the new units, so the next G43, G49 or G28 leads to "
                                   "another place than here; say G49 before",
                                   written(*entry->word)));
    execution.modal().unit = unit;
    execution.modal().unit_said = true;
    return {};
}

core::Result<void> set_distance_mode(Execution& execution) {
    const auto mode_of = [](const CodeWord& entry, int absolute) {
        return entry.code->tenths == absolute ? DistanceMode::absolute : DistanceMode::incremental;
    };
    if (const CodeWord* entry = execution.statement.of(ModalGroup::distance))
        execution.modal().distance = mode_of(*entry, tenths(90));
    if (const CodeWord* entry = execution.statement.of(ModalGroup::arc_distance))
        execution.modal().arc_distance = mode_of(*entry, tenths(90, 1));
    return {};
}

core::Result<void> set_retract_mode(Execution& execution) {
    if (const CodeWord* entry = execution.statement.of(ModalGroup::retract))
        execution.modal().retract =
            entry->code->tenths == tenths(98) ? RetractMode::initial_level : RetractMode::r_level;
    return {};
}

core::Result<void> set_path_mode(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::path_control);
    if (!entry) return {};
    ModalState& modal = execution.modal();
    modal.path_tolerance = modal.naive_tolerance = 0.0;
    modal.path = PathMode::continuous;
    if (entry->code->tenths == tenths(61)) modal.path = PathMode::exact_path;
    if (entry->code->tenths == tenths(61, 1)) modal.path = PathMode::exact_stop;
    if (entry->code->tenths == tenths(64)) {
        if (const Word* word = execution.statement.word('P'))
            modal.path_tolerance = modal.naive_tolerance = length_of(execution, *word);
        if (const Word* word = execution.statement.word('Q'))
            modal.naive_tolerance = length_of(execution, *word);
    }
    execution.column = entry->word->span.column;
    execution.emit(SetPathMode{modal.path, modal.path_tolerance, modal.naive_tolerance});
    return {};
}

core::Result<void> set_spindle_mode(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::spindle_mode);
    if (!entry) return {};
    ModalState& modal = execution.modal();
    modal.surface_speed = entry->code->tenths == tenths(96);
    if (modal.surface_speed && execution.dialect.surface_speed_needs_s
        && !execution.statement.word('S'))
        return core::fail(
            ErrorCode::missing_value,
            fmt::format("{} needs the surface speed as S in the same block", written(*entry->word)),
            entry->word->span);
    const Word* fastest = execution.statement.word('D');
    modal.fastest_speed = modal.surface_speed && fastest ? std::abs(fastest->value) : 0.0;
    execution.column = entry->word->span.column;
    execution.emit(UseSpindleMode{modal.surface_speed, modal.speed, modal.fastest_speed});
    return {};
}

core::Result<void> set_diameter_mode(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::diameter);
    if (entry) execution.modal().diameter_mode = entry->code->tenths == tenths(7);
    return {};
}

} // namespace gcode
