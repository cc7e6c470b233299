#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/sim/tool_assembly.h"
#include "core/sim/verdict.h"

namespace core {

enum class MotionKind : uint8_t;

struct Leg;
struct Machine;
struct Motion;
struct Path;
struct PathModeChange;
struct Setup;

/// The largest allowance that is accepted, mm; more is taken for a typing error.
inline constexpr double largest_allowance = 1000.0;

struct Pair;

/// Minimum clearance of a pair, mm, and the contact tolerance, which applies if that is 0.
struct Allowance {
    double distance = 0.0;
    double contact = 0.0;
};

/// The allowance of a pair: from the set-up's rules, else the default.
Allowance allowance_of(const Setup& setup, const Pair& pair);

/// Search limit, mm: that of the set-up, but more than its largest allowance.
double search_limit_of(const Setup& setup);

/// Whether a name in an allowance rule is a kind of body: flutes, shank, holder, nose, stock,
/// fixture, machine.
bool names_a_kind(std::string_view name);

/// Two bodies whose clearance is measured: one on the spindle side, and the stock or a fixture (by
/// its index).
struct Pair {
    PartKind part = PartKind::flutes;
    std::optional<size_t> fixture = {}; // empty: the stock
    size_t carried = 0;                 // index of the machine body, for nose and machine

    bool operator==(const Pair&) const = default;
};

/// Name of the pair's first body.
const std::string& part_name(const Setup& setup, const Pair& pair);

/// Name of the pair's second body.
const std::string& body_name(const Setup& setup, const Pair& pair);

/// Bounds of a pair's clearance during a block: lower <= true clearance <= upper.
struct PairClearance {
    Pair pair;
    Allowance allowance;
    double lower = infinity; // at least the search limit if nothing was found within it
    double upper = infinity;
    Vec3 on_tool = Vec3(0.0), on_body = Vec3(0.0); // witness of `upper`, in the stock's frame
    double time = 0.0;                             // of the witness, seconds from the block's start
    Verdict verdict = Verdict::clear;
    bool unless_removed = false; // too near unless an earlier, undecided motion removed the stock

    bool found() const { return upper < infinity; }
    double margin() const { return (found() ? upper : lower) - allowance.distance; }
};

/// Verdict from the bounds alone. A pair with an allowance of 0 that may overlap is undecided.
Verdict judge_distance(const Allowance& allowance, double lower, double upper);

/// Verdict for a pair that may touch or overlaps, from the bounds of the body shrunk by the contact
/// tolerance.
Verdict judge_contact(const Allowance& allowance, double shrunk_lower, double shrunk_upper);

/// Amount by which a body is shrunk to distinguish contact from overlap, mm.
double contact_depth(const Allowance& allowance);

/// Amount by which this part is shrunk, mm. Smaller for slender and pointed parts: shrinking a
/// point all round shortens its tip by more than the amount, and the tip must not lose more than
/// about the contact tolerance.
double contact_shrink(const Allowance& allowance, const RevolvedProfile& part);

/// Merges a later observation of the same pair into `known`.
void merge(PairClearance& known, const PairClearance& later);

/// The pair that decides a block: the one with the worst verdict, or of those the one with the
/// least margin. Null if all pairs are clear beyond the search limit.
template <typename Clearances>
const typename Clearances::value_type* deciding_pair(const Clearances& pairs) {
    const typename Clearances::value_type* worst = nullptr;
    for (const typename Clearances::value_type& pair : pairs) {
        if (!pair.found() && pair.verdict == Verdict::clear) continue;
        if (!worst || pair.verdict > worst->verdict
            || (pair.verdict == worst->verdict && pair.margin() < worst->margin()))
            worst = &pair;
    }
    return worst;
}

/// How far a control may round the corner between two motions.
struct CornerLimit {
    double deviation = 0.0;     // greatest distance from the programmed path, mm; 0: not rounded
    double distance = infinity; // at most this far before and after the corner, mm along the path
    double blended = 0.0; // the tolerance of a blend (`blend_at`), mm; 0: it is rounded otherwise

