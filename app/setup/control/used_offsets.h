#pragma once

#include <optional>
#include <set>

#include "core/base/ids.h"
#include "core/base/result.h"

namespace gcode {
struct Environment;
struct Program;
} // namespace gcode

namespace app {

/// The offsets of the control that a program relies on. Those that it sets itself are not among
/// them.
struct UsedOffsets {
    std::set<size_t> work;                           // by index, 0 is G54
    std::set<core::OffsetNumber> lengths, diameters; // under H and D
    std::optional<core::Error> stopped;              // why the program was not read to its end
};

/// Runs a program to its end or its first error.
///
/// Cost:    as a trace of the program.
UsedOffsets used_offsets(const gcode::Program& program, const gcode::Environment& environment);

} // namespace app
