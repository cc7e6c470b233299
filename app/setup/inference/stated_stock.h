#pragma once

#include <optional>
#include <string>

#include "core/base/vec.h"

namespace gcode {
enum class LengthUnit : uint8_t;
struct Program;
} // namespace gcode

namespace app {

/// The raw material that a program states, in the coordinates of its zero, mm.
struct StatedStock {
    core::Aabb box;
    std::string source; // "BLK FORM in line 3", as it ends a sentence
};

/// What Klartext's BLK FORM 0.1 and 0.2, Siemens' WORKPIECE with a box or the header of Vectric's
/// programs say; empty without them, and where they describe no body. The last one counts.
///
/// `reach` is what the program cuts, in its coordinates: it tells where the zero lies that a header
/// with a size alone leaves open, at a corner or in the middle.
std::optional<StatedStock> stated_stock(const gcode::Program& program, gcode::LengthUnit unit,
                                        const std::optional<core::Aabb>& reach = {});

/// Why a program is one for a lathe, as it ends "because ...": it never moves Y, and it says a
/// code that only turning has use for. Empty for any other.
std::optional<std::string> turning_reason(const gcode::Program& program);

/// The line in which a Klartext program first asks where the axes stand: what it does then depends
/// on where somebody jogged them.
std::optional<size_t> line_that_asks_for_places(const gcode::Program& program);

} // namespace app
