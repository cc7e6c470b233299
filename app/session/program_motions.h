#pragma once

#include <functional>
#include <optional>

#include "core/sim/event.h"
#include "gcode/environment.h"
#include "gcode/interpreter.h"
#include "gcode/offsets.h"

namespace app {

/// What a program does next, as far as it can be read: one event of one block, the tool that is in
/// the spindle, the offsets that are in effect, and the line it comes from.
struct ProgramEvent {
    const core::Event& event;
    std::optional<core::ToolNumber> tool;
    const gcode::Offsets& offsets;
    uint32_t line = 0;
    bool is_cycle = false;
};

/// Runs a program to its end or its first error and shows every event. Nothing is checked.
void visit_events(const gcode::Program& program, const gcode::Environment& environment,
                  const std::function<void(const ProgramEvent&)>& visit);

} // namespace app
