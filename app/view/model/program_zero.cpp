#include "app/view/model/program_zero.h"

#include "app/debug/inspected_value.h"
#include "app/view/model/session_update.h"
#include "core/sim/setup.h"
#include "gcode/exec/interpreter.h"
#include "render/scene.h"
#include "render/setup_scene.h"

namespace app::viewer {
namespace {

std::optional<core::AxisValues> machine_position(const gcode::Offsets& offsets,
                                                 const gcode::Position& program) {
    core::AxisValues values{};
    const gcode::Position found = gcode::machine_from_program(offsets, program);
    for (size_t axis = 0; axis < values.size(); ++axis) {
        if (!found[axis] && axis < 3) return {};
        values[axis] = found[axis].value_or(0.0);
    }
    return values;
}

/// The arrows through four points of the gauge line.
render::Triad triad_through(const core::Setup& setup,
                            const std::array<core::AxisValues, 4>& positions) {
    render::Triad triad;
    triad.origin = render::tip_in_stock(setup, 0.0, positions[0]);
    for (int axis = 0; axis < 3; ++axis) {
        const core::Vec3 to =
            render::tip_in_stock(setup, 0.0, positions[static_cast<size_t>(axis) + 1]);
        const double length = glm::length(to - triad.origin);
        if (length > 0.0) triad.axes[axis] = (to - triad.origin) / length;
    }
    return triad;
}

} // namespace

std::optional<ProgramZero> program_zero(const gcode::InterpreterState& control) {
    gcode::Offsets offsets = control.modal.offsets;
    offsets.tool = {};
    ProgramZero zero;
    zero.name = offset_name(offsets.active);
    zero.turns_with_work = gcode::is_fixed_to_work(offsets);
    for (size_t i = 0; i < zero.positions.size(); ++i) {
        gcode::Position program = gcode::zero_position;
        if (i > 0) program[i - 1] = 1.0;
        const auto position = machine_position(offsets, program);
        if (!position) return {};
        zero.positions[i] = *position;
    }
    return zero;
}

std::shared_ptr<const gcode::Offsets> offsets_in_effect(const gcode::InterpreterState& control,
                                                        const core::Machine& machine) {
    auto offsets = std::make_shared<gcode::Offsets>(control.modal.offsets);
    if (offsets->machine) offsets->machine = &machine;
    return offsets;
}

render::Triad triad_of(const ProgramZero& zero, const core::Setup& setup,
                       const core::AxisValues& now) {
    std::array<core::AxisValues, 4> positions = zero.positions;
    for (core::AxisValues& values : positions)
        for (size_t axis = 0; axis < values.size(); ++axis)
            if (core::is_rotary(axis) && !zero.turns_with_work) values[axis] = now[axis];
    render::Triad triad = triad_through(setup, positions);
    triad.name = zero.name;
    return triad;
}

render::Triad machine_triad(const core::Setup& setup, const core::AxisValues& now) {
    std::array<core::AxisValues, 4> positions{};
    for (size_t i = 0; i < positions.size(); ++i) {
        for (size_t axis = 0; axis < now.size(); ++axis)
            positions[i][axis] = core::is_rotary(axis) ? now[axis] : 0.0;
        if (i > 0) positions[i][i - 1] = 1.0;
    }
    render::Triad triad = triad_through(setup, positions);
    triad.name = "machine zero";
    triad.is_minor = true;
    return triad;
}

} // namespace app::viewer
