#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "core/dbm/cut_model.h"
#include "core/distance/stock_distance.h"
#include "core/motion/path.h"
#include "core/sim/block_result.h"
#include "core/sim/clearance.h"
#include "core/sim/leg/check_memory.h"
#include "core/sim/moving_body.h"

namespace core {

/// No point of any body goes farther over a leg, as any other body sees it, mm; infinite where
/// rotary axes move or the way is not known.
double greatest_travel(const Machine& machine, const Leg& leg);

/// Whether what the flutes meet becomes chips or is a crash.
enum class FluteUse : uint8_t { cutting, not_cutting };

/// Checks a tool and what carries it along the legs of a path, against the fixtures and a stock
/// that it cuts.
///
/// Refers to what it was given; make one where it is needed.
class LegCheck {
public:
    LegCheck(const Setup& setup, const ToolAssembly& tool, FluteUse use, BlockIndex block,
             const std::vector<bool>& fixtures_there, CheckMemory& memory, Statistics& statistics)
        : setup_(setup),
          tool_(tool),
          use_(use),
          block_(block),
          fixtures_there_(fixtures_there),
          memory_(memory),
          statistics_(statistics),
          bodies_(moving_bodies(setup, tool)) {}

    /// Checks one leg, cuts the stock along it, and adds what was found to `pairs`, with times
    /// counted from `start`, seconds. While the flutes cut, the other bodies are held against the
    /// stock as it is: `lower` against the stock at the start of a stretch, `upper` against what is
    /// left at its end, and a stretch that leaves a doubt is halved until it is no longer than the
    /// mesh size. A leg on which rotary axes move is halved until what turning adds to the errors
    /// is small, or does not matter.
    ///
    /// Result: the volume removed, mm3.
    double run(const Leg& leg, double start, CutModel& stock, std::vector<PairClearance>& pairs);

    /// Divides the chords that left a doubt about a fixture. To be called behind the last leg.
    void settle(std::vector<PairClearance>& pairs);

    /// A lower bound of how near the flutes come to the stock over a leg, up to `limit`; 0 where
    /// the leg turns too far to say.
    double room_of_flutes(const Leg& leg, const CutModel& stock, double limit);

    /// Cuts the stock along a leg and looks at nothing else; the volume removed, mm3.
    double only_cut(const Leg& leg, CutModel& stock);

    /// Checks everything at rest, at `time` of the block, without cutting.
    void rest(const AxisValues& place, double time, const CutModel& stock,
              std::vector<PairClearance>& pairs);

    /// The least share of the leg after which the pair is as near as `distance` for the first time.
    /// `seen` is a share at which it was, if one is known.
    double earliest(const Leg& leg, const Pair& pair, double distance, const CutModel& stock,
                    std::optional<double> seen = {});

private:
    /// What one state of the stock says of a body: as it is, and shrunk by the contact depth.
    struct Observation {
        Separation plain;
        Separation shrunk;
        double travel = 0.0; // how far the body goes at most
        bool whole = true;   // false: nothing was done for an upper bound
    };

    /// A body that turns is seen sharply enough when the error is this share of its clearance.
    static constexpr double sharp_share = 0.02;

    /// The pair in the block's list; begun from the bound of the block before if it is not there.
    PairClearance& known_pair(std::vector<PairClearance>& pairs, const Pair& pair) const;
    /// Whether a bound shows that a pair stays clear over the leg, and farther from its allowance
    /// than another of the block. Keeps the bound up to date if so.
    bool says_nothing(PairClearance& known, const std::vector<PairClearance>& pairs) const;
    /// Whether a lower bound shows that.
    bool is_beside_the_point(const Allowance& allowance, double lower,
                             const std::vector<PairClearance>& pairs) const;
    /// What must be kept on top, of a pair that must keep apart.
    double off_path(const Allowance& allowance) const {
        return allowance.distance > resolution ? memory_.off_path : 0.0;
    }
    /// Whether a pair will say nothing if the block decides about as the last one did.
    bool says_likely_nothing(const PairClearance& known) const;
    /// The bodies, that of the pair with the stock or a fixture which decided the last block first.
    std::vector<const MovingBody*> likely_first(std::optional<size_t> fixture) const;
    /// A pair that may touch over this leg: only its bound is kept.
    void let_pass(const Pair& pair, std::vector<PairClearance>& pairs) const;

    static Pair pair_of(const MovingBody& body, std::optional<size_t> fixture = {});
    const MovingBody& body_of(const Pair& pair) const;
    RelativeLeg against_stock(const MovingBody& body, const Leg& leg) const;
    double finest_error(const MovingBody& body) const;

    void check_fixtures(const Leg& leg, double start, std::vector<PairClearance>& pairs);
    /// Whether a body and a fixture are a pair that must keep apart over this leg.
    bool may_meet(const Leg& leg, const MovingBody& body, size_t fixture,
                  std::vector<PairClearance>& pairs);
    /// The box of an expendable fixture that stands still against the stock, in the stock's frame.
    std::optional<Aabb> box_beside_stock(size_t fixture) const;
    /// Writes down what the flutes cut of an expendable fixture.
    void note_cut(const Leg& leg, size_t fixture);
    /// Whether the flutes go only where they have cut the fixture before.
    bool is_in_own_cut(const Leg& leg, size_t fixture) const;
    void check_fixture(const Leg& leg, double start, size_t fixture, const MovingBody& body,
                       std::vector<PairClearance>& pairs);
    /// A chord of an arc that leaves a doubt about a fixture, and what was seen of it.
    struct Doubtful {
        Leg leg;
        double start;
        size_t fixture;
        const MovingBody* body;
        PairClearance seen;
    };

