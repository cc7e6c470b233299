#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/result.h"
#include "gcode/cycles/threading.h"

namespace gcode {

/// The centre of an arc and its direction: G3 is counterclockwise from +Z to +X.
struct TurningArc {
    TurningPoint centre;
    bool counterclockwise = false;

    bool operator==(const TurningArc&) const = default;
};

enum class CornerShape : uint8_t { sharp, fillet, chamfer }; // A, C

/// A segment of a programmed contour; it starts where the previous one ended.
struct TurningSegment {
    TurningPoint end;
    std::optional<TurningArc> arc{};         // empty: straight
    CornerShape corner = CornerShape::sharp; // at the start of the next segment
    double corner_size = 0.0;                // radius of the fillet, or leg of the chamfer
};

/// A contour. Its first segment leads from the tool to the first point of the cut.
using TurningContour = std::vector<TurningSegment>;

struct TurningMove {
    TurningPoint end;
    bool rapid = false;
    std::optional<TurningArc> arc{};

    bool operator==(const TurningMove&) const = default;
};

using TurningMoves = std::vector<TurningMove>;

/// How roughing treats the pockets of a contour: the last digit of G71.n and G72.n.
enum class PocketCutting : uint8_t { all, none, rest };

/// The words of G71 and G72, lengths in mm. G7 does not halve any of them.
struct RoughingWords {
    bool facing = false; // G72: cuts along X; G71: along Z
    PocketCutting pockets = PocketCutting::all;
    double allowance = 0.0;              // D: stock left on the contour
    std::optional<double> depth{};       // I, depth of cut; default 1 program unit
    std::optional<double> retract{};     // R; default half a program unit
    double shift_x = 0.0, shift_z = 0.0; // U, W
};

/// The words of G70.
struct FinishingWords {
    double first_distance = 0.0; // D, from the contour, for the first pass
    double last_distance = 0.0;  // E, for the last pass
    double passes = 1.0;         // P; only its whole part is used
};

/// Maximum number of contour segments, and of moves in finishing.
constexpr size_t greatest_contour = 10'000;
constexpr size_t greatest_turning_moves = 1'000'000;

/// The moves of G71 or G72 from `start`, to which the caller has moved the tool with a rapid.
///
/// The contour also starts at `start`; a contour of one segment gives no moves. `mm_per_unit` is
/// 25.4 with G20, because the tolerances of LinuxCNC are in program units.
///
/// Result: the same moves as LinuxCNC 2.9. After the last one the tool is at the end of the contour
///         or above it.
/// Errors: I not positive; a contour that turns back against its main direction (LinuxCNC: not
///         monotonic); an allowance that leaves no room for its lines or corners; and every case in
///         which LinuxCNC would loop forever or run past the end of its lists.
core::Result<TurningMoves> roughing_moves(TurningPoint start, const TurningContour& contour,
                                          const RoughingWords& words, double mm_per_unit = 1.0);

/// The moves of G70: along the contour in passes at distances decreasing from D towards E.
///
/// Result: as `roughing_moves`. The last pass is at distance E.
/// Errors: as `roughing_moves`.
core::Result<TurningMoves> finishing_moves(TurningPoint start, const TurningContour& contour,
                                           const FinishingWords& words, double mm_per_unit = 1.0);

} // namespace gcode
