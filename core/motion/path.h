#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "core/motion/event.h"

namespace core {

struct Machine;

/// A piece of an arc or helix, between two shares of its angle.
struct ArcPiece {
    std::shared_ptr<const Motion> motion; // the whole of it; empty: no arc
    double first = 0.0, last = 1.0;
};

/// A piece of a motion that is checked as a whole.
///
/// `straight`: all axes move evenly from the first of two places to the second. Else the linear
/// ones take some way through the hull of the places, and only `certain` ones are known to be on
/// it; rotary axes stand still then.
struct Leg {
    std::vector<AxisValues> places;
    double begin = 0.0; // seconds after the motion's start
    double end = 0.0;
    double path_error = 0.0; // the true place of every point of the tool is this near, mm
    bool straight = true;
    bool start_known = true; // false: the machine may come from anywhere within its limits
    std::vector<AxisValues> certain = {};
    ArcPiece arc = {}; // whose chord it is
};

/// The part of a straight leg between two shares of it, 0..1.
Leg stretch(const Leg& leg, double first, double last);

/// The halves of a straight leg. Those of a chord meet on the arc, and are nearer to it.
std::array<Leg, 2> halves(const Leg& leg);

/// The place half way along a straight leg, as a leg on which nothing moves; of a chord the one on
/// the arc.
Leg still_half_way(const Leg& leg);

/// A motion as legs, in order. Empty when an axis may stand anywhere.
struct Path {
    std::vector<Leg> legs;
    double duration = 0.0;      // seconds
    bool assumed_speed = false; // a rapid on an axis whose speed is not stated
};

/// What rapids run at on axes whose speed is not stated, mm/min.
constexpr double assumed_rapid = 10'000.0;

/// Chords of an arc stay within this of it, mm.
double chord_error(double mesh_size);

/// The legs of a motion.
///
/// Shape: a straight move is one leg; an arc or helix is chords that stay within `max_error` of it;
///        a dog-leg rapid is a leg for each change of direction, or one box of the axes that move
///        when speeds are unknown; a motion from an unknown place is the hull of the limits. A
///        path of the tip becomes legs on which the axes stay within `max_error` of where the
///        control has them. Rotary axes from or to an unknown angle leave the path empty. The
///        chords of an arc end on it.
Path path_of(const Motion& motion, const Machine& machine, double max_error);

/// The least and greatest value of each axis.
struct AxisRange {
    AxisValues min, max;
};

/// The range of every axis over a motion whose ends are known, its extremes on the way included.
/// A path of the tip is counted by its legs, and up to `max_error` too wide.
AxisRange axis_range(const Motion& motion, const Machine& machine, double max_error);

} // namespace core
