#pragma once

#include <set>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "core/motion/corner.h"
#include "core/sim/clearance.h"

namespace core {

/// A motion of which the control may round the corner where it begins.
struct CornerMove {
    const Setup& setup;
    const ToolAssembly* tool; // null: none, or not described
    const Motion& motion;
    const Path& path;
    bool cuts;       // its flutes cut
    bool may_cut;    // the same, or it is a rapid whose flutes would
    double off_path; // how far its bodies count as off its path anyway, mm
    Aabb stock;      // a box around all stock
};

/// What must keep clear at the corner where a motion begins, besides what its own path asks for.
struct CornerPlan {
    enum class Kind : uint8_t { nothing, region, beside_rest };

    Kind kind = Kind::nothing;
    // Of a region: legs on which the bodies may be. `beside_rest`: the legs that the machine makes
    // while `RoundedCorners::last.rest` of the motion before them is still left.
    std::vector<Leg> anywhere;
    // Of a region: the bodies also stay within `deviation` of these legs, unless there are none.
    std::vector<Leg> along;
    double deviation = 0.0; // mm
    bool may_cut = false;   // the flutes may meet the stock
    double of_cuts = 0.0;   // for `RoundedCorners::of_cuts`, once the corner is checked, mm
    std::set<std::string> assumptions;
};

/// Plans the check of a corner, and notes what is left of it for the motions that follow.
CornerPlan plan_corner(const CornerMove& move, RoundedCorners& corners);

/// How far the flutes may be off their cuts while the rotary axes are off by `turn`, radians.
double off_by_turn(const Setup& setup, const ToolAssembly* tool, const std::vector<Leg>& legs,
                   double turn);

/// A part of what is left of a motion at a corner: of a leg, between two of its fractions.
struct RestPart {
    const Leg* rest = nullptr;
    double from = 0.0, to = 1.0;

    /// How far the axes move in it, in multiples of what makes no difference to a check.
    double size() const;
    /// Both halves, of the same leg.
    std::array<RestPart, 2> halves() const;
    /// Legs that are made while the motion is somewhere in this part of its rest. `corner`: where
    /// that ends.
    std::vector<Leg> beside(const std::vector<Leg>& legs, const AxisValues& corner) const;
};

} // namespace core
