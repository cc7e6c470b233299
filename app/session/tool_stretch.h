#pragma once

#include "core/sim/tool_assembly.h"

namespace app {

/// A tool as it stands when it is pulled out of its holder, or pushed in, until its gauge length is
/// `length`. The shank is as thick where more of it is seen as it is at its end. Of a tool without
/// a holder of which the gauge length is stated, that alone changes.
///
/// Errors: invalid_value when the flutes would be pushed into the holder, and those of assemble.
core::Result<core::ToolAssembly> stretched(const core::ToolAssembly& tool, double length);

} // namespace app
