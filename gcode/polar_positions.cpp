#include <fmt/format.h>

#include "gcode/frame_codes.h"

namespace gcode {
namespace {

using core::ErrorCode;

tl::unexpected<core::Error> unknown_place(const Execution& execution, size_t axis) {
    const Word& mover = moving_word(execution);
    return core::fail(ErrorCode::missing_value,
                      fmt::format("{}: under G16 this counts from where the machine is, and that "
                                  "is unknown along {}",
                                  written(mover), axis_letters[axis]),
                      mover.span);
}

} // namespace

core::Result<void> take_polar_words(Execution& execution) {
    ModalState& modal = execution.modal();
    if (!modal.transforms.polar) return {};
    PolarPositions& polar = *modal.transforms.polar;
    const PlaneAxes axes = axes_of(modal.plane);
    const bool incremental = modal.distance == DistanceMode::incremental;
    if (const Word* word = execution.statement.word(axis_letters[axes.first])) {
        polar.origin = {};
        for (const size_t i : {size_t{0}, size_t{1}}) {
            const size_t axis = i == 0 ? axes.first : axes.second;
            if (!incremental) continue;
            if (!modal.position[axis]) return unknown_place(execution, axis);
            polar.origin[i] = *modal.position[axis];
        }
        polar.radius = length_of(execution, *word);
    }
    if (const Word* word = execution.statement.word(axis_letters[axes.second]))
        polar.angle_deg = word->value + (incremental ? polar.angle_deg.value_or(0.0) : 0.0);
    return {};
}

void place_by_radius_and_angle(const Execution& execution, Position& target) {
    const ModalState& modal = execution.modal();
    const PolarPositions& polar = *modal.transforms.polar;
    const PlaneAxes axes = axes_of(modal.plane);
    const core::Mat3 turn = turned_about(2, polar.angle_deg.value_or(0.0));
    const double radius = polar.radius.value_or(0.0);
    target[axes.first] = polar.origin[0] + radius * turn[0][0];
    target[axes.second] = polar.origin[1] + radius * turn[0][1];
}

} // namespace gcode
