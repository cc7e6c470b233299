#pragma once

#include <array>
#include <optional>

#include "core/distance/stock_distance.h"
#include "core/sim/leg/leg_context.h"
#include "core/sim/leg/pair_bounds.h"

namespace core {

/// Distance from a body to one state of the stock over a leg, for the body itself and for the body
/// shrunk by the contact depth.
struct StockObservation {
    Separation plain;
    Separation shrunk;
    double travel = 0.0; // upper bound of the body's travel, mm
    bool whole = true;   // false: only the lower bound was measured
};

/// Measures distances from bodies to a state of the stock, over one leg. Refers to the context and
/// the bounds.
class StockProbe {
public:
    StockProbe(const LegContext& context, const PairBounds& bounds)
        : context_(context), bounds_(bounds) {
        futile_left_.fill(2'000);
    }

    /// From here on, keeps what searches against `stock` recompute; it may be cut meanwhile. Worth
    /// it for a motion that is checked in many pieces.
    void keep_squares(const CutModel& stock);

    /// Measures both bounds, up to a distance of `nearest`.
    StockObservation observe(const MovingBody& body, const Leg& leg, const CutModel& stock,
                             double nearest);

    /// Measures only the lower bound if that shows that the body is clear; else both, like
    /// `observe`.
    StockObservation observe_lower(const MovingBody& body, const Leg& leg, const CutModel& stock,
                                   double nearest);

    /// Distance to the stock on a leg, without the error of the body's shapes. The body is shrunk
    /// by `shrink` first.
    Separation to_stock(const MovingBody& body, const BodyLeg& leg, const CutModel& stock,
                        StockGoal goal, double shrink = 0.0);

    /// Lower bound of the distance between a machine body and a box over a leg.
    double distance_to_box(const MovingBody& body, const RelativeLeg& leg, const Aabb& box);

    /// Clearance of a body from the stock: lower bound before the cut, upper bound after it. Times
    /// are counted from `start`, seconds.
    PairClearance clearance(const MovingBody& body, const Leg& leg, double start,
                            const StockObservation& before, const StockObservation& after) const;

    /// Clearance of a body from the stock that certainly exists, over a leg on which nothing is
    /// cut; only its upper bound and a verdict of violation or collision count.
    PairClearance certain_clearance(const MovingBody& body, const Leg& leg, double start,
                                    const CutModel& certain);

    /// Whether a body keeps its allowance from a stock that is not cut, over a straight leg on
    /// which the path is exact. False if it is not proven, and on a leg on which the body turns.
    bool is_clear(const MovingBody& body, const Leg& leg, const CutModel& stock);

    /// Fraction of the leg, to within 1e-4, at which the pair first comes within `distance`. `near`
    /// has a lower bound for the leg. `seen` is a fraction at which it is that near, by the witness
    /// in `near`, if one is known.
    double earliest(const Leg& leg, const PairClearance& near, double distance,
                    const CutModel& stock, std::optional<double> seen = {});

    /// Sets the time of a pair that is not clear to the first moment at which it is equally near,
    /// so that the time does not depend on where the search began.
    void settle_time(PairClearance& now, const Leg& leg, double start, const CutModel& stock);

private:
    /// Lower bound below which upper bounds use all lines: StockGoal::exact_within.
    double exact_within(const Allowance& allowance) const;
    /// Measures at the body's position half way along the leg, and for a body in parts at other
    /// positions if it overlaps nothing there: this gives a witness that certainly exists.
    void observe_on_way(StockObservation& seen, const MovingBody& body, const Leg& leg,
                        const BodyLeg& relative, const CutModel& stock, double nearest);
    /// Adds the error of the leg. An overlap is kept only if it exists at a position that the body
    /// really takes.
    void add_error(StockObservation& seen, const MovingBody& body, const Leg& leg,
                   const BodyLeg& relative, const CutModel& stock, double nearest);
    /// Whether the flutes move only where they have cut before (runs_in_own_cut).
    bool retraces(const MovingBody& body, const RelativeLeg& leg, const CutModel& stock,
                  const Allowance& allowance) const;

    const LegContext& context_;
    const PairBounds& bounds_;
    // Squares that may still be recomputed in this motion for material near a body of each kind
    // that cannot be proven clear any more.
    std::array<size_t, 5> futile_left_;
    std::optional<KeptSquares> kept_;
};

} // namespace core
