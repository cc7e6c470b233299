#pragma once

#include <optional>
#include <vector>

#include "core/dbm/cut_model.h"
#include "core/motion/path.h"
#include "core/sim/leg/flute_cut.h"
#include "core/sim/leg/leg_context.h"
#include "core/sim/leg/pair_bounds.h"
#include "core/sim/leg/stock_probe.h"

namespace core {

/// Checks moving bodies against the fixtures over legs. Refers to the constructor's arguments.
class FixtureCheck {
public:
    FixtureCheck(const LegContext& context, const PairBounds& bounds, FluteCut& flutes)
        : context_(context), bounds_(bounds), flutes_(flutes) {}

    /// Adds the clearances over a leg, with times counted from `start`, seconds. A chord of an arc
    /// whose error leaves a pair undecided is kept for `resolve_doubts`.
    void check(const Leg& leg, double start, TrackedPairs& pairs);

    /// Halves the undecided chords until all are decided or short enough. Call it after the last
    /// leg.
    void resolve_doubts(TrackedPairs& pairs);

private:
    /// A chord of an arc with an undecided pair, and its clearance so far.
    struct Doubt {
        Leg leg;
        double start;
        size_t fixture;
        const MovingBody* body;
        PairClearance seen;
    };

    /// Whether the pair needs its minimum clearance on this leg. Flutes may cut expendable
    /// fixtures.
    bool needs_clearance(const Leg& leg, const MovingBody& body, size_t fixture,
                         TrackedPairs& pairs);
    void check_pair(const Leg& leg, double start, size_t fixture, const MovingBody& body,
                    TrackedPairs& pairs);
    void measure_pair(const Leg& leg, double start, size_t fixture, const MovingBody& body,
                      TrackedPair& known);
    /// measure_pair on a leg on which the body does not turn.
    void check_passage(const Leg& leg, double start, size_t fixture, const MovingBody& body,
                       const RelativeLeg& relative, TrackedPair& known);
    /// The clearance of a body from a fixture, measured once over the whole leg.
    PairClearance measure(const Leg& leg, double start, const RelativeLeg& relative,
                          const MovingBody& body, const PairClearance& known);
    /// Whether a clearance is exact enough, given what is known of the pair.
    bool is_settled(const PairClearance& now, const PairClearance& known) const;
    void resolve(const Doubt& doubt, PairClearance& known);

    const LegContext& context_;
    const PairBounds& bounds_;
    FluteCut& flutes_;
    std::vector<Doubt> doubts_;
    double least_ = infinity; // margin of the pairs of the block that have been found
};

/// Checks moving bodies against the stock over legs, and cuts it. Refers to the constructor's
/// arguments.
class StockCheck {
public:
    StockCheck(const LegContext& context, PairBounds& bounds, StockProbe& probe, FluteCut& flutes)
        : context_(context), bounds_(bounds), probe_(probe), flutes_(flutes) {}

    /// Adds the clearances over a leg, with times counted from `start`, seconds, and cuts the stock
    /// along it.
    ///
    /// Result: the volume removed, mm3.
    double check(const Leg& leg, double start, CutModel& stock, TrackedPairs& pairs);

    /// Adds the clearances of all bodies from the stock without cutting it.
    ///
    /// Result: whether the flutes collide with it.
    bool check_bodies(const Leg& leg, double start, const CutModel& stock, TrackedPairs& pairs);

private:
    /// A body before the stock is cut, and whether its lower bound already shows that it is clear.
    struct BodyCheck {
        const MovingBody& body;
        StockObservation before;
        bool clear;
        bool open;      // the order of events on the leg may change its verdict
        double nearest; // least clearance of the pair so far in this block
    };

    double check_turning(const Leg& leg, double start, CutModel& stock, TrackedPairs& pairs);
    /// Checks a machine body over a leg on which rotary axes move against the stock before the cut.
    /// Only the lower bound is measured if the box of the raw stock is far enough away.
    void check_turning_body(const MovingBody& body, const Leg& leg, double start,
                            const CutModel& stock, TrackedPairs& pairs);
    /// A piece of a leg on which a body is clear of the stock before the cut.
    struct ClearPiece {
        Leg leg;
        StockObservation seen;
    };
    /// Adds the pieces of a leg on which rotary axes move and a body is clear of the stock before
    /// the cut, as long as they are longer than what the cut needs. False if it is not proven
    /// clear.
    bool is_clear_before_cut(const MovingBody& body, const Leg& leg, double start,
                             const CutModel& stock, TrackedPair& known,
                             std::vector<ClearPiece>& pieces);
    /// Checks a tool that cuts over a leg on which rotary axes move, and cuts. Shank and holder
    /// are usually clear of the stock before the cut, and then need far fewer pieces than the cut.
    double cut_turning(const Leg& leg, double start, CutModel& stock, TrackedPairs& pairs);
    /// Whether the tool stays clear on a leg on which rotary axes move, measured over the whole
    /// leg; if so, adds its clearances.
    bool is_clear_by_bound(const Leg& leg, double start, const CutModel& stock,
                           TrackedPairs& pairs);
    double check_whole(const Leg& leg, double start, CutModel& stock, TrackedPairs& pairs);
    double check_cutting(const Leg& leg, double start, CutModel& stock, TrackedPairs& pairs);
    double check_not_cutting(const Leg& leg, double start, CutModel& stock, TrackedPairs& pairs);
    /// How far any point of the body moves over a leg at most, as seen from the stock, mm.
    double travel_of(const MovingBody& body, const Leg& leg) const;
    /// Whether a body that is too near before the cut is clear of the stock after it.
    bool depends_on_time(const std::vector<BodyCheck>& checks, const Leg& leg, const CutModel& cut);
    /// Adds the clearance of a body, now that the stock is cut; `cut`: anything was removed.
    void conclude(const BodyCheck& check, const Leg& leg, double start, const CutModel& stock,
                  bool cut, TrackedPairs& pairs);
    /// Checks a body that was skipped before the cut, if it can decide the block after all.
    void check_late(const MovingBody& body, const Leg& leg, double start, const CutModel& stock,
                    TrackedPairs& pairs);
    StockObservation observe_after(const BodyCheck& check, const Leg& leg, const CutModel& stock);

