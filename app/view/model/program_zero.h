#pragma once

#include <memory>
#include <optional>

#include "core/motion/event.h"

namespace core {
struct Machine;
struct Setup;
} // namespace core

namespace gcode {
struct InterpreterState;
struct Offsets;
} // namespace gcode

namespace render {
struct Triad;
} // namespace render

namespace app::viewer {

struct ProgramZero;

/// With the offsets, rotations and mirror images in effect; empty where they are unknown.
std::optional<ProgramZero> program_zero(const gcode::InterpreterState& control);

/// The offsets in effect, of a machine that lives as long as they do.
std::shared_ptr<const gcode::Offsets> offsets_in_effect(const gcode::InterpreterState& control,
                                                        const core::Machine& machine);

/// The arrows at the zero of the program, frame of the stock. `now`: the axes of the machine.
render::Triad triad_of(const ProgramZero& zero, const core::Setup& setup,
                       const core::AxisValues& now);

/// The arrows at the zero of the machine, where the gauge line is with all linear axes at 0.
render::Triad machine_triad(const core::Setup& setup, const core::AxisValues& now);

} // namespace app::viewer
