#pragma once

#include <optional>

#include "gcode/flat_path.h"

namespace gcode {

/// A motion that meets another in a corner: straight, or along an arc of up to one turn.
struct CornerSide {
    FlatPoint start, end;
    std::optional<FlatArc> arc{};

    bool operator==(const CornerSide&) const = default;
};

enum class CornerKind : uint8_t { rounding, chamfer };

enum class CornerFit : uint8_t {
    fits,
    no_length,   // one of the motions goes nowhere
    straight_on, // there is no corner to round
    none,        // nothing of that size touches both motions
    too_large,   // it takes more than one of the motions has
};

/// What stands in the place of a corner.
struct CornerCut {
    CornerFit fit = CornerFit::none;
    FlatPoint from, to;           // where it leaves the first motion and reaches the second
    std::optional<FlatArc> arc{}; // of a rounding
    FlatPoint heading;            // at its end, of length 1
    bool takes_first = false;     // nothing is left of the first motion
    bool takes_second = false;
};

/// The rounding that touches both motions, or the chamfer between two points of them that are
/// `size` away from the corner as the crow flies.
CornerCut cut_corner(const CornerSide& first, const CornerSide& second, CornerKind kind,
                     double size);

/// The direction of a motion at one of its points, of length 1.
FlatPoint heading_at(const CornerSide& side, FlatPoint at);

/// Whether a motion goes anywhere: a straight one to another place, an arc always.
bool has_length(const CornerSide& side);

/// How far a corner bends, from 0 (straight on) to pi (back again).
double bend_between(const CornerSide& first, const CornerSide& second);

} // namespace gcode
