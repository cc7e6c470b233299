#pragma once

#include <optional>

#include "core/distance/stock_distance.h"
#include "core/sim/leg/leg_context.h"
#include "core/sim/leg/pair_bounds.h"

namespace core {

/// How near a body comes to one state of the stock over a leg: as it is, and shrunk by the contact
/// depth.
struct StockObservation {
    Separation plain;
    Separation shrunk;
    double travel = 0.0; // how far the body moves at most
    bool whole = true;   // false: only the lower bound was measured
};

/// Measures bodies against a state of the stock, over one leg. Refers to the context and the
/// bounds.
class StockProbe {
public:
    StockProbe(const LegContext& context, const PairBounds& bounds)
        : context_(context), bounds_(bounds) {}

    /// Both bounds. Nothing beyond `nearest` is looked for.
    StockObservation observe(const MovingBody& body, const Leg& leg, const CutModel& stock,
                             double nearest);

    /// The lower bound only, if it shows that the body is clear; else the same as `observe`.
    StockObservation observe_lower(const MovingBody& body, const Leg& leg, const CutModel& stock,
                                   double nearest);

    /// The distance to the stock on a leg, the leg's error not included. The body is shrunk by
    /// `shrink` first.
    Separation to_stock(const MovingBody& body, const RelativeLeg& leg, const CutModel& stock,
                        StockGoal goal, double shrink = 0.0);

    /// A lower bound of the distance between a machine body and a box over a leg.
    double distance_to_box(const MovingBody& body, const RelativeLeg& leg, const Aabb& box);

    /// A lower bound of the distance from the flutes to the stock over a leg, up to `limit`; 0 if
    /// the leg turns too far.
    double room_of_flutes(const Leg& leg, const CutModel& stock, double limit);

    /// The clearance of a body from the stock before a cut (lower bound) and after it (upper
    /// bound), with times counted from `start`, seconds.
    PairClearance clearance(const MovingBody& body, const Leg& leg, double start,
                            const StockObservation& before, const StockObservation& after) const;

    /// The share of the leg at which the pair first comes as near as `distance`. `seen` is a share
    /// at which it does, if one is known.
    double earliest(const Leg& leg, const Pair& pair, double distance, const CutModel& stock,
                    std::optional<double> seen = {});

    /// Moves the time of a pair that is not clear to the first moment at which it is as near, so
    /// that it does not depend on where the search began.
    void settle_time(PairClearance& now, const Leg& leg, double start, const CutModel& stock);

private:
    /// Adds what is found where the body is half way: a witness that certainly exists.
    void look_half_way(StockObservation& seen, const MovingBody& body, const Leg& leg,
                       const CutModel& stock, double nearest);
    /// Adds the error of the leg. An overlap stays one only at a place that the body really takes.
    void add_error(StockObservation& seen, const MovingBody& body, const Leg& leg,
                   const RelativeLeg& relative, const CutModel& stock, double nearest);
    /// Whether the flutes go only where they have cut before (runs_in_own_cut).
    bool retraces(const MovingBody& body, const RelativeLeg& leg, const CutModel& stock,
                  const Allowance& allowance) const;

    const LegContext& context_;
    const PairBounds& bounds_;
};

} // namespace core
