#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "core/base/units.h"
#include "gcode/klartext.h"

namespace gcode {
namespace {

constexpr double most_places = 10000.0;

/// The holes of a circle or its part (220), or of rows that are turned about the first (221).
core::Result<std::vector<PlanePoint>> places_of(const Execution& execution) {
    const auto length = [&](int q) { return q_length(execution, q); };
    const auto plain = [&](int q) { return q_number(execution, q); };
    std::vector<PlanePoint> places;
    if (execution.block.command.number == 220) {
        const double count = plain(241);
        if (!(count >= 1.0 && count <= most_places))
            return refuse_statement(execution, "Q241 is the number of holes, from 1");
        double step = plain(247);
        // Q246 counts when no step is given; a full circle has no hole twice.
        const double sweep = plain(246) - plain(245);
        const bool full = std::abs(std::abs(sweep) - 360.0) < 1e-9;
        if (step == 0.0 && count > 1.0) step = sweep / (full ? count : count - 1.0);
        for (int i = 0; i < static_cast<int>(count); ++i) {
            const double angle = (plain(245) + i * step) * core::radians_per_degree;
            places.push_back({length(216) + 0.5 * length(244) * std::cos(angle),
                              length(217) + 0.5 * length(244) * std::sin(angle)});
        }
        return places;
    }
    const double columns = plain(242), rows = plain(243);
    if (!(columns >= 1.0 && rows >= 1.0 && columns * rows <= most_places))
        return refuse_statement(execution, "Q242 and Q243 are the numbers of columns and lines, "
                                           "from 1");
    const double turn = plain(224) * core::radians_per_degree;
    for (int row = 0; row < static_cast<int>(rows); ++row)
        for (int i = 0; i < static_cast<int>(columns); ++i) {
            // Every other line is gone along backwards.
            const int column = row % 2 == 0 ? i : static_cast<int>(columns) - 1 - i;
            const double along = column * length(237), across = row * length(238);
            places.push_back({length(225) + along * std::cos(turn) - across * std::sin(turn),
                              length(226) + along * std::sin(turn) + across * std::cos(turn)});
        }
    return places;
}

} // namespace

core::Result<void> run_pattern(Execution& execution) {
    DefinedCycle cycle = execution.state.klartext->cycle;
    if (cycle.number < 200)
        return refuse_statement(execution, "there is no cycle from 200 on that the pattern could "
                                           "repeat: no CYCL DEF of one came before it");
    cycle.clearance = std::abs(q_length(execution, 200));
    cycle.surface = q_length(execution, 203);
    cycle.second_clearance = std::abs(q_length(execution, 204));
    FEELER_TRY(const std::vector<PlanePoint> places, places_of(execution));
    const PlaneAxes axes = axes_of(execution.modal().plane);
    const bool high = q_number(execution, 301) != 0.0;
    const double above = cycle.surface + cycle.clearance;
    const double between = std::max(above, cycle.surface + cycle.second_clearance);
    for (size_t i = 0; i < places.size(); ++i) {
        Position over = execution.modal().position;
        if (i == 0 || high) {
            over[axes.normal] = between;
            if (over != execution.modal().position) execution.traverse(over);
        }
        over[axes.first] = places[i][0];
        over[axes.second] = places[i][1];
        execution.traverse(over);
        DefinedCycle& called = execution.state.klartext.write().cycle;
        called = cycle;
        if (!high && i + 1 < places.size()) called.second_clearance = 0.0;
        if (auto done = call_defined_cycle(execution); !done) return done;
    }
    return {};
}

} // namespace gcode
