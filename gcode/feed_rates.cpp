#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "gcode/error_rules.h"
#include "gcode/execution.h"

namespace gcode {

namespace {

/// How fast the spindle turns, rev/min. Under G96 that hangs on the distance from its axis: that of
/// where the motion begins is taken for the whole of it.
double turns_a_minute(const ModalState& modal) {
    if (!modal.surface_speed) return modal.speed;
    const double speed = modal.speed * (modal.unit == LengthUnit::inch ? 304.8 : 1000.0); // mm/min
    constexpr double least_radius = 0.01; // mm; at the axis itself no speed is fast enough
    const double radius = std::max(std::abs(modal.position[0].value_or(0.0)), least_radius);
    const double turns = speed / (2.0 * std::numbers::pi * radius);
    return modal.fastest_speed > 0.0 ? std::min(turns, modal.fastest_speed) : turns;
}

} // namespace

std::optional<double> way_between(const Position& from, const Position& to) {
    // The rate is along X, Y, Z, or, when these stand, along U, V, W, or the rotary axes.
    for (const size_t first : {size_t{0}, size_t{6}, size_t{3}}) {
        double squared = 0.0;
        for (size_t axis = first; axis < first + 3; ++axis) {
            if (from[axis] == to[axis]) continue;
            if (!from[axis] || !to[axis]) return std::nullopt;
            squared += (*to[axis] - *from[axis]) * (*to[axis] - *from[axis]);
        }
        if (squared > 0.0) return std::sqrt(squared);
    }
    return 0.0;
}

core::Result<double> feed_rate(const Execution& execution, std::optional<double> path_length) {
    const ModalState& modal = execution.modal();
    const auto refuse = [&](std::string_view why) {
        const Word& mover = moving_word(execution);
        return core::fail(no_feed, fmt::format("{}: {}", written(mover), why), mover.span);
    };
    const bool inverse = modal.feed_mode == FeedMode::inverse_time;
    if (inverse && !execution.statement.word('F'))
        return refuse("under G93 every feed needs its own F word");
    if (!modal.feed) return refuse("this motion has no feed rate, no F word came before it");
    if (*modal.feed == 0.0) return refuse("this motion has the feed rate F0");
    if (modal.feed_mode == FeedMode::per_minute) return *modal.feed;
    if (inverse && !path_length)
        return refuse("G93 gives no feed rate here, where the motion starts is unknown");
    const bool has_slowest = execution.dialect.system_parameters == SystemParameters::rs274;
    const double slowest = has_slowest ? to_mm(0.1, modal.unit) : 0.0; // a minute
    if (inverse) return std::max(slowest, *modal.feed * *path_length);
    if (modal.spindle == core::SpindleDirection::stopped || modal.speed == 0.0)
        return refuse("G95 gives no feed rate here, the spindle does not turn");
    return *modal.feed * turns_a_minute(modal);
}

} // namespace gcode
