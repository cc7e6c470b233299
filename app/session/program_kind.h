#pragma once

#include <optional>
#include <string>

#include "gcode/source.h"

namespace app {

/// Why a program is one for a lathe, as it ends "because ...": it never moves Y, and it says a
/// code that only turning has use for. Empty for any other.
std::optional<std::string> turning_reason(const gcode::Program& program);

/// The line in which a Klartext program first asks where the axes stand: what it does then depends
/// on where somebody jogged them.
std::optional<size_t> line_that_asks_for_places(const gcode::Program& program);

} // namespace app
