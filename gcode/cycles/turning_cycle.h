#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/result.h"
#include "gcode/cycles/threading.h"

namespace gcode {

/// The centre of an arc and its sense: G3, counter-clockwise from +Z to +X.
struct TurningArc {
    TurningPoint centre;
    bool counterclockwise = false;

    bool operator==(const TurningArc&) const = default;
};

enum class CornerShape : uint8_t { sharp, fillet, chamfer }; // A, C

/// A part of a programmed contour, from where the last one ended.
struct TurningSegment {
    TurningPoint end;
    std::optional<TurningArc> arc{};         // straight when empty
    CornerShape corner = CornerShape::sharp; // where the next segment begins
    double corner_size = 0.0;                // the fillet's radius, or from each side of a chamfer
};

/// A contour: its first segment is the way from the tool to the first point that is cut.
using TurningContour = std::vector<TurningSegment>;

struct TurningMove {
    TurningPoint end;
    bool rapid = false;
    std::optional<TurningArc> arc{};

    bool operator==(const TurningMove&) const = default;
};

using TurningMoves = std::vector<TurningMove>;

/// What roughing does with the pockets of a contour: the last digit of G71.n and G72.n.
enum class PocketCutting : uint8_t { all, none, rest };

/// The words of G71 and G72, lengths in mm. None of them is halved under G7.
struct RoughingWords {
    bool facing = false; // G72: cuts along X; G71: along Z
    PocketCutting pockets = PocketCutting::all;
    double allowance = 0.0;              // D: left on the contour
    std::optional<double> depth{};       // I of a cut; 1 program unit when not given
    std::optional<double> retract{};     // R; half a program unit when not given
    double shift_x = 0.0, shift_z = 0.0; // U, W
};

/// The words of G70.
struct FinishingWords {
    double first_distance = 0.0; // D from the contour, of the first pass
    double last_distance = 0.0;  // E
    double passes = 1.0;         // P: its whole part counts
};

/// Contours with more segments, and finishing with more moves, are refused.
constexpr size_t greatest_contour = 10'000;
constexpr size_t greatest_turning_moves = 1'000'000;

/// The moves of G71 or G72 from `start`, to which the caller has moved the tool by a rapid.
///
/// The contour begins at `start` too; one of a single segment gives no moves. `mm_per_unit` is 25.4
/// under G20: LinuxCNC's tolerances are in program units.
///
/// Result: as LinuxCNC 2.9, to the move. After the last of them the tool is at the end of the
/// contour or above it.
/// Errors: I not positive; a contour that, on the way in which it runs, comes back (LinuxCNC: not
/// monotonic); an allowance that its lines or corners do not have room for; and wherever LinuxCNC
/// would go on for ever or past the end of its lists.
core::Result<TurningMoves> roughing_moves(TurningPoint start, const TurningContour& contour,
                                          const RoughingWords& words, double mm_per_unit = 1.0);

/// The moves of G70: along the contour in passes whose distance from it falls from D towards E.
///
/// Result: as `roughing_moves`. The last pass has the distance E.
/// Errors: as there.
core::Result<TurningMoves> finishing_moves(TurningPoint start, const TurningContour& contour,
                                           const FinishingWords& words, double mm_per_unit = 1.0);

/// The arc of a block with R instead of its centre: the shorter way, whatever R's sign.
///
/// Errors: R is less than half of the way.
core::Result<TurningArc> turning_arc_from_radius(TurningPoint start, TurningPoint end,
                                                 double radius, bool counterclockwise);

} // namespace gcode
