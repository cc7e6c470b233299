#include "core/sim/clearance.h"

#include <algorithm>
#include <array>

#include "core/base/math.h"
#include "core/motion/corner.h"
#include "core/motion/path.h"
#include "core/sim/setup.h"

namespace core {
namespace {

constexpr double default_contact = 0.05; // for pairs that may touch
constexpr double stock_distance = 1.0;   // from holder and machine bodies to the stock
constexpr double fixture_distance = 2.0;

/// Names of a body in allowance rules: its own name and its kind.
struct Names {
    std::string own, kind;

    bool include(const std::string& name) const { return name == own || name == kind; }
};

/// The allowance of the last rule that names the pair.
std::optional<Allowance> ruled(const Setup& setup, const Names& part, const Names& body) {
    std::optional<Allowance> found;
    for (const AllowanceRule& rule : setup.allowances) {
        const auto names = [&](size_t i, size_t j) {
            return part.include(rule.between[i]) && body.include(rule.between[j]);
        };
        if (names(0, 1) || names(1, 0)) found = Allowance{rule.distance, rule.contact};
    }
    return found;
}

Names names_of_body(const Setup& setup, const Pair& pair) {
    if (!pair.fixture) return {"stock", "stock"};
    const Fixture& fixture = setup.fixtures[*pair.fixture];
    return {fixture.name, fixture.is_machine ? "machine" : "fixture"};
}

} // namespace

Allowance allowance_of(const Setup& setup, const Pair& pair) {
    if (!setup.allowances.empty()) {
        const Names part{part_name(setup, pair), name_of(pair.part)};
        if (const auto rule = ruled(setup, part, names_of_body(setup, pair))) return *rule;
    }
    if (pair.fixture) return {setup.allowance.value_or(fixture_distance), 0.0};
    if (!is_below_holder(pair.part)) return {setup.allowance.value_or(stock_distance), 0.0};
    return {0.0, default_contact};
}

double search_limit_of(const Setup& setup) {
    double largest = setup.allowance.value_or(0.0);
    for (const AllowanceRule& rule : setup.allowances) largest = std::max(largest, rule.distance);
    return std::max(setup.search_limit, largest + 1.0);
}

bool names_a_kind(std::string_view name) {
    constexpr std::array<std::string_view, 7> kinds = {"flutes", "shank",   "holder", "nose",
                                                       "stock",  "fixture", "machine"};
    return std::find(kinds.begin(), kinds.end(), name) != kinds.end();
}

const std::string& part_name(const Setup& setup, const Pair& pair) {
    static const std::string flutes = name_of(PartKind::flutes), shank = name_of(PartKind::shank),
                             holder = name_of(PartKind::holder);
    switch (pair.part) {
    case PartKind::flutes:
        return flutes;
    case PartKind::shank:
        return shank;
    case PartKind::holder:
        return holder;
    default:
        return setup.machine.bodies[pair.carried].name;
    }
}

const std::string& body_name(const Setup& setup, const Pair& pair) {
    static const std::string stock = "stock";
    return pair.fixture ? setup.fixtures[*pair.fixture].name : stock;
}

Verdict judge_distance(const Allowance& allowance, double lower, double upper) {
    if (allowance.distance <= resolution) return lower > 0.0 ? Verdict::clear : Verdict::undecided;
    if (lower >= allowance.distance - resolution) return Verdict::clear;
    if (upper < allowance.distance - resolution) return Verdict::violation;
    return Verdict::undecided;
}

Verdict judge_contact(const Allowance& allowance, double shrunk_lower, double shrunk_upper) {
    if (shrunk_upper == 0.0) return Verdict::collision;
    if (allowance.distance > resolution) return Verdict::violation;
    return shrunk_lower > 0.0 ? Verdict::clear : Verdict::undecided;
}

double contact_depth(const Allowance& allowance) { return std::max(allowance.contact, resolution); }

double contact_shrink(const Allowance& allowance, const RevolvedProfile& part) {
    constexpr double least = 0.005; // mm; more than the errors of paths and chords
    const double depth = contact_depth(allowance);
    const double widest = bounds(part).max.x;
    double shrink = depth;
    for (const ProfileElement& e : part.elements) {
        const double height = e.z1 - e.z0, out = e.r1 - e.r0;
        if (e.margin > 0.0 || height <= 0.0 || out <= 0.0) continue;
        const double side = core::hypot(height, out);
        if (e.r0 < depth * side / height) shrink = std::min(shrink, depth * out / side);
    }
    return std::min({std::max(shrink, std::min(depth, least)), depth, 0.25 * widest});
}

void merge(PairClearance& known, const PairClearance& later) {
    // If the pair only touched before and collides now, report the collision.
    const bool is_worse = later.verdict > known.verdict && later.upper == known.upper;
    known.verdict = std::max(known.verdict, later.verdict);
    known.lower = std::min(known.lower, later.lower);
    known.unless_removed = known.unless_removed || later.unless_removed;
    if (later.upper >= known.upper && !(is_worse && later.found())) return;
    known.upper = later.upper;
    known.on_tool = later.on_tool;
    known.on_body = later.on_body;
    known.time = later.time;
}

CornerStart::CornerStart() = default;
CornerStart::CornerStart(const CornerStart&) = default;
CornerStart::CornerStart(CornerStart&&) noexcept = default;
CornerStart& CornerStart::operator=(const CornerStart&) = default;
CornerStart& CornerStart::operator=(CornerStart&&) noexcept = default;
CornerStart::~CornerStart() = default;

RoundedCorners corners_at_start(const Machine& machine) {
    RoundedCorners corners;
    change_mode(corners, {}, machine);
    return corners;
}

namespace {

/// The limit that a program states, with at least one value; else that of the machine, if any.
/// `blend`: greatest deviation of a blend as a multiple of its tolerance; 0: it is not a blend.
CornerLimit limit_of(std::optional<double> deviation, std::optional<double> distance,
                     const std::optional<double>& of_machine, double blend) {
    if (!deviation && !distance) return {.deviation = of_machine.value_or(0.0)};
    if (blend > 0.0 && deviation) return {.deviation = blend * *deviation, .blended = *deviation};
    // Between straight moves, the curve is in the triangle of the corner and the points at this
    // distance, all of which is within half of the distance of the path.
    CornerLimit limit{std::max(deviation.value_or(0.0), 0.5 * distance.value_or(0.0))};
    if (!deviation) limit.distance = *distance;
    return limit;
}

CornerLimit smaller(const CornerLimit& a, const CornerLimit& b) {
    return {std::min(a.deviation, b.deviation), std::min(a.distance, b.distance),
            std::min(a.blended, b.blended)};
}

} // namespace

void change_mode(RoundedCorners& corners, const PathModeChange& change, const Machine& machine) {
    corners.by = corners.by_arc = 0.0;
    corners.rapids = corners.mixed = corners.arcs = corners.turns = {};
    corners.joining = change.joining;
    corners.left_after = corners.off_after = 0.0;
    corners.unknown = corners.unknown_rapids = false;
    if (change.blending != Blending::continuous) return;
    const auto is_stated = [](const auto& a, const auto& b, const auto& c) { return a || b || c; };
    const double blend = change.blends ? most_blend_deviation(machine) : 0.0;
    const CornerLimit feeds =
        limit_of(change.tolerance, change.distance, machine.corner_tolerance, blend);
    // Next to an arc, a point between two points of the path is within the distance of one of them.
    // Joining may take an arc as two chords, of which each is half as far off, and join those.
    corners.by = std::max(feeds.deviation, change.distance.value_or(0.0)) + change.joining;
    corners.by_arc = corners.by + change.joining;
    corners.rapids = limit_of(change.rapid_tolerance, change.rapid_distance,
                              machine.rapid_corner_tolerance, blend);
    const bool keeps_speed = change.rapids_keep_speed && !machine.rapid_corner_tolerance;
    if (keeps_speed) corners.rapids = {.deviation = infinity, .blended = infinity};
    if (change.blends_at_arcs && feeds.blends()) corners.arcs = feeds;
    // A tolerance would not limit these.
    corners.turns = keeps_speed && !machine.corner_tolerance ? corners.rapids : corners.arcs;
    if (corners.arcs.rounds()) corners.reach_of_speed = 2.0 * most_reach_of_speed(machine);
    if (change.between_kinds) corners.mixed = smaller(feeds, corners.rapids);
    corners.unknown = !is_stated(change.tolerance, change.distance, machine.corner_tolerance);
    corners.unknown_rapids = !corners.rapids.keeps_speed()
                             && !is_stated(change.rapid_tolerance, change.rapid_distance,
                                           machine.rapid_corner_tolerance);
}

double deviation_of(const CornerLimit& limit, const std::vector<Leg>& legs) {
    return limit.keeps_speed() ? length_of(legs) : limit.deviation;
}

void RoundedCorners::end(MotionKind kind, bool is_arc) {
    const bool is_feed = kind != MotionKind::rapid;
    last.kind = kind;
    last.is_arc = is_arc;
    last.joins = joining > 0.0;
    last.legs.clear();
    last.by = !is_feed ? 0.0 : is_arc ? by_arc : by;
    last.rapids = rapids;
    last.mixed = mixed;
    last.arcs = is_feed ? arcs : CornerLimit();
    last.turns = is_feed ? turns : CornerLimit();
}

namespace {

/// Keeps where the lines begin with which those of a motion may be joined, as far as the corner at
/// their end may reach.
void note_joined(RoundedCorners& corners, const Motion& motion, const std::vector<Leg>& legs) {
    CornerStart& last = corners.last;
    const auto are_lines = [](const std::vector<Leg>& all) {
        return !all.empty() && all.size() <= 2
               && std::all_of(all.begin(), all.end(), [](const Leg& leg) {
                      return leg.straight && leg.positions.size() == 2 && !leg.arc.motion;
                  });
    };
    if (corners.joining == 0.0 || motion.kind == MotionKind::rapid || !last.arcs.rounds()
        || last.is_arc || !are_lines(last.legs) || !are_lines(legs) || moves_other_axes(last.legs)
        || moves_other_axes(legs)) {
        last.joined.clear();
        return;
    }
    for (const Leg& leg : last.legs) last.joined.push_back(leg.positions.front());
    constexpr size_t most = 100; // lines that LinuxCNC joins
    const double time = legs.back().end - legs.front().begin;
    const double speed = time > 0.0 ? length_of(legs) / time : 0.0;
    const double enough = corners.reach_of_speed * speed * speed;
    double length = 0.0;
    size_t kept = last.joined.size();
    AxisValues end = legs.front().positions.front();
    for (; kept > 0 && last.joined.size() - kept < most && length < enough; --kept) {
        const AxisValues& start = last.joined[kept - 1];
        length += core::hypot(core::hypot(end[0] - start[0], end[1] - start[1]), end[2] - start[2]);
        end = start;
    }
    last.joined.erase(last.joined.begin(), last.joined.begin() + static_cast<std::ptrdiff_t>(kept));
}

} // namespace

void note_corner(RoundedCorners& corners, const Motion& motion, const Path& path) {
    constexpr size_t most_legs = 4096; // more chords of an arc are longer than any rounding
    if (is_left_out(motion)) return;
    const std::vector<Leg> lines = lines_of_arc(motion, path, corners.arcs_as_lines());
    const std::vector<Leg>& legs = lines.empty() ? path.legs : lines;
    note_joined(corners, motion, legs);
    corners.end(motion.kind, motion.arc.has_value());
    if (!lines.empty()) corners.last.is_arc = false;
    const bool rapid = motion.kind == MotionKind::rapid;
    if (!(rapid ? corners.rapids : corners.turns).rounds() && !corners.mixed.rounds()) return;
    // From an unknown start, the whole region was checked, or is reported as unchecked.
    if (legs.empty() || !legs.front().start_known) return;
    const size_t first = legs.size() > most_legs ? legs.size() - most_legs : 0;
    corners.last.legs = without_rounding(std::span(legs).subspan(first));
}

std::vector<Leg> CornerStart::legs_with_joined() const {
    std::vector<Leg> all;
    if (legs.empty()) return all;
    for (size_t i = 0; i < joined.size(); ++i) {
        const AxisValues& end =
            i + 1 < joined.size() ? joined[i + 1] : legs.front().positions.front();
        all.push_back({.positions = {joined[i], end}});
    }
    all.insert(all.end(), legs.begin(), legs.end());
    return all;
}

void widen_by_stock(PairClearance& pair, double deviation) {
    if (pair.pair.fixture || deviation == 0.0 || pair.verdict == Verdict::collision) return;
    pair.upper += deviation;
    if (pair.verdict == Verdict::violation && pair.allowance.distance > resolution)
        pair.verdict = judge_distance(pair.allowance, pair.lower, pair.upper);
}

double path_deviation(const Pair& pair, double of_block, const RoundedCorners& corners) {
    return of_block + (pair.fixture ? 0.0 : corners.of_stock());
}

bool rises(const Leg& leg) {
    const auto &from = leg.positions.front(), &to = leg.positions.back();
    for (size_t i = 0; i < axis_count; ++i)
        if (i == 2 ? to[i] < from[i] : to[i] != from[i]) return false;
    return leg.straight && leg.positions.size() <= 2;
}

bool follows_cuts(const RoundedCorners& corners, const std::optional<ToolNumber>& tool, bool rises,
                  bool is_rapid) {
    if (corners.by_several || (corners.tool && corners.tool != tool)) return false;
    return corners.has_cut && (rises || (!is_rapid && corners.by == corners.mode_of_cuts));
}

std::optional<size_t> first_own_cut(const RoundedCorners& corners,
                                    const std::optional<ToolNumber>& tool, bool rises,
                                    bool is_rapid) {
    const OwnCuts& own = corners.own;
    if (!corners.has_cut || own.tool != tool || own.by == infinity) return {};
    if (rises) return own.since_tool;
    if (is_rapid || own.by != corners.by) return {};
    return own.since_mode;
}

bool fits_own_cut(const ToolAssembly& tool, PartKind part) {
    const auto radius_of = [&](PartKind kind) {
        double radius = 0.0;
        for (const ToolPart& one : tool.parts)
            if (one.kind == kind) radius = std::max(radius, bounds(one.profile).max.x);
        return radius;
    };
    return is_below_holder(part) && radius_of(part) <= radius_of(PartKind::flutes) + resolution;
}

ContactDoubt widen(PairClearance& pair, const BlockDeviation& of, const RoundedCorners& corners) {
    const double off = path_deviation(pair.pair, of.of_feeds + of.by_axes, corners);
    const double off_above =
        std::max(off, path_deviation(pair.pair, of.of_rapids + of.by_axes, corners));
    if (off_above == 0.0) return ContactDoubt::none;
    pair.lower = std::max(0.0, pair.lower - off);
    if (pair.verdict == Verdict::collision) return ContactDoubt::none;
    pair.upper += off_above;
    if (pair.allowance.distance > resolution) {
        pair.verdict = judge_distance(pair.allowance, pair.lower, pair.upper);
        return ContactDoubt::none;
    }
    const double depth = contact_depth(pair.allowance);
    if (pair.lower > 0.0 || off <= depth) return ContactDoubt::none;
    const bool may_follow = !pair.pair.fixture && of.by_axes + corners.by_axes_of_cuts <= depth;
    return may_follow ? ContactDoubt::unless_in_own_cut : ContactDoubt::unless_at_raw_stock;
}

} // namespace core
