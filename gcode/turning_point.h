#pragma once

namespace gcode {

/// A place in the ZX plane of a lathe, mm; X is a radius.
struct TurningPoint {
    double x = 0.0, z = 0.0;

    bool operator==(const TurningPoint&) const = default;
};

} // namespace gcode
