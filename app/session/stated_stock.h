#pragma once

#include <optional>
#include <string>

#include "core/base/vec.h"
#include "gcode/dialect.h"
#include "gcode/source.h"

namespace app {

/// The raw material that a program states, in the coordinates of its zero, mm.
struct StatedStock {
    core::Aabb box;
    std::string source; // "BLK FORM in line 3", as it ends a sentence
};

/// What Klartext's BLK FORM 0.1 and 0.2 or Siemens' WORKPIECE with a box say; empty without them,
/// and where they describe no body. The last one that is said counts.
std::optional<StatedStock> stated_stock(const gcode::Program& program, gcode::LengthUnit unit);

} // namespace app
