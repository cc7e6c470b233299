#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "gcode/exec/interpreter.h"

namespace gcode {

/// A point or direction along the first and second axis of the plane.
using PlanePoint = std::array<double, 2>;

/// A drilling cycle as defined by CYCL DEF, called by M99, M89 and CYCL CALL. mm, mm/min, s. Of
/// cycles from 200 on, the state holds only the number and FAUTO.
struct DefinedCycle {
    int number = 0;                // 0: none
    double clearance = 0.0;        // Q200: above the surface
    double depth = 0.0;            // Q201: below it, negative
    double feed = 0.0;             // Q206
    double peck = 0.0;             // Q202
    double surface = 0.0;          // Q203
    double second_clearance = 0.0; // Q204
    double dwell_above = 0.0;      // Q210
    double dwell_below = 0.0;      // Q211
    double retract_feed = 0.0;     // Q208
    double decrement = 0.0;        // Q212: reduction per peck
    double breaks = 0.0;           // Q213: chip breaks before the tool retracts from the hole
    double least_peck = 0.0;       // Q205
    double break_back = 0.0;       // Q256
    double break_every = 0.0;      // Q257
    double stop_above =
        0.0; // Q258: distance above the last depth at which a rapid ends, first peck
    double stop_below = 0.0;   // Q259: as Q258, for the last peck
    double start_depth = 0.0;  // Q379
    double disengage = 0.0;    // Q214
    double pitch = 0.0;        // Q239
    double infeed = 0.0;       // Q334: infeed per turn of the helix
    double diameter = 0.0;     // Q335
    bool feed_of_call = false; // FAUTO: the feed is that of TOOL CALL

    bool operator==(const DefinedCycle&) const = default;
};

/// A rounding or chamfer for which the previous motion has been shortened.
struct Corner {
    Position point;         // where the two motions would meet; incremental words refer to it
    Position end;           // of the rounding or chamfer
    PlanePoint centre{};    // of the rounding
    int turn = 0;           // of the rounding; 0 for a chamfer
    PlanePoint direction{}; // at its end
    bool is_done = false;   // the tool has moved along it

    bool operator==(const Corner&) const = default;
};

/// The coordinate transformations of a program. The most recent one is applied to the programmed
/// coordinates first.
struct Transforms {
    enum class Kind : uint8_t { none, shift, mirror, turn, scale, tilt };

    std::array<Kind, 5> order{};
    AxisValues shift{};
    std::array<bool, 3> mirrored{};
    double turn_deg = 0.0;
    double scale = 1.0;
    core::Mat3 plane = core::Mat3(1.0); // PLANE, cycle 19: axis directions as columns

    bool operator==(const Transforms&) const = default;
};

/// The state of a Klartext control between two blocks besides the modes.
struct KlartextState {
    std::array<std::optional<double>, 2> pole; // CC; program coordinates
    std::optional<PlanePoint> direction;       // at the end of the last motion in the plane
    std::optional<Corner> corner;
    DefinedCycle cycle;
    std::optional<double> datum;      // the first row of the preset table that is used (cycle 247)
    bool has_moved = false;           // in work coordinates
    bool calls_after_motions = false; // M89
    std::optional<double> call_feed;  // F of TOOL CALL, mm/min
    Transforms transforms;
    bool has_deltas = false;      // DL or DR of TOOL CALL are not 0
    bool turns_short_way = false; // M126
    bool by_space_angles = false; // AXIS SPAT: A, B and C are angles in space
    bool looks_ahead = false; // searching the motion after a corner; corners are ignored meanwhile

    bool operator==(const KlartextState&) const = default;
};

void add(Digest& digest, const KlartextState& state);

inline const KlartextState& klartext_of(const InterpreterState& state) {
    return state.language.as<KlartextState>();
}
inline KlartextState& writable_klartext(InterpreterState& state) {
    return state.language.write<KlartextState>();
}

} // namespace gcode
