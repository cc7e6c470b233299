#pragma once

#include <cstdint>
#include <string_view>

#include "gcode/language/block.h"

namespace gcode {

/// The action of a line that is given by a keyword rather than a G code.
enum class CommandKind : uint8_t {
    none,
    straight,         // L
    straight_polar,   // LP
    pole,             // CC
    arc,              // C, around the pole
    arc_polar,        // CP
    arc_of_radius,    // CR
    tangent_arc,      // CT
    tangent_polar,    // CTP
    rounding,         // RND
    chamfer,          // CHF
    tool_call,        // TOOL CALL
    tool_definition,  // TOOL DEF
    cycle_definition, // CYCL DEF
    cycle_call,       // CYCL CALL, CYCL CALL POS
    read_system,      // FN 18
    program_error,    // FN 14
    plane,            // PLANE
    note,             // read, but has no effect here
    modes,            // a line with M words only
};

/// How PLANE defines a plane.
enum class PlaneForm : uint8_t { reset, spatial, euler, vector, points, relative, axial };

/// What PLANE does with the rotary axes: leaves them to the program; turns them while the tip stays
/// on the work; turns them alone.
enum class PlaneMove : uint8_t { stay, move, turn };

/// A statement that begins with a keyword. Its values are stored as words of the block: a radius as
/// R, polar coordinates as P and H, others depending on the kind.
struct KlartextLine {
    CommandKind kind = CommandKind::none;
    core::SourceSpan span{};
    std::string_view tool_name{}; // TOOL CALL "NAME"
    int number = 0, part = 0;     // CYCL DEF 7.1: 7 and 1
    int turn = 0;                 // DR+: 1, DR-: -1
    PlaneForm plane{};
    PlaneMove plane_move{};
    int solution = 0;              // SEQ+: 1, SEQ-: -1
    bool turns_table = false;      // TABLE ROT
    bool retracts = false;         // MB
    bool rapid = false;            // FMAX
    bool calls_cycle = false;      // M99, or CYCL CALL
    bool feed_of_call = false;     // Q206=FAUTO: the feed of TOOL CALL
    bool calls_at_point = false;   // CYCL CALL POS
    bool calls_from_here = false;  // M89: after every motion
    bool turns_otherwise = false;  // FUNCTION TCPM: with words that are not modelled
    bool turns_in_plane = false;   // PATHCTRL VECTOR
    bool by_space_angles = false;  // AXIS SPAT: A, B and C are angles in space
    bool has_normal = false;       // LN
    bool has_corner_delta = false; // DR2 of TOOL CALL is not 0
};

inline const KlartextLine& klartext_of(const Block& block) {
    return block.language_line.as<KlartextLine>();
}

} // namespace gcode
