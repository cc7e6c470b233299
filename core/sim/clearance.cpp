#include "core/sim/clearance.h"

namespace core {

const std::string& part_name(const Setup& setup, const Pair& pair) {
    static const std::string names[] = {name_of(PartKind::flutes), name_of(PartKind::shank),
                                        name_of(PartKind::holder)};
    if (pair.part < PartKind::nose) return names[static_cast<size_t>(pair.part)];
    return setup.machine.bodies[pair.carried].name;
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
    constexpr double least = 0.005; // mm: the errors of paths and chords are below
    const double depth = contact_depth(allowance);
    const double widest = bounds(part).max.x;
    double shrink = depth;
    for (const ProfileElement& e : part.elements) {
        const double height = e.z1 - e.z0, out = e.r1 - e.r0;
        if (e.margin > 0.0 || height <= 0.0 || out <= 0.0) continue;
        const double side = std::hypot(height, out);
        if (e.r0 < depth * side / height) shrink = std::min(shrink, depth * out / side);
    }
    return std::min({std::max(shrink, std::min(depth, least)), depth, 0.25 * widest});
}

void merge(PairClearance& known, const PairClearance& later) {
    // What only touched before and collides now is seen at the collision.
    const bool is_worse = later.verdict > known.verdict && later.upper == known.upper;
    known.verdict = std::max(known.verdict, later.verdict);
    known.lower = std::min(known.lower, later.lower);
    known.at_end = later.lower;
    known.drift = 0.0;
    if (later.upper >= known.upper && !(is_worse && later.found())) return;
    known.upper = later.upper;
    known.on_tool = later.on_tool;
    known.on_body = later.on_body;
    known.time = later.time;
}

const PairClearance* deciding_pair(const std::vector<PairClearance>& pairs) {
    const PairClearance* worst = nullptr;
    for (const PairClearance& pair : pairs) {
        if (!pair.found() && pair.verdict == Verdict::clear) continue;
        if (!worst || pair.verdict > worst->verdict
            || (pair.verdict == worst->verdict && pair.margin() < worst->margin()))
            worst = &pair;
    }
    return worst;
}

} // namespace core
