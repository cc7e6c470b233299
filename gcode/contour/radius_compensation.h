#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/base/result.h"
#include "gcode/contour/flat_path.h"

namespace gcode {

/// The side of the programmed contour on which the tool runs, seen in the direction of motion.
enum class ContourSide : uint8_t { left, right }; // G41, G42

/// A programmed move in the working plane. It starts where the previous one ended.
struct ContourMove {
    size_t id;                    // assigned by the caller and returned with the compensated moves
    bool rapid = false;           // G0
    FlatPoint end;                // as programmed
    std::optional<FlatArc> arc{}; // empty: straight
    core::SourceSpan where{};     // for messages
};

/// A move of the tool centre. A programmed move becomes one of these, or two at an outside corner.
struct CompensatedMove {
    size_t id = 0; // of the programmed move it is part of
    bool rapid = false;
    /// This move goes round the outside corner at the start of the programmed move. Axes outside
    /// the plane do not move during it; they move in the other one, of which there is always
    /// exactly one.
    bool rounds_corner = false;
    /// The inside corner at its start took up more than its length, so it runs backwards and the
    /// tool cuts into the contour. LinuxCNC reports this only at the next inside corner and at G40.
    bool turned_round = false;
    /// How the control passes the corner at its start is not known in detail.
    bool is_in_doubt = false;
    FlatPoint end;
    std::optional<FlatArc> arc; // empty: straight

    bool operator==(const CompensatedMove&) const = default;
};

using CompensatedMoves = std::vector<CompensatedMove>;

/// How the tool passes outside corners.
enum class OutsideCorner : uint8_t {
    extended, // along both tangents to their intersection, cut off beyond a right angle: Fanuc
    rounded,  // by an arc about the corner: Siemens' G450
    met,      // to the intersection, or as an arc beyond a limit: G451
};
struct OutsideCorners {
    OutsideCorner kind = OutsideCorner::extended;
    double limit = 0.0; // of `met`: the largest change of direction, radians

    bool operator==(const OutsideCorners&) const = default;
};

/// Cutter radius compensation between G41 or G42 and G40: plane geometry with a look-ahead of one
/// move, because the end of a move at an inside corner depends on the next move.
///
/// A plain value. Moves without motion in the plane (normal axis, rotary axes) are included: they
/// wait with the waiting move and are executed at its end point.
struct RadiusCompensation {
    ContourSide side = ContourSide::left;
    double radius = 0.0;          // mm, positive
    bool extends_corners = false; // Fanuc, Siemens: not as LinuxCNC; the next one holds then
    OutsideCorners outside{};
    bool extends_ends = false;   // Fanuc, type B: also those after the entry and before the exit
    bool enters_upright = false; // Fanuc, type C: a shift at right angles comes before the entry
    FlatPoint programmed;        // position in the program
    FlatPoint tool;              // tool centre if no further move follows
    FlatPoint reached;           // tool centre after the final moves
    bool entered = false;        // the entry move was given
    bool entering = false;       // the entry move is still waiting

    CompensatedMoves waiting{}; // a move in the plane, then those without motion in it
    FlatPoint waiting_way{};    // displacement of the first one, as programmed
    double waiting_angle = 0.0; // angle of the first one, for an arc
    core::SourceSpan waiting_where{};

    bool operator==(const RadiusCompensation&) const = default;
};

/// Starts the compensation at a tool position; the next move in the plane is its entry.
///
/// A negative radius means the other side, as in LinuxCNC (G41.1 D-4). The radius must not be zero.
RadiusCompensation begin_compensation(ContourSide side, double radius, FlatPoint at);

/// Adds the next programmed move and returns the moves that are now final, in order.
///
/// Result: as LinuxCNC 2.9. The entry ends at the offset point of its programmed end. An outside
///         corner is rounded by an arc (by a straight line if the next move is a rapid), an inside
///         corner shortens both moves, and a bend of less than 0.05 radians counts as neither.
/// Errors: an entry that is not longer than the radius, has no motion in the plane, or is an arc
///         that cannot be entered; an arc into which the tool does not fit; a corner that the tool
///         cannot reach without cutting into the contour. Then the compensation is unchanged.
core::Result<CompensatedMoves> add_move(RadiusCompensation& compensation, const ContourMove& move);

/// Returns the waiting moves with their compensated ends, for G40, M2 and M30. With `extends_ends`,
/// an outside corner between them and the exit, the move of the block with G40, is passed as on the
/// contour; its moves have the id of the exit.
///
/// After that, the next move starts at `programmed` in the program but at `tool` on the machine.
/// Errors: the last move is so short that its inside corner reverses it.
core::Result<CompensatedMoves> end_compensation(RadiusCompensation& compensation,
                                                const ContourMove* exit = nullptr);

} // namespace gcode
