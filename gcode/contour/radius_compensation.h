#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/base/result.h"
#include "gcode/contour/flat_path.h"

namespace gcode {

/// The side of the programmed contour on which the tool stays, seen along the motion.
enum class ContourSide : uint8_t { left, right }; // G41, G42

/// A move of the program as the working plane sees it: from where the last one ended.
struct ContourMove {
    size_t id;                    // the caller's; comes back with the compensated moves
    bool rapid = false;           // G0
    FlatPoint end;                // as programmed
    std::optional<FlatArc> arc{}; // straight when empty
    core::SourceSpan where{};     // for messages
};

/// A move of the tool's centre. A programmed move becomes one, or two at an outside corner.
struct CompensatedMove {
    size_t id = 0; // of the programmed move it is part of
    bool rapid = false;
    /// It leads round the outside corner at which the programmed move starts. All axes outside of
    /// the plane stand still meanwhile; their whole travel belongs to the programmed move's other
    /// part, of which there is always exactly one.
    bool rounds_corner = false;
    /// The inside corner at its start took more than its length, so that it runs backwards and the
    /// tool cuts into the contour. LinuxCNC refuses that only at the next inside corner and at G40.
    bool turned_round = false;
    FlatPoint end;
    std::optional<FlatArc> arc; // straight when empty

    bool operator==(const CompensatedMove&) const = default;
};

using CompensatedMoves = std::vector<CompensatedMove>;

/// Cutter radius compensation between G41 or G42 and G40: plane geometry with a look-ahead of one
/// move, since where a move ends at an inside corner is known only with the move after it.
///
/// A plain value. Moves without motion in the plane (the normal axis, rotary axes) take part too:
/// they wait behind the move that waits, and happen where it will end.
struct RadiusCompensation {
    ContourSide side = ContourSide::left;
    double radius = 0.0;          // mm, positive
    bool extends_corners = false; // Fanuc: straight on at outside corners, else round
    FlatPoint programmed;         // where the program is
    FlatPoint tool;               // where the tool's centre would be if nothing followed
    FlatPoint reached;            // where the moves that are final have brought it
    bool entered = false;         // the entry move was made
    bool entering = false;        // and is the one that waits

    CompensatedMoves waiting{}; // a move in the plane, then those without motion in it
    FlatPoint waiting_way{};    // of the first of them, as programmed
    double waiting_angle = 0.0; // and, for an arc, how far it turns
    core::SourceSpan waiting_where{};
};

/// Compensation that begins at a place of the tool; the next move in the plane is its entry.
///
/// A negative radius is a positive one on the other side, as in LinuxCNC (G41.1 D-4). A radius of
/// zero is no compensation: the caller must not come here with it.
RadiusCompensation begin_compensation(ContourSide side, double radius, FlatPoint at);

/// Takes the next programmed move and returns the moves that are now final, in order.
///
/// Result: behaves as LinuxCNC 2.9. The entry ends beside its programmed end; an outside corner is
/// rounded by an arc (by a straight line if the move after it is a rapid), an inside corner
/// shortens both moves, and a bend of less than 0.05 radians is neither.
/// Errors: the entry is not longer than the radius or a move without motion in the plane, or an arc
/// that cannot be entered by; an arc that the tool does not fit into; a corner that it cannot reach
/// without cutting into the contour. The compensation is then as before.
core::Result<CompensatedMoves> add_move(RadiusCompensation& compensation, const ContourMove& move);

/// The moves still waiting, at their compensated ends. This is G40, M2 and M30.
///
/// What follows G40 starts from `programmed` for the program but from `tool` on the machine.
/// Errors: the last move was so short that its inside corner turned it round.
core::Result<CompensatedMoves> end_compensation(RadiusCompensation& compensation);

} // namespace gcode
