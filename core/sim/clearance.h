#pragma once

#include <optional>
#include <vector>

#include "core/sim/allowance.h"
#include "core/sim/verdict.h"

namespace core {

/// A part of the tool's side and what it must not touch: the stock, or a fixture by its index.
struct Pair {
    PartKind part = PartKind::flutes;
    std::optional<size_t> fixture = {}; // empty: the stock
    size_t carried = 0;                 // which of the machine's bodies, for nose and machine

    bool operator==(const Pair&) const = default;
};

/// The name of the pair's first body.
const std::string& part_name(const Setup& setup, const Pair& pair);

/// The name of the pair's second body.
const std::string& body_name(const Setup& setup, const Pair& pair);

/// What is known of a pair over a block: lower <= true clearance <= upper.
struct PairClearance {
    Pair pair;
    Allowance allowance;
    double lower = infinity; // at least the search limit when nothing was found nearer
    double upper = infinity;
    Vec3 on_tool = Vec3(0.0), on_body = Vec3(0.0); // witness of `upper`, in the stock's frame
    double time = 0.0; // of the witness, seconds after the block's start
    Verdict verdict = Verdict::clear;
    double at_end = 0.0; // a lower bound of the clearance where the last leg ended
    double drift = 0.0;  // the way that this bound has lost since the pair was measured

    bool found() const { return upper < infinity; }
    double margin() const { return (found() ? upper : lower) - allowance.distance; }
};

/// What the lengths alone say: a pair with an allowance of 0 that may overlap is undecided here.
Verdict judge_distance(const Allowance& allowance, double lower, double upper);

/// What the part shrunk by the contact tolerance says of a pair that may touch or overlaps.
Verdict judge_contact(const Allowance& allowance, double shrunk_lower, double shrunk_upper);

/// By how much a part is shrunk to tell contact from overlap.
double contact_depth(const Allowance& allowance);

/// The same for one part: less where the part is slender, so that nothing of it is more than about
/// the contact tolerance short and a point stays a point. A pointed part that is shrunk all round
/// loses more of its tip than that.
double contact_shrink(const Allowance& allowance, const RevolvedProfile& part);

/// Takes a later observation of the same pair into account.
void merge(PairClearance& known, const PairClearance& later);

/// The pair that decides a block: the worst verdict, among equals the least margin.
const PairClearance* deciding_pair(const std::vector<PairClearance>& pairs);

} // namespace core
