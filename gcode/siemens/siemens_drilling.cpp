#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/base/math.h"
#include "core/base/rule_table.h"
#include "core/base/units.h"
#include "gcode/language/error_rules.h"
#include "gcode/siemens/siemens.h"

namespace gcode {
namespace {

using core::ErrorCode;

/// A cycle at one hole. Heights are program coordinates along the tool axis.
struct SiemensHole {
    Execution& execution;
    const SiemensDrilling& cycle;
    size_t normal;
    double rate;  // mm/min
    double above; // reference plane plus safety distance

    void rapid(double height) {
        Position end = execution.modal().position;
        end[normal] = height;
        if (end != execution.modal().position) execution.traverse(end);
    }
    void feed(double height, double feed_rate) {
        Position end = execution.modal().position;
        end[normal] = height;
        execution.feed(end, feed_rate);
    }
    void feed(double height) { feed(height, rate); }

    /// A negative time is in spindle revolutions.
    void dwell(double time) {
        const double speed = execution.modal().speed;
        if (time > 0.0) execution.emit(Dwell{time});
        if (time < 0.0 && speed > 0.0) execution.emit(Dwell{-time * 60.0 / speed});
    }
};

tl::unexpected<core::Error> refuse_cycle(const Execution& execution, int number,
                                         std::string_view why) {
    return core::fail(no_feed, fmt::format("CYCLE{}: {}", number, why),
                      {.line = execution.block.line, .column = execution.column, .length = 1});
}

core::Result<double> modal_rate(const Execution& execution, int number) {
    const ModalState& modal = execution.modal();
    if (!modal.feed || *modal.feed <= 0.0) return refuse_cycle(execution, number, no_feed_yet);
    if (modal.feed_mode == FeedMode::inverse_time)
        return refuse_cycle(execution, number,
                            "a cycle cannot run in inverse-time feed mode (G93)");
    if (modal.feed_mode == FeedMode::per_minute) return *modal.feed;
    if (modal.speed <= 0.0)
        return refuse_cycle(execution, number, "with G95 the spindle needs a speed S");
    return *modal.feed * modal.speed;
}

/// The depths of the strokes of CYCLE83 below the reference plane.
///
/// Source: SINUMERIK 840D, Programming Guide Cycles (PGZ), "Deep hole drilling - CYCLE83": each
///         stroke is shorter than the previous one by the degression until it would be shorter than
///         that amount; then the strokes have that length, and the last two are equal.
std::vector<double> depths_of(const SiemensDrilling& cycle) {
    const double total = cycle.reference - cycle.bottom, degression = cycle.degression;
    double stroke = cycle.reference - cycle.first_depth;
    std::vector<double> depths{std::min(stroke, total)};
    while (depths.back() < total - 1e-9 && depths.size() < most_commands / 8) {
        const double rest = total - depths.back();
        if (degression > 0.0) stroke = std::max(stroke - degression, degression);
        if (degression < 0.0) stroke *= std::min(-degression, 1.0);
        stroke = std::max({stroke, cycle.least_peck, 1e-3});
        double next = std::min(stroke, rest);
        const bool levels_off = degression > 0.0 && stroke <= degression && rest > stroke;
        if (levels_off && rest < 2.0 * stroke) {
            depths.push_back(depths.back() + rest / 2.0);
            next = rest / 2.0;
        }
        depths.push_back(depths.back() + next);
    }
    return depths;
}

core::Result<void> drill_deep(SiemensHole& hole) {
    const SiemensDrilling& cycle = hole.cycle;
    const double total = cycle.reference - cycle.bottom;
    const double near = cycle.near > 0.0 ? cycle.near
                        : total <= 30.0  ? 0.6
                                         : std::min(total / 50.0, 7.0);
    const std::vector<double> depths = depths_of(cycle);
    if (depths.back() < total - 1e-6)
        return refuse_cycle(hole.execution, 83, "the hole needs too many strokes");
    for (size_t i = 0; i < depths.size(); ++i) {
        const bool last = i + 1 == depths.size();
        const double level = last ? cycle.bottom : cycle.reference - depths[i];
        hole.feed(level, i == 0 ? hole.rate * cycle.feed_factor : hole.rate);
        hole.dwell(last ? cycle.dwell_final : cycle.dwell_below);
        if (last) break;
        if (cycle.clears_chips) {
            hole.rapid(hole.above);
            hole.dwell(cycle.dwell_above);
            hole.rapid(std::min(level + near, hole.above));
        } else {
            hole.feed(level + cycle.break_back);
        }
    }
    return {};
}

/// CYCLE84 and CYCLE840: feed in and out with the spindle reversed in between.
core::Result<void> tap_hole(SiemensHole& hole) {
    const SiemensDrilling& cycle = hole.cycle;
    Execution& execution = hole.execution;
    ModalState& modal = execution.modal();
    const bool rigid = cycle.number == 84;
    const double speed_before = modal.speed;
    const double in = cycle.speed_in > 0.0 ? cycle.speed_in : modal.speed;
    const double out = cycle.speed_out > 0.0 ? cycle.speed_out : in;
    const double pitch = std::abs(cycle.pitch);
    if (pitch > 0.0 && !(in > 0.0))
        return refuse_cycle(execution, cycle.number, "the spindle has no speed: program S or SST");
    const bool left =
        rigid ? cycle.pitch < 0.0 : modal.spindle == core::SpindleDirection::counterclockwise;
    modal.speed = in;
    turn_siemens_spindle(execution, left ? 4 : 3);
    hole.feed(cycle.bottom, pitch > 0.0 ? pitch * in : hole.rate);
    hole.dwell(cycle.dwell_below);
    modal.speed = out;
    turn_siemens_spindle(execution, left ? 3 : 4);
    hole.feed(hole.above, pitch > 0.0 ? pitch * out : hole.rate);
    modal.speed = speed_before;
    turn_siemens_spindle(execution, cycle.direction_after);
    return {};
}

/// CYCLE86: moves off the wall with the spindle stopped, out, and back to the centre.
void bore_hole(SiemensHole& hole) {
    const SiemensDrilling& cycle = hole.cycle;
    Execution& execution = hole.execution;
    const PlaneAxes axes = axes_of(execution.modal().plane);
    turn_siemens_spindle(execution, cycle.direction);
    hole.feed(cycle.bottom);
    hole.dwell(cycle.dwell_below);
    turn_siemens_spindle(execution, 5);
    const Position middle = execution.modal().position;
    Position aside = middle;
    const size_t order[] = {axes.first, axes.second, axes.normal};
    for (size_t i = 0; i < 3; ++i)
        if (aside[order[i]]) *aside[order[i]] += cycle.aside[i];
    if (aside != middle) execution.traverse(aside);
    hole.rapid(hole.above);
    Position back = middle;
    back[axes.normal] = cycle.retract;
    execution.traverse(back);
    turn_siemens_spindle(execution, cycle.direction);
}

/// CYCLE87 and CYCLE88: the operator starts the retract.
void bore_and_wait(SiemensHole& hole) {
    const SiemensDrilling& cycle = hole.cycle;
    turn_siemens_spindle(hole.execution, cycle.direction);
    hole.feed(cycle.bottom);
    hole.dwell(cycle.dwell_below);
    turn_siemens_spindle(hole.execution, 5);
    hole.execution.emit(ProgramStop{});
}

core::Result<void> machine_hole(SiemensHole& hole) {
    const SiemensDrilling& cycle = hole.cycle;
    switch (cycle.number) {
    case 83:
        return drill_deep(hole);
    case 84:
    case 840:
        return tap_hole(hole);
    case 85:
        hole.feed(cycle.bottom, cycle.feed_in > 0.0 ? cycle.feed_in : hole.rate);
        hole.dwell(cycle.dwell_below);
        hole.feed(hole.above, cycle.feed_out > 0.0 ? cycle.feed_out : hole.rate);
        return {};
    case 86:
        bore_hole(hole);
        return {};
    case 87:
    case 88:
        bore_and_wait(hole);
        return {};
    case 89:
        hole.feed(cycle.bottom);
        hole.dwell(cycle.dwell_below);
        hole.feed(hole.above);
        return {};
    default: // 81, 82
        hole.feed(cycle.bottom);
        hole.dwell(cycle.dwell_below);
        return {};
    }
}

struct HolePosition {
    double first, second;
};

/// The holes of HOLES1 (SPCA, SPCO, STA1, FDIS, DBH, NUM), starting at the end of the row nearer to
/// the tool, or of HOLES2 (CPA, CPO, RAD, STA1, INDA, NUM).
std::vector<HolePosition> positions_of(const Execution& execution, bool row,
                                       const std::vector<double>& given, int count) {
    const auto mm = [&](double value) { return to_mm(value, execution.modal().unit); };
    std::vector<HolePosition> positions;
    for (int i = 0; i < count; ++i) {
        const double step = given[4] == 0.0 ? 360.0 / count : given[4];
        const double angle = (row ? given[2] : given[3] + i * step) * core::radians_per_degree;
        const double reach = row ? mm(given[3]) + i * mm(given[4]) : mm(given[2]);
        positions.push_back(
            {mm(given[0]) + reach * core::cos(angle), mm(given[1]) + reach * core::sin(angle)});
    }
    const PlaneAxes axes = axes_of(execution.modal().plane);
    const auto &x = execution.modal().position[axes.first],
               &y = execution.modal().position[axes.second];
    const auto far = [&](const HolePosition& position) {
        return core::hypot(position.first - *x, position.second - *y);
    };
    if (row && x && y && far(positions.back()) < far(positions.front()))
        std::reverse(positions.begin(), positions.end());
    return positions;
}

} // namespace

core::Result<void> drill_here(Execution& execution, const SiemensDrilling& cycle) {
    const bool has_pitch = cycle.number == 84 || (cycle.number == 840 && cycle.pitch != 0.0);
    const bool has_feeds = cycle.number == 85 && cycle.feed_in > 0.0 && cycle.feed_out > 0.0;
    SiemensHole hole{execution, cycle, axes_of(execution.modal().plane).normal, 0.0,
                     cycle.reference + cycle.safety};
    if (!has_pitch && !has_feeds) {
        FEELER_TRY(hole.rate, modal_rate(execution, cycle.number));
    }
    execution.result.is_cycle = true;
    settle_length(execution, true);
    forget_travel(execution, hole.normal);
    hole.rapid(hole.above);
    if (auto done = machine_hole(hole); !done) return done;
    hole.rapid(cycle.retract);
    return {};
}

namespace {

/// Reports a list of positions that are left out, _HIDE.
core::Result<void> check_hidden_positions(const Execution& execution,
                                          const SiemensKeywordUse& use) {
    for (const SiemensArgument& argument : siemens_of(execution.block).arguments)
        if (argument.kind == SiemensArgument::Kind::text && !argument.text.empty())
            return core::fail(ErrorCode::unsupported,
                              fmt::format("{}: \"{}\" leaves out positions, which is not supported "
                                          "yet: program the positions one by one",
                                          use.keyword->name, argument.text),
                              argument.span);
    return {};
}

/// Whether the tool travels from hole to hole on the circle: the tens digit of _VARI.
bool travels_on_circle(const std::vector<std::optional<double>>& values) {
    if (values.size() <= 6) return false;
    return std::fmod(std::floor(std::abs(values[6].value_or(0.0)) / 10.0), 10.0) != 0.0;
}

} // namespace

core::Result<void> run_siemens_holes(Execution& execution, const SiemensKeywordUse& use) {
    if (auto checked = check_hidden_positions(execution, use); !checked) return checked;
    FEELER_TRY(const auto values, cycle_values(execution, use));
    constexpr int most_holes = 10000;
    std::vector<double> given(6, 0.0);
    for (size_t i = 0; i < std::min<size_t>(values.size(), 6); ++i)
        given[i] = values[i].value_or(0.0);
    const bool row = use.keyword->action == SiemensAction::hole_row;
    const double count = given[5];
    if (!(count >= 1.0 && count <= most_holes && count == std::floor(count)))
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{}: parameter 6 (NUM), the number of holes, must be a whole "
                                      "number from 1 to {}, but is {:.12g}",
                                      use.keyword->name, most_holes, count),
                          use.span);
    if (!row && travels_on_circle(values)) {
        execution.result.path = core::PathCertainty::doubtful;
        execution.result.warnings.push_back(
            {Severity::warning, use.span,
             fmt::format("{}: parameter 7 is {:.12g}: the tool may travel from hole to hole on the "
                         "circle. The straight way is checked, and is not proven clear",
                         use.keyword->name, *values[6]),
             core::rule_id("undecided"),
             "Set the tens digit of parameter 7 to 0, or program the holes one by one."});
    }
    const std::optional<SiemensDrilling> cycle = siemens_of(execution.state).modal_cycle;
    if (!cycle)
        execution.warn(use.span, fmt::format("{}: no drilling cycle is active (MCALL), so the tool "
                                             "moves to the positions without drilling",
                                             use.keyword->name));
    const PlaneAxes axes = axes_of(execution.modal().plane);
    for (const HolePosition& position :
         positions_of(execution, row, given, static_cast<int>(count))) {
        Position over = execution.modal().position;
        over[axes.first] = position.first;
        over[axes.second] = position.second;
        execution.traverse(over);
        if (!cycle) continue;
        if (auto drilled = drill_here(execution, *cycle); !drilled) return drilled;
        if (execution.result.commands.size() > most_commands)
            return core::fail(ErrorCode::invalid_value,
                              fmt::format("{}: this block gives more than {} moves",
                                          use.keyword->name, most_commands),
                              use.span);
    }
    execution.result.is_cycle = true;
    return {};
}

} // namespace gcode
