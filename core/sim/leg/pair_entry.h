#pragma once

#include "core/geom/gjk.h"
#include "core/motion/kinematics.h"
#include "core/sim/clearance.h"

namespace core {

struct Setup;

/// What is known of a pair, begun here if nothing was. The reference lasts until the next one is
/// begun.
PairClearance& entry(std::vector<PairClearance>& pairs, const Pair& pair, const Setup& setup);

/// Whether a leg cannot bring a pair nearer than it has been in this block. Keeps the bound at the
/// leg's end up to date if so.
bool stays_away(PairClearance& known, const Leg& leg, const RelativeLeg& relative);

/// Whether bodies that stay this far apart over a leg cannot say more than is known of the pair, or
/// than the search limit. Notes the bound if so.
bool is_far(PairClearance& known, double apart, double search_limit);

/// What a look at a leg says of the real way, given the leg's error. The body has not quite been
/// where the look put it, so an overlap is only as sure as the error.
Separation widened(Separation found, const RelativeLeg& leg);

/// What is left of a part when the leg's error is taken off everywhere: wherever it goes, the part
/// itself really goes. Empty where the leg turns, or when nothing is left.
RevolvedProfile surely_passing(const RevolvedProfile& part, const RelativeLeg& leg);

} // namespace core
