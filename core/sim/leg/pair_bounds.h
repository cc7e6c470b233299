#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <vector>

#include "core/geom/gjk.h"
#include "core/motion/kinematics.h"
#include "core/sim/clearance.h"
#include "core/sim/leg/check_memory.h"

namespace core {

struct Setup;

/// A pair while its block is checked: its clearance so far, and a bound for the next leg. Reports
/// get the clearance only.
struct TrackedPair : PairClearance {
    double at_end = 0.0; // lower bound of the clearance where the last leg ended, mm
    double drift = 0.0;  // travel that was subtracted from it since the pair was measured, mm
};

/// The pairs of a block, each once. One of them is found in the same time however many there are.
class TrackedPairs {
public:
    using value_type = TrackedPair;

    TrackedPairs() = default;
    TrackedPairs(std::initializer_list<TrackedPair> pairs);

    /// The entry of a pair; null if it has none.
    TrackedPair* find(const Pair& pair);
    const TrackedPair* find(const Pair& pair) const;

    /// Adds the entry of a pair that has none. References to other entries become invalid.
    TrackedPair& add(const TrackedPair& pair);

    /// Removes the pairs of which `is_unwanted(pair)`.
    template <typename Predicate>
    void remove_if(const Predicate& is_unwanted) {
        std::erase_if(pairs_, is_unwanted);
        make_slots();
    }

    /// Puts the pairs in order: is_before.
    void sort();

    bool empty() const { return pairs_.empty(); }
    size_t size() const { return pairs_.size(); }
    TrackedPair& operator[](size_t i) { return pairs_[i]; }
    const TrackedPair& operator[](size_t i) const { return pairs_[i]; }
    const TrackedPair* data() const { return pairs_.data(); }
    auto begin() { return pairs_.begin(); }
    auto begin() const { return pairs_.begin(); }
    auto end() { return pairs_.end(); }
    auto end() const { return pairs_.end(); }

private:
    void make_slots();
    void take_slot(size_t index);

    std::vector<TrackedPair> pairs_;
    // With many pairs, a hash table of them: 1 + index, or 0. Empty with few.
    std::vector<uint32_t> slots_;
};

/// Merges the clearance on a leg into `known`; its lower bound is also taken as that at the leg's
/// end.
void merge(TrackedPair& known, const PairClearance& later);

/// The entry of a pair, added if it is missing. The reference is valid until the next entry is
/// added.
TrackedPair& entry(TrackedPairs& pairs, const Pair& pair, const Setup& setup);

/// Whether a pair is undecided in this block and shorter legs will not decide it, because an error
/// of the rotary axes stays the same. If so, nothing is known of it at the leg's end.
bool stays_undecided(TrackedPair& known, const Leg& leg);

/// Whether a leg cannot bring a pair nearer than it has been in this block. If so, updates its
/// bound to the leg's end.
bool stays_away(TrackedPair& known, const Leg& leg, const RelativeLeg& relative);

/// Whether bodies that stay at least `apart` from each other over a leg cannot change the pair's
/// clearance. If so, stores `apart` as the pair's bound.
bool is_far(TrackedPair& known, double apart, double search_limit);

/// Clearance on the real path, from that on a leg: its bounds widened by the leg's error.
Separation widened(Separation found, const RelativeLeg& leg);
/// The same for the shapes of a body that may be in parts.
Separation widened(Separation found, const BodyLeg& leg);

/// The part shrunk by the leg's error: the real part certainly sweeps everything that this one
/// sweeps. Deviations do not count: bodies collide that overlap as they are in the set-up. Empty if
/// the body turns on the leg or nothing is left.
RevolvedProfile certain_sweep(const RevolvedProfile& part, const RelativeLeg& leg);

/// Greatest distance that any point of a body moves over a leg relative to any other body, mm;
/// infinite if rotary axes move or the path is unknown.
double greatest_travel(const Machine& machine, const Leg& leg);

/// Decides from bounds of earlier legs which pairs need not be measured on this one.
///
/// Cutting brings nothing nearer, and a leg brings a pair nearer by at most its length.
class PairBounds {
public:
    PairBounds(const Setup& setup, CheckMemory& memory) : setup_(setup), memory_(memory) {}

    /// Starts a leg on which no point moves farther than `travel`, mm. `goes_on`: it starts where
    /// the last one ended, on a known path.
    void begin_leg(double travel, bool goes_on) {
        travel_ = travel;
        goes_on_ = goes_on;
    }
    /// Halves or doubles the leg.
    void scale_leg(double factor) { travel_ *= factor; }
    /// Ends the leg: subtracts its travel from the bounds of earlier blocks. `travel_of(pair)`:
    /// that of a pair, while rotary axes move.
    void end_leg(const std::function<double(const Pair&)>& travel_of = {});
    double travel() const { return travel_; }

    /// How far any point of the body moves over a part of the leg at most, mm. While rotary axes
    /// move, there is only a bound for each body.
    double travel(const RelativeLeg& part) const {
        const bool moves = part.turns || part.positions.size() == 2; // not: rests on the way
        return travel_ == infinity && goes_on_ && moves ? part.travel : travel_;
    }

    /// The same for the whole leg, on which the body moves by `own`.
    double travel(const Leg& leg, double own) const {
        const bool moves = leg.positions.size() == 2;
        return travel_ == infinity && goes_on_ && moves ? own : travel_;
    }

    /// The entry of a pair; a new entry starts with the bound from the last block.
    TrackedPair& tracked_pair(TrackedPairs& pairs, const Pair& pair) const;

    /// Whether the pair stays clear over the leg, on which its bodies approach each other by at
    /// most `travel`, and another pair of the block has less margin. If so, updates its bound to
    /// the leg's end.
    bool can_skip(TrackedPair& known, const TrackedPairs& pairs, double travel) const {
        return can_skip(known, least_margin(pairs), travel);
    }
    /// With the travel of the leg.
    bool can_skip(TrackedPair& known, const TrackedPairs& pairs) const {
        return can_skip(known, pairs, travel_);
    }

    /// Whether a pair with this lower bound is clear and cannot decide the block.
    bool cannot_decide(const Allowance& allowance, double lower, const TrackedPairs& pairs) const {
        return cannot_decide(allowance, lower, least_margin(pairs));
    }

    /// The least margin of the pairs that have been found; infinite if only the verdict counts.
    double least_margin(const TrackedPairs& pairs) const;
    /// The same, if `least` is the least margin of the block's pairs.
    bool can_skip(TrackedPair& known, double least, double travel) const;
    bool cannot_decide(const Allowance& allowance, double lower, double least) const;

    /// Whether the pair can be skipped if this block has about as much margin as the last one.
    bool can_probably_skip(const TrackedPair& known) const;

    /// Updates the bound of a pair that is not checked on this leg to the leg's end.
    void carry_bound(const Pair& pair, TrackedPairs& pairs) const;

    /// Amount that rounded corners subtract from a clearance, mm; 0 for a pair that may touch.
    double off_path(const Allowance& allowance) const {
        return allowance.distance > resolution ? memory_.off_path : 0.0;
    }

private:
    const PairBound* find_bound(const Pair& pair) const;

    const Setup& setup_;
    CheckMemory& memory_;
    mutable size_t last_bound_ = 0; // where the last one was found; saves time only
    double travel_ = infinity;
    bool goes_on_ = false;
};

} // namespace core
