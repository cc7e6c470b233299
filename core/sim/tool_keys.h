#pragma once

#include "core/sim/tool_description.h"

namespace core {

/// Looks at every size by itself: it must be a length or angle that a tool can have, and mean
/// something for the shape.
///
/// Errors: invalid_value, naming the tool and the key.
Result<void> check_keys(const ToolDescription& tool);

} // namespace core
