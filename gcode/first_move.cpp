#include <cmath>

#include <fmt/format.h>

#include "gcode/frame_codes.h"

namespace gcode {
namespace {

bool moves_in_machine(const Execution& execution) {
    const CodeWord* action = execution.statement.of(ModalGroup::action);
    return action && action->code->tenths == tenths(53);
}

} // namespace

std::optional<size_t> axis_left_out_of_rotation(const Execution& execution) {
    const ModalState& modal = execution.modal();
    const auto& before = modal.transforms.before_rotation;
    if (!before || !modal.transforms.rotation || moves_in_machine(execution)
        || modal.distance == DistanceMode::incremental || modal.transforms.polar)
        return std::nullopt;
    const auto normal = static_cast<size_t>(modal.transforms.rotation->normal);
    const size_t first = (normal + 1) % 3, second = (normal + 2) % 3;
    const bool has_first = execution.statement.word(axis_letters[first]);
    const bool has_second = execution.statement.word(axis_letters[second]);
    if (has_first == has_second) return std::nullopt;
    const size_t left_out = has_first ? second : first;
    const auto &old = (*before)[left_out], &now = modal.position[left_out];
    if (old == now || (old && now && std::abs(*old - *now) < 1e-9)) return std::nullopt;
    return left_out;
}

void warn_of_axis_left_out(Execution& execution) {
    if (const auto axis = axis_left_out_of_rotation(execution))
        execution.warn(moving_word(execution).span,
                       fmt::format("the first move after G68 does not name {}, and a parameter of "
                                   "the control says where that is: write both axes",
                                   axis_letters[*axis]));
}

void forget_place_before_rotation(Execution& execution) {
    ProgramTransforms& transforms = execution.modal().transforms;
    if (!transforms.before_rotation || !transforms.rotation) return;
    const auto normal = static_cast<size_t>(transforms.rotation->normal);
    for (const size_t axis : {(normal + 1) % 3, (normal + 2) % 3})
        if (execution.statement.word(axis_letters[axis])) {
            transforms.before_rotation.reset();
            return;
        }
}

} // namespace gcode
