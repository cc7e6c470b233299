#pragma once

#include <array>
#include <optional>

#include "gcode/language/modal_state.h"

namespace gcode {

/// A point or direction along the first and second axis of the plane.
using PlanePoint = std::array<double, 2>;

/// A drilling cycle as CYCL DEF left it, called by M99, M89 and CYCL CALL. mm, mm/min, s.
struct DefinedCycle {
    int number = 0;                // 0 for none
    double clearance = 0.0;        // Q200: above the surface
    double depth = 0.0;            // Q201: below it, negative
    double feed = 0.0;             // Q206
    double peck = 0.0;             // Q202
    double surface = 0.0;          // Q203
    double second_clearance = 0.0; // Q204
    double dwell_above = 0.0;      // Q210
    double dwell_below = 0.0;      // Q211
    double retract_feed = 0.0;     // Q208
    double decrement = 0.0;        // Q212: each peck is shorter by it
    double breaks = 0.0;           // Q213: chips broken before the tool leaves the hole
    double least_peck = 0.0;       // Q205
    double break_back = 0.0;       // Q256
    double break_every = 0.0;      // Q257
    double stop_above = 0.0;       // Q258: how far above the last depth a rapid ends, at first
    double stop_below = 0.0;       // Q259: and at last
    double start_depth = 0.0;      // Q379
    double disengage = 0.0;        // Q214
    double pitch = 0.0;            // Q239
    double infeed = 0.0;           // Q334: down in one turn of the helix
    double diameter = 0.0;         // Q335

    bool operator==(const DefinedCycle&) const = default;
};

/// A rounding or chamfer that the motion before it has made room for.
struct Corner {
    Position point;         // where the two motions would meet, which increments count from
    Position end;           // of the rounding or chamfer
    PlanePoint centre{};    // of the rounding
    int turn = 0;           // of the rounding; 0 for a chamfer
    PlanePoint direction{}; // at its end
    bool is_done = false;   // the tool has gone along it

    bool operator==(const Corner&) const = default;
};

/// What a program does to its coordinates. The later one began, the nearer it is to the program.
struct Transforms {
    enum class Kind : uint8_t { none, shift, mirror, turn, scale };

    std::array<Kind, 4> order{};
    AxisValues shift{};
    std::array<bool, 3> mirrored{};
    double turn_deg = 0.0;
    double scale = 1.0;

    bool operator==(const Transforms&) const = default;
};

/// What a control with Klartext keeps between two blocks beside the modes.
struct KlartextState {
    std::array<std::optional<double>, 2> pole; // CC; program coordinates
    std::optional<PlanePoint> direction;       // at the end of the last motion in the plane
    std::optional<Corner> corner;
    DefinedCycle cycle;
    bool calls_after_motions = false; // M89
    std::optional<double> call_feed;  // F of TOOL CALL, mm/min
    Transforms transforms;
    bool looks_ahead = false; // for the motion behind a corner; corners are passed over then

    bool operator==(const KlartextState&) const = default;
};

} // namespace gcode
