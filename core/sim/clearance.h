#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/sim/tool_assembly.h"
#include "core/sim/verdict.h"

namespace core {

struct Leg;
struct Machine;
struct PathModeChange;
struct Setup;

/// The largest allowance that may be asked for, mm; more is a typing error.
inline constexpr double largest_allowance = 1000.0;

struct Pair;

/// What a pair must keep: a distance, and how much overlap is contact when the distance is 0.
struct Allowance {
    double distance = 0.0;
    double contact = 0.0;
};

/// What a pair must keep, by the set-up's rules or else by default.
Allowance allowance_of(const Setup& setup, const Pair& pair);

/// How far away bodies are to be looked for: as far as the set-up says, and beyond its largest
/// allowance.
double search_limit_of(const Setup& setup);

/// Whether a name stands for a kind of bodies in allowances: flutes, shank, holder, nose, stock,
/// fixture, machine.
bool names_a_kind(std::string_view name);

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

/// The pair that decides a block: the worst verdict, among equals the least margin. Null if all
/// pairs are clear beyond the search limit.
template <typename Clearance>
const Clearance* deciding_pair(const std::vector<Clearance>& pairs) {
    const Clearance* worst = nullptr;
    for (const Clearance& pair : pairs) {
        if (!pair.found() && pair.verdict == Verdict::clear) continue;
        if (!worst || pair.verdict > worst->verdict
            || (pair.verdict == worst->verdict && pair.margin() < worst->margin()))
            worst = &pair;
    }
    return worst;
}

/// How far the control's rounding of corners may take the tool off its programmed way, mm.
///
/// Where a corner is rounded hangs on the next motion, on speeds and on short moves that the
/// control joins, so all of a feed is taken to be as far off as its corners. Rapids are not
/// rounded.
struct RoundedCorners {
    double by = 0.0;                // of feeds from now on; 0 under G61 and G61.1
    double of_cuts = 0.0;           // of those that have cut: the stock is known no better
    std::optional<ToolNumber> tool; // that has cut so
    bool by_several = false;        // tools

    /// Takes a feed that cuts.
    void note_cut(const std::optional<ToolNumber>& by_tool) {
        if (by == 0.0) return;
        by_several = by_several || (tool && tool != by_tool);
        tool = by_tool;
        of_cuts = std::max(of_cuts, by);
    }
};

/// What is stated before the program says anything.
RoundedCorners corners_at_start(const Machine& machine);

/// Takes a change of the path mode; whether it leaves a tolerance that nobody stated.
bool change_mode(RoundedCorners& corners, const PathModeChange& change, const Machine& machine);

/// How far the bodies of a pair may be off over a block whose feeds are by `of_block`.
double off_way(const Pair& pair, double of_block, const RoundedCorners& corners);

/// Whether a leg is straight and goes nowhere but up, or nowhere.
bool rises(const Leg& leg);

/// Whether a motion goes where its tool has cut, however corners were rounded: it is off as its
/// cuts were, or leaves them upwards, all of its legs (`rises`).
bool follows_cuts(const RoundedCorners& corners, const std::optional<ToolNumber>& tool, bool rises,
                  bool is_rapid);

/// Takes off the lower bound of a pair, and adds to the upper one, how far its bodies may be off.
///
/// Of a pair that may touch, the verdict about the stock stays where `follows_cuts` says that the
/// same tool is off as its cuts were, or leaves them upwards: it is where it has cut. Else it stays
/// if all that may stand of a corner is less than the contact depth.
///
/// `of_block`: by how much feeds of the block may be off; 0 if there was none.
void widen(PairClearance& pair, double of_block, const RoundedCorners& corners, bool follows_cuts);

} // namespace core
