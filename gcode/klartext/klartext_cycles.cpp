#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "core/base/math.h"
#include "core/base/rule_table.h"
#include "core/base/units.h"
#include "gcode/exec/program_parameters.h"
#include "gcode/exec/readings.h"
#include "gcode/klartext/klartext.h"

namespace gcode {
namespace {

using core::ErrorCode;

/// A defined cycle at one hole. Heights are program coordinates along the tool axis.
struct KlartextHole {
    Execution& execution;
    const DefinedCycle& cycle;
    PlaneAxes axes;
    double surface, above, bottom; // above: at the set-up clearance

    void go(std::optional<double> height, bool rapid, double feed) {
        Position end = execution.modal().position;
        end[axes.normal] = height;
        if (rapid)
            execution.traverse(end);
        else
            execution.feed(end, feed);
    }
    void rapid(double height) { go(height, true, 0.0); }
    void feed(double height) { go(height, false, cycle.feed); }
    void dwell(double seconds) {
        if (seconds > 0.0) execution.emit(Dwell{seconds});
    }
    void turn_spindle(core::SpindleDirection direction) {
        const bool stops = direction == core::SpindleDirection::stopped;
        execution.emit(Spindle{direction, stops ? 0.0 : execution.modal().speed});
    }
    void retract() {
        const double feed_rate = cycle.retract_feed > 0.0 ? cycle.retract_feed : cycle.feed;
        go(above, false, feed_rate);
    }
};

/// Cycle 1, which starts at the current position. Rapids stop before the last depth as in the
/// manual of the TNC 426: 0.6 mm, for holes deeper than 30 mm a fiftieth of the depth, at most 7
/// mm.
void peck_from_here(KlartextHole& hole) {
    const double depth = hole.surface - hole.bottom;
    const double pause = depth <= 30.0 ? 0.6 : std::min(depth / 50.0, 7.0);
    const double step = hole.cycle.peck;
    for (double level = hole.surface - step; level > hole.bottom + 1e-9; level -= step) {
        hole.feed(level);
        hole.rapid(hole.above);
        hole.rapid(std::min(level + pause, hole.above));
    }
    hole.feed(hole.bottom);
    hole.dwell(hole.cycle.dwell_below);
    hole.rapid(hole.above);
}

/// Cycle 200: retract out of the hole after each peck, back to the set-up clearance above its
/// bottom.
void drill(KlartextHole& hole) {
    const DefinedCycle& cycle = hole.cycle;
    const double step = cycle.peck > 0.0 ? cycle.peck : hole.surface - hole.bottom;
    for (double level = hole.surface - step; level > hole.bottom + 1e-9; level -= step) {
        hole.feed(level);
        hole.rapid(hole.above);
        hole.dwell(cycle.dwell_above);
        hole.rapid(std::min(level + cycle.clearance, hole.above));
    }
    hole.feed(hole.bottom);
    hole.dwell(cycle.dwell_below);
    hole.rapid(hole.above);
}

/// Cycles 203 and 205: pecks of decreasing depth with chip breaking.
void drill_universal(KlartextHole& hole) {
    const DefinedCycle& cycle = hole.cycle;
    const bool by_count = cycle.number == 203;
    const double start = hole.surface - std::abs(cycle.start_depth);
    if (cycle.start_depth != 0.0) hole.rapid(start + cycle.clearance);
    double step = cycle.peck > 0.0 ? cycle.peck : start - hole.bottom;
    double level = start, since_break = 0.0;
    int breaks = 0;
    while (level > hole.bottom + 1e-9 && hole.execution.result.commands.size() < most_commands) {
        const double next = std::max(hole.bottom, level - step);
        since_break += level - next;
        level = next;
        hole.feed(level);
        step = std::max(step - cycle.decrement, std::max(cycle.least_peck, 1e-3));
        if (level <= hole.bottom + 1e-9) break;
        const bool breaks_chip = by_count ? breaks < cycle.breaks : cycle.break_every > 0.0;
        if (breaks_chip && by_count) {
            ++breaks;
            hole.go(level + cycle.break_back, false, cycle.feed);
            continue;
        }
        breaks = 0;
        hole.rapid(hole.above);
        hole.dwell(cycle.dwell_above);
        hole.rapid(std::min(level + (by_count ? cycle.clearance : cycle.stop_above), hole.above));
    }
    hole.dwell(cycle.dwell_below);
    if (cycle.retract_feed > 0.0)
        hole.retract();
    else
        hole.rapid(hole.above);
}

/// Cycle 202: moves off the wall with the spindle stopped.
void bore(KlartextHole& hole) {
    const core::SpindleDirection turning = hole.execution.modal().spindle;
    hole.feed(hole.bottom);
    hole.dwell(hole.cycle.dwell_below);
    hole.turn_spindle(core::SpindleDirection::stopped);
    const Position centre = hole.execution.modal().position;
    const int side =
        static_cast<int>(core::round_to_integer(std::clamp(hole.cycle.disengage, 0.0, 9.0)));
    Position aside = centre;
    const size_t axis = side == 1 || side == 3 ? hole.axes.first : hole.axes.second;
    if (side >= 1 && side <= 4 && aside[axis]) {
        *aside[axis] += side <= 2 ? -0.2 : 0.2;
        hole.execution.feed(aside, hole.cycle.feed);
    }
    hole.retract();
    if (side >= 1 && side <= 4) {
        Position back = centre;
        back[hole.axes.normal] = hole.above;
        hole.execution.traverse(back);
    }
    hole.turn_spindle(turning);
}

/// Cycles 206, 207 and 209: the thread is cut on the way in; the spindle reverses for the way out.
void tap(KlartextHole& hole) {
    const ModalState& modal = hole.execution.modal();
    const bool rigid = hole.cycle.number != 206;
    const double feed = rigid ? std::abs(hole.cycle.pitch) * modal.speed : hole.cycle.feed;
    const core::SpindleDirection in = hole.cycle.pitch < 0.0
                                          ? core::SpindleDirection::counterclockwise
                                      : rigid ? core::SpindleDirection::clockwise
                                              : modal.spindle;
    const core::SpindleDirection out = in == core::SpindleDirection::clockwise
                                           ? core::SpindleDirection::counterclockwise
                                           : core::SpindleDirection::clockwise;
    if (rigid) hole.turn_spindle(in);
    hole.go(hole.bottom, false, feed);
    hole.turn_spindle(out);
    hole.dwell(hole.cycle.dwell_below);
    hole.go(hole.above, false, feed);
    hole.turn_spindle(rigid ? core::SpindleDirection::stopped : in);
    if (rigid) hole.execution.modal().spindle = core::SpindleDirection::stopped;
}

/// Cycle 208: a helix to the bottom, a full circle there, and out at the centre.
core::Result<void> mill_bore(KlartextHole& hole) {
    Execution& execution = hole.execution;
    const double tool = to_mm(q_number(execution, 108), execution.modal().unit);
    const double radius = hole.cycle.diameter / 2.0 - tool;
    const Position centre = execution.modal().position;
    const std::optional<double>& x = centre[hole.axes.first];
    const std::optional<double>& y = centre[hole.axes.second];
    if (!x || !y || tool <= 0.0 || radius < 0.0 || hole.cycle.infeed <= 0.0)
        return refuse_statement(
            execution, "CYCL DEF 208 needs a known position, a tool radius that is known and not "
                       "larger than the bore radius, and an infeed Q334 greater than 0");
    if (radius < 1e-9) {
        hole.feed(hole.bottom);
        hole.rapid(hole.above);
        return {};
    }
    Position position = centre;
    position[hole.axes.first] = *x + radius;
    position[hole.axes.normal] = hole.above;
    execution.feed(position, hole.cycle.feed);
    const auto circle = [&](double height) {
        position[hole.axes.normal] = height;
        execution.modal().position = position;
        execution.emit(ArcFeed{.end = position,
                               .plane = execution.modal().plane,
                               .centre = {*x, *y},
                               .turns = 1,
                               .feed = hole.cycle.feed});
    };
    for (double level = hole.above; level > hole.bottom + 1e-9; level = *position[hole.axes.normal])
        circle(std::max(hole.bottom, level - hole.cycle.infeed));
    circle(hole.bottom);
    position[hole.axes.first] = *x;
    execution.feed(position, hole.cycle.feed);
    hole.rapid(hole.above);
    return {};
}

core::Result<void> machine(KlartextHole& hole) {
    switch (hole.cycle.number) {
    case 1:
        peck_from_here(hole);
        return {};
    case 201:
        hole.feed(hole.bottom);
        hole.dwell(hole.cycle.dwell_below);
        hole.retract();
        return {};
    case 202:
        bore(hole);
        return {};
    case 203:
    case 205:
        drill_universal(hole);
        return {};
    case 206:
    case 207:
    case 209:
        tap(hole);
        return {};
    case 208:
        return mill_bore(hole);
    default:
        drill(hole);
        return {};
    }
}

core::Result<void> check(const Execution& execution, const DefinedCycle& cycle) {
    const bool rigid = cycle.number == 207 || cycle.number == 209;
    const auto refuse = [&](std::string_view why) {
        return refuse_statement(execution, fmt::format("CYCL DEF {}: {}", cycle.number, why));
    };
    if (cycle.depth > 0.0)
        return refuse("the depth is positive, so the tool would move up; program a negative depth");
    if (rigid ? cycle.pitch == 0.0 : !(cycle.feed > 0.0))
        return refuse(rigid ? "the pitch Q239 is missing" : "the feed rate is missing");
    if (cycle.number == 1 && cycle.peck <= 0.0) return refuse("the pecking depth is missing");
    const double least = std::max(cycle.least_peck, 1e-3);
    const double step = cycle.number == 208     ? cycle.infeed
                        : cycle.decrement > 0.0 ? std::min(cycle.peck, least)
                                                : cycle.peck;
    if (step > 0.0 && -cycle.depth / step > most_commands / 4)
        return refuse("the hole needs too many pecks");
    return {};
}

void read_old_cycle(Execution& execution, DefinedCycle& cycle) {
    const Word* word = execution.statement.word('P');
    if (!word) return;
    const double length = std::abs(length_of(execution, *word));
    switch (klartext_of(execution.block).part) {
    case 1:
        cycle.clearance = length;
        break;
    case 2:
        cycle.depth = length_of(execution, *word);
        break;
    case 3:
        cycle.peck = length;
        break;
    case 4:
        cycle.dwell_below = word->value;
        break;
    default:
        cycle.feed = length;
        break;
    }
}

constexpr int first_with_parameters = 200;

/// Whether Q395 says what the depth of a cycle refers to.
bool has_depth_reference(int number) { return number == 200 || number == 203 || number == 205; }

DefinedCycle new_cycle(const Execution& execution, int number) {
    const auto length = [&](int q) { return q_length(execution, q); };
    const auto plain = [&](int q) { return q_number(execution, q); };
    const bool taps = number == 206 || number == 207 || number == 209;
    return {.number = number,
            .clearance = std::abs(length(200)),
            .depth = length(201),
            .feed = length(206),
            .peck = taps || number == 202 || number == 201 || number == 208 || number == 240
                        ? 0.0
                        : std::abs(length(202)),
            .surface = length(203),
            .second_clearance = std::abs(length(204)),
            .dwell_above = number == 200 || number == 203 ? plain(210) : 0.0,
            .dwell_below = number == 207 || number == 208 || number == 209 ? 0.0 : plain(211),
            .retract_feed = number >= 201 && number <= 203 ? length(208) : 0.0,
            .decrement = number == 203 || number == 205 ? length(212) : 0.0,
            .breaks = number == 203 ? plain(213) : 0.0,
            .least_peck = number == 203 || number == 205 ? length(205) : 0.0,
            .break_back = number == 203 || number == 205 ? length(256) : 0.0,
            .break_every = number == 205 ? length(257) : 0.0,
            .stop_above = number == 205 ? length(258) : 0.0,
            .stop_below = number == 205 ? length(259) : 0.0,
            .start_depth = number == 205 ? length(379) : 0.0,
            .disengage = number == 202 ? plain(214) : 0.0,
            .pitch = number == 207 || number == 209 ? length(239) : 0.0,
            .infeed = number == 208 ? length(334) : 0.0,
            .diameter = number == 208 ? length(335) : 0.0};
}

core::Result<void> check_depth_reference(const Execution& execution, int number) {
    const core::SourceSpan where = klartext_of(execution.block).span;
    if (q_number(execution, 395) != 0.0 && has_depth_reference(number))
        return core::fail(ErrorCode::unsupported,
                          fmt::format("CYCL DEF {}: Q395={:g} counts the depth to the full "
                                      "diameter of the drill, which depends on T-ANGLE in the "
                                      "tool table and is not supported: program Q395=+0 and "
                                      "the depth of the tip",
                                      number, q_number(execution, 395)),
                          where);
    if (number == 240 && q_number(execution, 343) != 0.0)
        return core::fail(ErrorCode::unsupported,
                          "CYCL DEF 240: Q343=1 centres to a diameter, and its depth depends "
                          "on T-ANGLE in the tool table, which is not supported: program "
                          "Q343=+0 and the depth Q201",
                          where);
    return {};
}

/// Reports parameters of the cycle that were computed from what only the machine knows.
void report_unknown_parameters(Execution& execution) {
    const ProgramParameters parameters(execution.state, execution.environment);
    parameters.forget_reads();
    for (const int q : {200, 201, 202, 203, 204, 205, 212, 239, 334, 335, 379})
        if (execution.state.parameters->is_unpredictable(q))
            (void)parameters.numbered(static_cast<double>(q), klartext_of(execution.block).span);
    report_unknown(parameters, execution.result, klartext_of(execution.block).span,
                   "the called cycle");
}

/// The defined cycle as it is called here. Cycles from 200 on take the Q parameters as they are at
/// the call, which may be others than those of the definition.
///
/// Source: Heidenhain TNC 640, cycle programming, "Working with fixed cycles": the parameters of a
///         cycle are the global Q parameters with these numbers.
core::Result<DefinedCycle> called_cycle(Execution& execution) {
    const KlartextState& klartext = klartext_of(execution.state);
    const DefinedCycle& defined = klartext.cycle;
    if (defined.number < first_with_parameters) return defined;
    if (auto checked = check_depth_reference(execution, defined.number); !checked)
        return tl::unexpected(std::move(checked).error());
    report_unknown_parameters(execution);
    DefinedCycle cycle = new_cycle(execution, defined.number);
    if (defined.feed_of_call) cycle.feed = klartext.call_feed.value_or(0.0);
    return cycle;
}

/// CYCL DEF 32.1 T0.05: the permitted deviation from the path; without T, that of the machine.
void set_path_tolerance(Execution& execution) {
    ModalState& modal = execution.modal();
    const Word* word = execution.statement.word('P');
    modal.path_tolerance = word ? length_of(execution, *word) : 0.0;
    modal.corner_tolerances = {};
    if (modal.path_tolerance > 0.0)
        modal.corner_tolerances = {.rapid_tolerance = modal.path_tolerance, .between_kinds = true};
    execution.emit(path_mode_of(modal));
}

/// CYCL DEF 247: the first row of the preset table is that of the set-up. Where the datum of
/// another row is, and how it is turned, is not known.
void set_datum(Execution& execution) {
    const core::SourceSpan where = klartext_of(execution.block).span;
    const double row = q_number(execution, 339);
    KlartextState& klartext = writable_klartext(execution.state);
    uint8_t& doubt = execution.modal().doubt;
    if (!klartext.datum) klartext.datum = execution.environment.datum;
    const bool is_premise = execution.environment.control.reports_premises;
    if (!klartext.datum && is_premise && klartext.has_moved) {
        doubt |= datum_is_in_doubt;
        execution.result.warnings.push_back(
            {Severity::warning, where,
             fmt::format("CYCL DEF 247: the program has moved before, and whether datum {:.12g} of "
                         "the preset table is the one that was active there is not known. Motions "
                         "are followed as if it were, and are not proven clear",
                         row),
             core::rule_id("undecided"),
             fmt::format(
                 "If the work offset of the set-up is this datum, state \"datum\" = {:.12g} "
                 "under [control].",
                 row)});
    } else if (!klartext.datum) {
        klartext.datum = row;
        execution.warn(where,
                       fmt::format("CYCL DEF 247: datum {:.12g} of the preset table is assumed to "
                                   "be the work offset of the set-up",
                                   row),
                       Severity::note);
    } else if (row == *klartext.datum) {
        doubt &= static_cast<uint8_t>(~datum_is_in_doubt);
    } else if ((doubt & datum_is_in_doubt) == 0) {
        doubt |= datum_is_in_doubt;
        execution.result.warnings.push_back(
            {Severity::warning, where,
             fmt::format("CYCL DEF 247: the work offset of the set-up is datum {:.12g} of the "
                         "preset table; where datum {:.12g} is, is not known. Motions are followed "
                         "as if it were the same, and are not proven clear",
                         *klartext.datum, row),
             core::rule_id("undecided"),
             "Check the parts of the program for each datum separately, with its work offset."});
    }
}

} // namespace

core::Result<void> define_cycle(Execution& execution) {
    const KlartextLine& command = klartext_of(execution.block);
    const int number = command.number;
    switch (number) {
    case 7:
    case 8:
    case 10:
    case 11:
    case 19:
        return change_coordinates(execution);
    case 9:
        if (const Word* word = execution.statement.word('P'))
            execution.emit(Dwell{std::max(word->value, 0.0)});
        return {};
    case 13:
        return {};
    case 32:
        if (command.part == 1) set_path_tolerance(execution);
        return {};
    case 220:
    case 221:
        return run_pattern(execution);
    case 247:
        set_datum(execution);
        return {};
    default:
        break;
    }
    KlartextState& klartext = writable_klartext(execution.state);
    klartext.calls_after_motions = false;
    if (number != 1) {
        if (auto checked = check_depth_reference(execution, number); !checked) return checked;
        if (command.feed_of_call && !klartext.call_feed)
            return core::fail(ErrorCode::missing_value,
                              "FAUTO: no TOOL CALL with F has been programmed yet", command.span);
        klartext.cycle = {.number = number, .feed_of_call = command.feed_of_call};
    } else if (command.part == 0)
        klartext.cycle = {.number = 1};
    else
        read_old_cycle(execution, klartext.cycle);
    return {};
}

namespace {

/// CYCL CALL POS: the word of the tool axis shifts the surface of the workpiece.
double shift_of_call(const Execution& execution) {
    const size_t normal = axes_of(execution.modal().plane).normal;
    const Word* word = klartext_of(execution.block).calls_at_point
                           ? execution.statement.word(axis_letters[normal])
                           : nullptr;
    return word ? length_of(execution, *word) : 0.0;
}

} // namespace

namespace {

core::Result<void> make_hole(Execution& execution, const DefinedCycle& cycle) {
    if (cycle.depth == 0.0) return {}; // as on the control
    if (auto checked = check(execution, cycle); !checked) return checked;
    ModalState& modal = execution.modal();
    const PlaneAxes axes = axes_of(modal.plane);
    const std::optional<double> here = modal.position[axes.normal];
    if (cycle.number == 1 && !here)
        return refuse_statement(execution,
                                "cycle 1 starts at the current position, which is unknown");
    const bool at_point = klartext_of(execution.block).calls_at_point;
    if (at_point && cycle.number == 1)
        return refuse_statement(execution, "cycle 1 has no surface coordinate: program the point "
                                           "in a block of its own before CYCL CALL");
    const double surface =
        cycle.number == 1 ? *here - cycle.clearance : cycle.surface + shift_of_call(execution);
    if (at_point)
        if (auto done = go_to_cycle(execution, surface, surface + cycle.clearance); !done)
            return done;
    execution.result.is_cycle = true;
    KlartextHole hole{
        execution, cycle, axes, surface, surface + cycle.clearance, surface + cycle.depth};
    const std::optional<double> feed = modal.feed;
    if (cycle.number != 1 && !at_point) hole.rapid(hole.above);
    if (auto done = machine(hole); !done) return done;
    modal.feed = feed;
    const double second = surface + cycle.second_clearance;
    if (cycle.number != 1 && second > hole.above) hole.rapid(second);
    return {};
}

} // namespace

core::Result<void> call_defined_cycle(Execution& execution) {
    if (klartext_of(execution.state).cycle.number == 0)
        return refuse_statement(execution,
                                "there is no cycle to call: no CYCL DEF has been programmed yet");
    FEELER_TRY(const DefinedCycle cycle, called_cycle(execution));
    return make_hole(execution, cycle);
}

namespace {

constexpr double most_positions = 10000.0;

/// The holes of a full circle or arc (220), or of rows rotated about the first hole (221).
core::Result<std::vector<PlanePoint>> positions_of(const Execution& execution) {
    const auto length = [&](int q) { return q_length(execution, q); };
    const auto plain = [&](int q) { return q_number(execution, q); };
    std::vector<PlanePoint> positions;
    if (klartext_of(execution.block).number == 220) {
        const double count = plain(241);
        if (!(count >= 1.0 && count <= most_positions))
            return refuse_statement(execution, "Q241, the number of holes, must be at least 1");
        double step = plain(247);
        // Q246 is used if no step is given. On a full circle the first hole is not repeated.
        const double sweep = plain(246) - plain(245);
        const bool full = std::abs(std::abs(sweep) - 360.0) < 1e-9;
        if (step == 0.0 && count > 1.0) step = sweep / (full ? count : count - 1.0);
        for (int i = 0; i < static_cast<int>(count); ++i) {
            const double angle = (plain(245) + i * step) * core::radians_per_degree;
            positions.push_back({length(216) + 0.5 * length(244) * core::cos(angle),
                                 length(217) + 0.5 * length(244) * core::sin(angle)});
        }
        return positions;
    }
    const double columns = plain(242), rows = plain(243);
    if (!(columns >= 1.0 && rows >= 1.0 && columns * rows <= most_positions))
        return refuse_statement(
            execution, "Q242 and Q243, the numbers of columns and rows, must be at least 1");
    const double turn = plain(224) * core::radians_per_degree;
    for (int row = 0; row < static_cast<int>(rows); ++row)
        for (int i = 0; i < static_cast<int>(columns); ++i) {
            // Every other row is drilled backwards.
            const int column = row % 2 == 0 ? i : static_cast<int>(columns) - 1 - i;
            const double along = column * length(237), across = row * length(238);
            positions.push_back({length(225) + along * core::cos(turn) - across * core::sin(turn),
                                 length(226) + along * core::sin(turn) + across * core::cos(turn)});
        }
    return positions;
}

/// Q365=1: the tool travels from hole to hole on the pitch circle.
void doubt_way_on_circle(Execution& execution) {
    execution.result.path = core::PathCertainty::doubtful;
    execution.result.warnings.push_back(
        {Severity::warning, klartext_of(execution.block).span,
         "CYCL DEF 220: with Q365=1 the tool travels from hole to hole on the pitch circle. The "
         "straight way is checked, and is not proven clear",
         core::rule_id("undecided"), "Program Q365=0, or the holes one by one."});
}

} // namespace

core::Result<void> run_pattern(Execution& execution) {
    if (klartext_of(execution.state).cycle.number < first_with_parameters)
        return refuse_statement(execution, "there is no cycle for the pattern to repeat: program "
                                           "the CYCL DEF of a cycle from 200 on first");
    FEELER_TRY(const DefinedCycle cycle, called_cycle(execution));
    if (q_number(execution, 365) != 0.0 && klartext_of(execution.block).number == 220)
        doubt_way_on_circle(execution);
    FEELER_TRY(const std::vector<PlanePoint> positions, positions_of(execution));
    const PlaneAxes axes = axes_of(execution.modal().plane);
    const bool high = q_number(execution, 301) != 0.0;
    const double above = cycle.surface + cycle.clearance;
    const double between = std::max(above, cycle.surface + cycle.second_clearance);
    for (size_t i = 0; i < positions.size(); ++i) {
        Position over = execution.modal().position;
        if (i == 0 || high) {
            over[axes.normal] = between;
            if (over != execution.modal().position) execution.traverse(over);
        }
        over[axes.first] = positions[i][0];
        over[axes.second] = positions[i][1];
        execution.traverse(over);
        DefinedCycle called = cycle;
        if (!high && i + 1 < positions.size()) called.second_clearance = 0.0;
        if (auto done = make_hole(execution, called); !done) return done;
    }
    return {};
}

} // namespace gcode
