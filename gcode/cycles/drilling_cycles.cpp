#include <algorithm>
#include <array>
#include <cassert>

#include "gcode/cycles/cycles.h"
#include "gcode/cycles/rs274_cycles.h"
#include "gcode/exec/readings.h"
#include "gcode/language/control.h"

namespace gcode {
namespace {

void drill(Drilling& hole) { // G81
    hole.feed(hole.bottom);
    hole.traverse(hole.clear);
}

void drill_and_dwell(Drilling& hole) { // G82
    hole.feed(hole.bottom);
    hole.dwell();
    hole.traverse(hole.clear);
}

/// The factor by which Fanuc's scaling scales the drilling axis. Q and the retract of G73 and G83
/// are not scaled.
///
/// Source: Fanuc 30i user's manual B-63944EN-2, "Scaling", invalid scaling.
double stretch_along(const Execution& execution, size_t normal) {
    const auto& scaling = execution.modal().transforms.scaling;
    return scaling ? std::abs(scaling->factors[static_cast<int>(normal)]) : 1.0;
}

/// What a parameter of the control says of pecks, mm; empty if this control has none.
std::optional<double> said_of_pecks(Execution& execution, ControlQuestion question) {
    if (!find_parameter(question, execution.environment.dialect)) return std::nullopt;
    return number_for(execution.state, execution.environment, question, execution.block.line);
}

/// How far a peck retracts in the hole, or from where the next one feeds again. Haas has one
/// setting for both.
double peck_clearance(Execution& execution, bool out_of_the_hole) {
    if (out_of_the_hole)
        if (const auto said = said_of_pecks(execution, ControlQuestion::peck_clearance))
            return *said;
    return said_of_pecks(execution, ControlQuestion::peck_retract)
        .value_or(execution.dialect.peck_clearance);
}

void peck(Drilling& hole, bool out_of_the_hole) {
    const double stretch = stretch_along(hole.execution, hole.normal);
    const double back = peck_clearance(hole.execution, out_of_the_hole) / stretch;
    double out = hole.r;
    if (out_of_the_hole)
        out += said_of_pecks(hole.execution, ControlQuestion::peck_lift).value_or(0.0) / stretch;
    const std::array<double, 3>& shrinking = hole.cycle.shift;
    double step = (shrinking[0] > 0.0 ? shrinking[0] : *hole.cycle.peck) / stretch;
    const bool stays_low = !hole.execution.dialect.cycles_are_rs274;
    for (double depth = hole.r - step; depth > hole.bottom; depth -= step) {
        hole.feed(depth);
        if (out_of_the_hole) hole.traverse(out);
        hole.traverse(stays_low ? std::min(depth + back, hole.r) : depth + back);
        if (shrinking[0] > 0.0)
            step = std::max(step - shrinking[1] / stretch, shrinking[2] / stretch);
    }
    hole.feed(hole.bottom);
    hole.dwell();
    hole.traverse(hole.clear);
}

void break_chips(Drilling& hole) { peck(hole, false); } // G73: retracts only a short distance
void clear_chips(Drilling& hole) { peck(hole, true); }  // G83: retracts out of the hole

constexpr auto rs274 = &Dialect::cycles_are_rs274;
constexpr auto back_boring = &Dialect::g87_is_back_boring;

constexpr DrillingCycle drilling_cycles[] = {
    {g_code(73), {.pecks = true}, break_chips},
    {g_code(74), {.taps = true, .is_left_hand = true}, tap_with_reversal, rs274},
    {g_code(74), {.taps = true, .is_left_hand = true}, tap},
    {g_code(76), {.shifts = true}, bore_finely},
    {g_code(77), {.shifts = true, .works_upwards = true}, bore_from_the_back},
    {g_code(81), {}, drill},
    {g_code(82), {.needs_dwell = true}, drill_and_dwell},
    {g_code(83), {.pecks = true}, clear_chips},
    {g_code(84), {.taps = true}, tap_with_reversal, rs274},
    {g_code(84), {.taps = true}, tap},
    {g_code(85), {}, bore_and_feed_out},
    {g_code(86), {.needs_dwell = true, .stops_spindle = true}, bore_with_stop},
    {g_code(87), {.shifts = true, .stops_spindle = true}, bore_back_to_middle, rs274},
    {g_code(87), {.shifts = true, .works_upwards = true}, bore_from_the_back, back_boring},
    {g_code(87), {}, bore_and_retract_by_hand},
    {g_code(88), {.needs_dwell = true, .stops_spindle = true}, bore_and_stop, rs274},
    {g_code(88), {}, bore_and_retract_by_hand},
    {g_code(89), {.needs_dwell = true}, bore_dwell_and_feed_out},
};

} // namespace

const DrillingCycle& drilling_cycle(CodeNumber code, const Dialect& dialect) {
    const auto* found = std::find_if(
        std::begin(drilling_cycles), std::end(drilling_cycles), [&](const DrillingCycle& cycle) {
            return cycle.code == code && (!cycle.only_where || dialect.*cycle.only_where);
        });
    assert(found != std::end(drilling_cycles));
    return *found;
}

} // namespace gcode