    bool rounds() const { return deviation > 0.0; }
    bool blends() const { return blended > 0.0; }

    /// Whether a corner is rounded as far as speeds and accelerations make it.
    bool keeps_speed() const { return deviation == infinity; }
};

/// How far a rapid with these legs may be off its path at a corner, mm.
double deviation_of(const CornerLimit& limit, const std::vector<Leg>& legs);

/// A motion that ends at a corner.
struct CornerStart {
    CornerStart();
    CornerStart(const CornerStart&);
    CornerStart(CornerStart&&) noexcept;
    CornerStart& operator=(const CornerStart&);
    CornerStart& operator=(CornerStart&&) noexcept;
    ~CornerStart();

    std::optional<MotionKind> kind; // empty: the machine comes from rest
    bool is_arc = false;            // and not taken for lines
    bool joins = false;             // it may be joined with straight feeds
    std::vector<Leg> legs;          // its last legs, if the corner after it may be rounded
    std::vector<AxisValues> joined; // starts of the lines before it that may be joined with it
    std::vector<Leg> rest;          // of a motion that may not have ended yet
    double by = 0.0;                // of a feed: how far it deviates
    CornerLimit rapids, mixed, arcs, turns; // as in `RoundedCorners`, when it was programmed

    /// `legs` after the lines that may be joined with them.
    std::vector<Leg> legs_with_joined() const;
};

/// Which moves in the log of the stock are those of the tool that has cut last.
struct OwnCuts {
    std::optional<ToolNumber> tool;
    double by = 0.0;       // how far its feeds deviated at most, mm; infinite after a wider corner
    size_t since_tool = 0; // number of its first move
    size_t since_mode = 0; // of its first one since feeds deviate as far as that
};

/// How far the tool may deviate from its programmed path because the control rounds corners, mm.
///
/// Where feeds are rounded depends on the next motion, on speeds and on short moves that the
/// control joins, so a whole feed is assumed to deviate as far as its corners. Rapids are not
/// joined: they deviate only at the corner between two of them, which belongs to the second.
struct RoundedCorners {
    double by = 0.0;           // of feeds in the current mode; 0 under exact stops
    double by_arc = 0.0;       // of feeds on arcs
    double of_cuts = 0.0;      // largest of all feeds that cut: the stock's own uncertainty
    double mode_of_cuts = 0.0; // largest `by` of all modes in which feeds cut
    bool unknown = false;      // the control may round feeds by an unknown amount
    CornerLimit rapids;        // between rapids; see `keeps_speed`
    CornerLimit turns;         // between feeds of which one hardly moves X, Y and Z, but other axes
    bool unknown_rapids = false; // the control may round rapids by an unknown amount
    CornerLimit mixed;           // between a rapid and a feed
    // Between feeds of which one is an arc, or moves other axes than X, Y and Z: if it is farther
    // off than `by` of both.
    CornerLimit arcs;
    double joining = 0.0;        // lines this close to another one may be joined into it, mm
    double reach_of_speed = 0.0; // s2/mm: times the square of a speed, twice where it is rounded
    // The rest of a rounded corner, in feeds that may be joined to the one after it: its length and
    // its deviation, mm; see also `last.rest`.
    double left_after = 0.0, off_after = 0.0;
    CornerStart last;
    std::optional<ToolNumber> tool; // that has cut with rounded corners
    bool by_several = false;        // more than one tool has
    double by_axes_of_cuts = 0.0;   // likewise of them by the tolerances of axes of rotation
    bool has_cut = false;           // a feed has met the stock
    OwnCuts own;                    // of the tool that has cut last

    /// Arcs this close to two lines may be run as lines, mm.
    double arcs_as_lines() const { return arcs.blends() ? joining : 0.0; }

    /// Deviation of a feed, with that of the corner where it begins.
    double of_feed(bool is_arc) const { return std::max(is_arc ? by_arc : by, last.by); }

    /// How far the surface of the cut stock may be from where it is measured.
    double of_stock() const { return of_cuts + by_axes_of_cuts; }

    /// Records the end of a motion, without its legs.
    void end(MotionKind kind, bool is_arc);

