#include "app/view/model/axis_display.h"

#include <algorithm>
#include <cmath>

#include "app/view/model/scene_of.h"
#include "app/view/model/view_model.h"
#include "core/sim/setup.h"
#include "gcode/language/modal_state.h"

namespace app::viewer {
namespace {

/// Where the program has the axes at the cursor; in the block shown last while the worker makes the
/// current one.
std::optional<core::AxisValues> axes_of_program(const ViewModel& model) {
    const BlockState* view = model.block_state.get();
    if (!view) return {};
    const double fraction = view->block == model.cursor.block ? model.cursor.fraction : 1.0;
    if (const auto pose = pose_at(view->poses, fraction)) return pose;
    return view->standing;
}

/// Whether an axis moves in a block, by more than rounding.
bool moves_in(const BlockState& view, size_t axis) {
    constexpr double rounding = 1e-9;
    return std::any_of(view.poses.begin(), view.poses.end(), [&](const Pose& pose) {
        return std::abs(pose.values[axis] - view.poses.front().values[axis]) > rounding;
    });
}

} // namespace

bool is_jogged(const ViewModel& model) {
    return model.jog && model.jog->opening == model.opening && model.jog->from == model.cursor
           && model.block_state && model.block_state->block == model.cursor.block;
}

std::optional<core::AxisValues> shown_axes(const ViewModel& model) {
    return is_jogged(model) ? model.jog->values : axes_of_program(model);
}

std::vector<AxisRow> axis_rows(const ViewModel& model) {
    const auto values = shown_axes(model), planned = axes_of_program(model);
    if (!values || !model.block_state->scene) return {};
    const BlockState& view = *model.block_state;
    const core::Machine& machine = view.scene->setup.machine;
    gcode::Position program;
    if (view.offsets_in_effect) {
        std::copy(values->begin(), values->end(), program.begin());
        program = gcode::program_from_machine(*view.offsets_in_effect, program);
    }
    std::vector<AxisRow> rows;
    for (size_t axis = 0; axis < core::axis_count; ++axis) {
        const core::MachineAxis& range = machine.axes[axis];
        if (!range.present) continue;
        AxisRow row{.axis = axis, .machine = (*values)[axis], .program = program[axis]};
        if (range.min) row.below = row.machine - *range.min;
        if (range.max) row.above = *range.max - row.machine;
        row.moves = is_jogged(model) ? row.machine != (*planned)[axis] : moves_in(view, axis);
        rows.push_back(row);
    }
    return rows;
}

void jog(ViewModel& model, size_t axis, double machine) {
    const auto now = shown_axes(model);
    if (!now || !model.block_state->scene || model.block_state->block != model.cursor.block) return;
    const core::MachineAxis& range = model.block_state->scene->setup.machine.axes[axis];
    const double at = (*now)[axis]; // the program may have it beyond a limit
    if (range.min) machine = std::max(machine, std::min(*range.min, at));
    if (range.max) machine = std::min(machine, std::max(*range.max, at));
    model.playback.running = false;
    model.jog = Jog{model.opening, model.cursor, *now};
    model.jog->values[axis] = machine;
}

void end_jog(ViewModel& model) { model.jog.reset(); }

} // namespace app::viewer
