#pragma once

#include <optional>
#include <string>
#include <variant>

#include "core/base/ids.h"
#include "core/base/result.h"
#include "core/base/vec.h"

namespace core {
struct Setup;
struct ToolAssembly;
} // namespace core

namespace app {

struct RunState;

/// A tool clamped deeper or less deep in its holder: changes stick-out, gauge length and visible
/// length of the shank. Without a holder only the gauge length changes. The length offset in the
/// control does not change.
struct ToolLengthChange {
    core::ToolNumber tool{};
    double length = 0.0; // gauge length, mm
};

/// Another length in the offset table of the control, including wear. Takes effect at once if the
/// offset is active.
struct LengthOffsetOverride {
    core::OffsetNumber number{};
    double length = 0.0; // mm
};

/// Another origin of a work offset. Takes effect at once if the offset is active; bodies do not
/// move.
struct WorkOffsetChange {
    size_t index = 0;    // 0 is G54
    size_t axis = 0;     // index in gcode::axis_letters
    double origin = 0.0; // machine coordinates, mm or degrees
};

/// Another general allowance; empty: the default ones.
struct AllowanceChange {
    std::optional<double> distance;
};

/// A fixture that is moved.
struct MovedFixture {
    std::string name;
    core::Vec3 by = core::Vec3(0.0); // frame of the stock, all axes at 0; mm
};

/// A change of set-up or state during a run.
using WhatIf = std::variant<ToolLengthChange, LengthOffsetOverride, WorkOffsetChange,
                            AllowanceChange, MovedFixture>;

/// A change and the block from which it applies.
struct AppliedChange {
    size_t block = 0;
    WhatIf change;
};

/// A change in words: "T3 is 95 mm long".
std::string text_of(const WhatIf& change);

/// Applies a change to a set-up and to the state from which a run continues. The axes do not move;
/// if an active offset changes, the program coordinates of their position change.
///
/// Errors: no such tool, fixture, offset or axis; a length that gives no valid tool; an active
///         offset while the control reads ahead (G41, G42). Then nothing changes.
core::Result<void> apply(const WhatIf& change, core::Setup& setup, RunState& state);

/// A tool pulled out of its holder or pushed into it so that its gauge length is `length`. A longer
/// shank continues with its upper diameter. Without a holder, only a stated gauge length changes.
///
/// Errors: invalid_value if the flutes would enter the holder, and those of assemble.
core::Result<core::ToolAssembly> stretched(const core::ToolAssembly& tool, double length);

} // namespace app
