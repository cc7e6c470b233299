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
    size_t id;                    // set by the caller; returned with the compensated moves
    bool rapid = false;           // G0
    FlatPoint end;                // as programmed
    std::optional<FlatArc> arc{}; // empty: straight
    core::SourceSpan where{};     // for messages
};

/// A move of the tool centre. A programmed move becomes one of them, or two at an outside corner.
struct CompensatedMove {
    size_t id = 0; // of the programmed move it is part of
    bool rapid = false;
    /// The part that leads round the outside corner at the start of the programmed move. All axes
    /// outside the plane stand still during it; they move in the other part, of which there is
    /// always exactly one.
    bool rounds_corner = false;
    /// The inside corner at its start took up more than its length, so it runs backwards and the
    /// tool cuts into the contour. LinuxCNC refuses this only at the next inside corner and at G40.
    bool turned_round = false;
    FlatPoint end;
    std::optional<FlatArc> arc; // straight when empty

    bool operator==(const CompensatedMove&) const = default;
};

using CompensatedMoves = std::vector<CompensatedMove>;

/// Cutter radius compensation between G41 or G42 and G40: plane geometry with a look-ahead of one
/// move, because the end of a move at an inside corner depends on the next move.
///
/// A plain value. Moves without motion in the plane (the normal axis, rotary axes) take part too:
/// they wait with the waiting move and are made at its end point.
struct RadiusCompensation {
    ContourSide side = ContourSide::left;
    double radius = 0.0;          // mm, positive
    bool extends_corners = false; // Fanuc: outside corners are extended, otherwise rounded
    FlatPoint programmed;         // position in the program
    FlatPoint tool;               // tool centre if nothing followed
    FlatPoint reached;            // tool centre after the final moves
    bool entered = false;         // the entry move was made
    bool entering = false;        // and is still waiting

    CompensatedMoves waiting{}; // a move in the plane, then those without motion in it
    FlatPoint waiting_way{};    // of the first, as programmed
    double waiting_angle = 0.0; // for an arc, its angle
    core::SourceSpan waiting_where{};
};

/// Starts the compensation at a position of the tool; the next move in the plane is its entry.
///
/// A negative radius is a positive one on the other side, as in LinuxCNC (G41.1 D-4). The radius
/// must not be zero.
RadiusCompensation begin_compensation(ContourSide side, double radius, FlatPoint at);

/// Takes the next programmed move and returns the moves that are now final, in order.
///
/// Result: as LinuxCNC 2.9. The entry ends beside its programmed end. An outside corner is rounded
///         by an arc (by a straight line if the next move is a rapid), an inside corner shortens
///         both moves, and a bend of less than 0.05 radians is neither.
/// Errors: an entry that is not longer than the radius, that has no motion in the plane, or that is
///         an arc which cannot be entered; an arc into which the tool does not fit; a corner that
///         the tool cannot reach without cutting into the contour. The compensation is unchanged
///         then.
core::Result<CompensatedMoves> add_move(RadiusCompensation& compensation, const ContourMove& move);

/// Returns the waiting moves with their compensated ends, for G40, M2 and M30.
///
/// The next move starts at `programmed` in the program but at `tool` on the machine.
/// Errors: the last move is so short that its inside corner reverses it.
core::Result<CompensatedMoves> end_compensation(RadiusCompensation& compensation);

} // namespace gcode
