#pragma once

#include <string>
#include <variant>

#include "core/base/ids.h"
#include "core/base/result.h"
#include "core/base/vec.h"

namespace core {
struct Setup;
struct ToolAssembly;
} // namespace core

namespace core {
struct Setup;
}

namespace app {

struct RunState;

/// The tool is longer or shorter, as if it was pushed into its holder another way: the stick-out
/// changes, and of what is behind the flutes and the neck more or less is seen. Of a tool that has
/// no holder, only its gauge length does. The control is not told.
struct OtherToolLength {
    core::ToolNumber tool{};
    double length = 0.0; // gauge length, mm
};

/// The control's table holds another length, its wear included. It counts at once where it is on.
struct OtherLengthOffset {
    core::OffsetNumber number{};
    double length = 0.0; // mm
};

/// A work offset stands elsewhere. It counts at once where it is active; bodies stay.
struct OtherWorkOffset {
    size_t index = 0;    // 0 is G54
    size_t axis = 0;     // of gcode's letters
    double origin = 0.0; // machine coordinates, mm or degrees
};

/// What replaces the set-up's general allowance; empty: the default ones.
struct OtherAllowance {
    std::optional<double> distance;
};

/// A fixture stands elsewhere.
struct MovedFixture {
    std::string name;
    core::Vec3 by = core::Vec3(0.0); // frame of the stock, all axes at 0; mm
};

/// Something that is changed on the way.
using WhatIf =
    std::variant<OtherToolLength, OtherLengthOffset, OtherWorkOffset, OtherAllowance, MovedFixture>;

/// A change and where it was made.
struct MadeChange {
    size_t block = 0; // the first one that it applies to
    WhatIf change;
};

/// As a person would say it: "T3 is 95 mm long".
std::string text_of(const WhatIf& change);

/// Changes the set-up and the place that a run goes on from. The machine stands where it stood;
/// where an offset that is on changes, the control calls that place by other coordinates.
///
/// Errors: a tool, fixture, offset or axis that there is not; a length that makes no tool; an
///         offset that is on while the control has read ahead (G41, G42). Nothing has changed then.
core::Result<void> apply(const WhatIf& change, core::Setup& setup, RunState& place);

/// A tool as it stands when it is pulled out of its holder, or pushed in, until its gauge length is
/// `length`. The shank is as thick where more of it is seen as it is at its end. Of a tool without
/// a holder of which the gauge length is stated, that alone changes.
///
/// Errors: invalid_value when the flutes would be pushed into the holder, and those of assemble.
core::Result<core::ToolAssembly> stretched(const core::ToolAssembly& tool, double length);

} // namespace app