    const LegContext& context_;
    PairBounds& bounds_;
    StockProbe& probe_;
    FluteCut& flutes_;
    bool only_tool_ = false;   // the machine bodies have been checked already
    bool only_flutes_ = false; // shank and holder are known to be clear
};

/// What is known of the contact of flutes.
struct FluteContact {
    bool may_touch = false; // not proven apart
    bool is_clear = true;   // they touch at most, as is allowed
    bool collides = false;  // certainly beyond that
};

/// Checks a tool and the bodies that move with it along the legs of a path, against fixtures and a
/// stock that it cuts. Refers to the constructor's arguments.
class LegCheck {
public:
    LegCheck(const Setup& setup, const ToolAssembly& tool, FluteUse use, BlockIndex block,
             const std::vector<bool>& mounted_fixtures, CheckMemory& memory, Statistics& statistics,
             CutReplay* replay = nullptr, unsigned threads = 1);
    LegCheck(const LegCheck&) = delete;
    LegCheck& operator=(const LegCheck&) = delete;

    /// Checks one leg, cuts the stock along it, and adds the clearances to `pairs`, with times
    /// counted from `start`, seconds.
    ///
    /// While the flutes cut, the other bodies are checked against the stock at the start of the leg
    /// (`lower`) and at its end (`upper`). A leg that leaves a pair undecided is halved down to the
    /// mesh size; one on which rotary axes move is halved until the error of turning is small or
    /// does not matter.
    ///
    /// Result: the volume removed, mm3.
    double run(const Leg& leg, double start, CutModel& stock, TrackedPairs& pairs);

    /// Decides the pairs that the legs have left undecided. Call it after the last leg.
    void finish(TrackedPairs& pairs) { fixtures_.resolve_doubts(pairs); }

    /// Checks all bodies at rest, `time` seconds after the block's start, without cutting.
    void rest(const AxisValues& position, double time, const CutModel& stock, TrackedPairs& pairs);

    /// Checks a straight leg without cutting, whatever is in the way.
    void pass(const Leg& leg, double start, const CutModel& stock, TrackedPairs& pairs);

    /// How the flutes meet the stock and the fixtures on a straight leg, if they do not cut.
    FluteContact contact_of_flutes(const Leg& leg, const CutModel& stock);

    /// Cuts the stock along a leg without a check; the volume removed, mm3.
    double only_cut(const Leg& leg, CutModel& stock) {
        return leg.straight ? flutes_.along(leg, stock) : 0.0;
    }

    /// FluteCut::may_cut.
    void may_cut(const Leg& leg, CutModel& certain) { flutes_.may_cut(leg, certain); }

    /// StockProbe::certain_clearance.
    PairClearance certain_clearance(const Pair& pair, const Leg& leg, double start,
                                    const CutModel& certain) {
        return probe_.certain_clearance(context_.body_of(pair), leg, start, certain);
    }

    /// Whether all bodies of a kind keep their allowances from a stock that is not cut:
    /// StockProbe::is_clear.
    bool keeps_clear(PartKind kind, const Leg& leg, const CutModel& stock);

    /// How far a body reaches at most into the box of the raw stock on a leg, in the direction in
    /// which that is least, mm; negative: it stays outside.
    double reach_into_raw_stock(const Pair& pair, const Leg& leg, const CutModel& stock) const;

    /// Whether the part of the tool in a pair stays on a leg where its flutes have cut
    /// (follows_flutes), or at least `apart` from the stock.
    bool follows_flutes(const Pair& pair, const Leg& leg, const CutModel& stock,
                        const OwnMoves& own, double apart, int depth = 0) const;

    /// Whether the flutes stay at least `room` away from the stock, as far as bounds show.
    bool flutes_have_room(const Leg& leg, const CutModel& stock, double room) const {
        if (context_.tool.parts.empty() || !leg.straight) return false;
        const MovingBody& flutes = context_.bodies[0];
        const RelativeLeg& way = context_.against_stock(flutes, leg);
        return way.error < room && context_.stays_apart(*flutes.profile, way, stock, room);
    }

    /// StockProbe::earliest.
    double earliest(const Leg& leg, const PairClearance& near, double distance,
                    const CutModel& stock, std::optional<double> seen = {}) {
        return probe_.earliest(leg, near, distance, stock, seen);
    }

private:
    /// How far any point of a pair's body moves over a leg at most, as seen from the other one, mm.
    double travel_of(const Pair& pair, const Leg& leg) const;
    /// Checks a leg of which only a hull of the possible paths is known.
    void check_hull(const Leg& leg, double start, const CutModel& stock, TrackedPairs& pairs);

    LegContext context_;
    PairBounds bounds_;
    FluteCut flutes_;
    StockProbe probe_;
    FixtureCheck fixtures_;
    StockCheck stock_;
};

} // namespace core