    /// Records a cutting feed, before which the stock's log has `logged` moves.
    void note_cut(const std::optional<ToolNumber>& by_tool, bool is_arc, size_t logged) {
        const double most = std::max(by, last.by);
        if (own.tool != by_tool || own.by == infinity) own.since_tool = logged;
        if (own.tool != by_tool || own.by != most) own.since_mode = logged;
        own.tool = by_tool;
        own.by = most;
        if (of_feed(is_arc) == 0.0) return;
        by_several = by_several || (tool && tool != by_tool);
        tool = by_tool;
        mode_of_cuts = std::max(mode_of_cuts, by);
        of_cuts = std::max(of_cuts, of_feed(is_arc));
    }

    /// Records how far a corner between cutting feeds may have been rounded.
    void note_corner_of_cuts(double off) {
        of_cuts = std::max(of_cuts, off);
        if (off > std::max(by, by_arc)) own.by = infinity;
    }
};

/// In feeds that LinuxCNC blends, rotary axes that move count as this far off, radians: as much as
/// at smooth corners.
constexpr double smooth_turn = 1.7453292519943296e-4; // 0.01 degrees

/// How far the bodies may be from where they are measured in a block, mm.
struct BlockDeviation {
    double of_feeds = 0.0, of_rapids = 0.0; // because the control rounds corners
    double by_axes = 0.0;                   // because axes of rotation are known with tolerances
};

/// State before the first block, from the machine's corner tolerance.
RoundedCorners corners_at_start(const Machine& machine);

/// Applies a change of the path mode.
void change_mode(RoundedCorners& corners, const PathModeChange& change, const Machine& machine);

/// Records a motion, at whose end the next corner begins. A motion without length changes nothing.
void note_corner(RoundedCorners& corners, const Motion& motion, const Path& path);

/// Possible deviation between the bodies of a pair, mm, in a block whose feeds deviate by up to
/// `of_block`.
double path_deviation(const Pair& pair, double of_block, const RoundedCorners& corners);

/// Whether a leg is straight and moves only upwards, or not at all.
bool rises(const Leg& leg);

/// Whether flutes stay within what they have cut, however corners were rounded: the tool has cut,
/// and deviates as its cuts did, or all legs of the motion go upwards out of them (`rises`).
bool follows_cuts(const RoundedCorners& corners, const std::optional<ToolNumber>& tool, bool rises,
                  bool is_rapid);

/// The number of the first move in the stock's log that makes room for other parts of the tool on a
/// motion, see stays_in_own_cut: it deviates as that and all later ones did, or goes upwards out of
/// what this tool has cut. Empty if no move does.
std::optional<size_t> first_own_cut(const RoundedCorners& corners,
                                    const std::optional<ToolNumber>& tool, bool rises,
                                    bool is_rapid);

/// Whether a part of a tool may have been given its room by the flutes, on the same path: it is no
/// wider than they are. Other parts follow no cut.
bool fits_own_cut(const ToolAssembly& tool, PartKind part);

/// Whether a pair that may touch is in doubt because its bodies deviate.
enum class ContactDoubt : uint8_t {
    none,
    unless_in_own_cut,  // unless the body moves where its tool has cut, and deviates as that did
    unless_at_raw_stock // unless it at most touches the raw stock, even if it deviates
};

/// Widens the bounds of a pair by the possible deviation between its bodies.
///
/// Result:  whether the contact of a pair that may touch is in doubt: material may be left at a
///          corner that is pressed in by more than the contact depth. The verdict does not include
///          this. Tolerances of axes displace the tool and its cuts differently, and not the raw
///          stock: what they may press in is in doubt in the cut of the tool, too.
///
/// `of`: deviations of the block's motions. That of rapids only widens the upper bound: `lower`
/// includes their corners.
ContactDoubt widen(PairClearance& pair, const BlockDeviation& of, const RoundedCorners& corners);

/// Widens the upper bound of a pair by the deviation of the stock's mesh; its tolerance is in the
/// lower one already.
void widen_by_stock(PairClearance& pair, double deviation);

} // namespace core