    /// The same of a leg on which nothing turns. A chord that leaves a doubt waits for `settle`.
    void check_passage(const Leg& leg, double start, size_t fixture, const MovingBody& body,
                       const RelativeLeg& relative, PairClearance& known);
    /// Whether what was seen of a leg tells enough of a pair of which this is known.
    bool is_sharp(const PairClearance& now, const PairClearance& known) const;
    /// Adds what is known of a chord when it has been halved for as long as it leaves a doubt.
    void divide(const Doubtful& doubt, PairClearance& known);
    /// What is known of a body and a fixture over a leg, from one look at the whole of it.
    PairClearance look_at_fixture(const Leg& leg, double start, const RelativeLeg& relative,
                                  const MovingBody& body, const PairClearance& known);

    Separation to_stock(const MovingBody& body, const RelativeLeg& leg, const CutModel& stock,
                        StockGoal goal, double shrink = 0.0);

    /// The same as `observe`, without an upper bound if the lower one tells enough.
    Observation observe_lower(const MovingBody& body, const Leg& leg, const CutModel& stock,
                              double nearest);

    /// A body of a cutting tool before the stock is cut, and whether it is clear of it already.
    struct BodyCheck {
        const MovingBody& body;
        Observation before;
        bool clear;
        double nearest; // that the pair has been in this block
    };

    double check_stock(const Leg& leg, double start, CutModel& stock,
                       std::vector<PairClearance>& pairs);
    bool turns_too_far(const Leg& leg) const;
    /// Whether a look at a leg could not be sharp enough, whatever it sees within the limit.
    bool is_too_vague(const RelativeLeg& relative) const;
    double check_turning(const Leg& leg, double start, CutModel& stock,
                         std::vector<PairClearance>& pairs);
    /// How far a body of the machine really keeps from a box over a leg, at least.
    double distance_to_box(const MovingBody& body, const RelativeLeg& leg, const Aabb& box);
    /// A body of the machine over a leg that turns, against the stock as it is at the leg's start:
    /// `lower` alone, where the box of the raw stock is far enough.
    void check_turning_body(const MovingBody& body, const Leg& leg, double start,
                            const CutModel& stock, std::vector<PairClearance>& pairs);
    /// Whether one look at a leg that turns tells enough of the tool; adds what it told if so.
    bool is_seen_from_afar(const Leg& leg, double start, const CutModel& stock,
                           std::vector<PairClearance>& pairs);

    /// Looks no farther than `nearest`.
    Observation observe(const MovingBody& body, const Leg& leg, const CutModel& stock,
                        double nearest);
    void look_half_way(Observation& seen, const MovingBody& body, const Leg& leg,
                       const CutModel& stock, double nearest);
    /// Takes the error of a leg into account: an overlap stays one only if it is found where the
    /// body really goes.
    void make_sure(Observation& seen, const MovingBody& body, const Leg& leg,
                   const RelativeLeg& relative, const CutModel& stock, double nearest);
    /// Whether the body goes only where the flutes have cut before (see runs_in_own_cut).
    bool retraces(const MovingBody& body, const RelativeLeg& leg, const CutModel& stock,
                  const Allowance& allowance) const;
    /// Whether a body that is too near the stock before the cut is clear of what is left after it.
    bool depends_on_time(const std::vector<BodyCheck>& checks, const Leg& leg,
                         const CutModel& stock);
    /// Adds what is known of a body after the cut.
    void conclude(const BodyCheck& check, const Leg& leg, double start, const CutModel& stock,
                  bool cut, std::vector<PairClearance>& pairs);
    /// Puts a pair that does not keep its allowance to the first of the moments at which it is as
    /// near, whatever the search saw: what is left of the stock decides, before it is cut further.
    void settle_time(PairClearance& now, const Leg& leg, double start, const CutModel& stock);
    /// Looks at a body that was not looked at before the cut, if it matters after all.
    void look_late(const MovingBody& body, const Leg& leg, double start, const CutModel& stock,
                   std::vector<PairClearance>& pairs);
    Observation look_again(const BodyCheck& check, const Leg& leg, const CutModel& stock);
    PairClearance clearance(const MovingBody& body, const Leg& leg, double start,
                            const Observation& before, const Observation& after) const;
    /// Adds the pairs of all bodies with the stock; whether the flutes gouge it.
    bool check_bodies(const Leg& leg, double start, const CutModel& stock,
                      std::vector<PairClearance>& pairs);
    void check_hull(const Leg& leg, double start, const CutModel& stock,
                    std::vector<PairClearance>& pairs);
    /// All bodies against the stock, by one look at each if time does not matter; the volume cut.
    double check_whole(const Leg& leg, double start, CutModel& stock,
                       std::vector<PairClearance>& pairs);
    double check_cutting(const Leg& leg, double start, CutModel& stock,
                         std::vector<PairClearance>& pairs);
    double check_not_cutting(const Leg& leg, double start, CutModel& stock,
                             std::vector<PairClearance>& pairs);
    double cut_along(const Leg& leg, CutModel& stock);
    std::shared_ptr<const Cutter> cutter_for(const RelativeLeg& leg);

    const Setup& setup_;
    const ToolAssembly& tool_;
    FluteUse use_;
    BlockIndex block_;
    const std::vector<bool>& fixtures_there_;
    CheckMemory& memory_;
    Statistics& statistics_;
    std::vector<MovingBody> bodies_;
    double travel_ = infinity; // no point goes farther over the leg that is being checked, mm
    std::vector<Doubtful> doubtful_;
    bool only_tool_ = false; // bodies of the machine have been held against the stock already
};

} // namespace core
