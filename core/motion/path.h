#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "core/motion/event.h"

namespace core {

struct Machine;

/// A piece of an arc or helix between two fractions of its angle.
struct ArcPiece {
    std::shared_ptr<const Motion> motion; // the whole arc; empty: no arc
    double first = 0.0, last = 1.0;
};

/// A piece of a motion that is checked as a whole.
///
/// `straight`: all axes move at constant rates from the first to the second of two positions.
/// Otherwise the linear axes take an unknown path within the hull of `positions`, and only the
/// `certain` positions are known to be passed; the rotary axes do not move.
struct Leg {
    std::vector<AxisValues> positions;
    double begin = 0.0; // seconds from the motion's start
    double end = 0.0;
    double path_error = 0.0;    // bound on the distance of the tool from its real position, mm
    double turn_error = 0.0;    // bound on the sum of the errors of all rotary axes, radians
    double lasting_error = 0.0; // the part of `path_error` that shorter chords do not reduce, mm
    bool straight = true;
    bool start_known = true; // false: the machine may start anywhere within its limits
    std::vector<AxisValues> certain = {};
    ArcPiece arc = {}; // the arc of which this is a chord
};

/// The piece of a straight leg between two of its fractions, 0..1.
Leg stretch(const Leg& leg, double first, double last);

/// The halves of a straight leg. Those of a chord meet on the arc and are closer to it.
std::array<Leg, 2> halves(const Leg& leg);

/// The middle of a straight leg, as a leg on which nothing moves; for a chord, the point on the
/// arc.
Leg still_half_way(const Leg& leg);

/// The legs of a motion, in order. Empty when an axis may be anywhere.
struct Path {
    std::vector<Leg> legs;
    double duration = 0.0;      // seconds
    bool assumed_speed = false; // a rapid used an axis without a stated speed
};

/// The rapid speed of axes for which none is stated, mm/min.
constexpr double assumed_rapid = 10'000.0;

/// The maximum distance of a chord from its arc, mm.
double chord_error(double mesh_size);

/// Whether a motion is a rapid of which each axis runs at its own speed.
bool is_dogleg(const Motion& motion, const Machine& machine);

/// The legs of a motion.
///
/// Shape:   a straight move is one leg. An arc or helix becomes chords within `max_error` of it
///          that end on it; an arc that would need more than 100,000 has a greater error. A dog-leg
///          rapid is one leg for each change of direction, or, if speeds are unknown, one box of
///          the moving axes. A motion from an unknown position is the hull of the limits. A path of
///          the tip becomes legs on which the axes stay within `max_error` of the control's path.
///          If a rotary axis starts or ends at an unknown angle, the path is empty; also that of a
///          tip while rotary axes turn, if one of these carries a linear axis.
Path path_of(const Motion& motion, const Machine& machine, double max_error);

/// The legs of a motion after a probing move, whose start and end may deviate by these spreads:
/// hulls of all possible positions. Only an end without spread is certain. Empty when rotary axes
/// move, when the control follows the tip, or when an axis may be anywhere.
Path path_of(const Motion& motion, const AxisSpread& from, const AxisSpread& to,
             const Machine& machine, double max_error);

/// The axes that are not known exactly after a motion, from those before it.
AxisSet uncertain_after(const Motion& motion, AxisSet before);

/// The spread at the end of a motion that starts with a spread.
AxisSpread spread_after(const Motion& motion, AxisSpread spread);

/// The least and the greatest value of each axis.
struct AxisRange {
    AxisValues min, max;
};

/// The range of every axis over a motion with known ends, including extremes between them. For a
/// path of the tip it is taken from the legs and may be up to `max_error` too wide.
AxisRange axis_range(const Motion& motion, const Machine& machine, double max_error);

} // namespace core
