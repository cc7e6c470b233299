#include "core/sim/rounded_corners.h"

namespace core {

RoundedCorners corners_at_start(const Machine& machine) {
    return {.by = machine.corner_tolerance.value_or(0.0)};
}

bool change_mode(RoundedCorners& corners, const PathModeChange& change, const Machine& machine) {
    const bool rounds = change.blending == Blending::continuous;
    const std::optional<double> stated =
        change.tolerance ? change.tolerance : machine.corner_tolerance;
    corners.by = rounds ? std::max(stated.value_or(0.0), change.joining) : 0.0;
    return rounds && !stated;
}

double off_way(const Pair& pair, double of_block, const RoundedCorners& corners) {
    return of_block + (pair.fixture ? 0.0 : corners.of_cuts);
}

bool rises(const Leg& leg) {
    const auto &from = leg.places.front(), &to = leg.places.back();
    for (size_t i = 0; i < axis_count; ++i)
        if (i == 2 ? to[i] < from[i] : to[i] != from[i]) return false;
    return leg.places.size() <= 2;
}

bool follows_cuts(const RoundedCorners& corners, const std::optional<ToolNumber>& tool, bool rises,
                  bool is_rapid) {
    if (corners.by_several || (corners.tool && corners.tool != tool)) return false;
    return rises || (!is_rapid && corners.by == corners.of_cuts);
}

void widen(PairClearance& pair, double of_block, const RoundedCorners& corners, bool follows_cuts) {
    const double off = off_way(pair.pair, of_block, corners);
    if (off == 0.0) return;
    pair.lower = std::max(0.0, pair.lower - off);
    if (pair.verdict == Verdict::collision) return;
    pair.upper += off;
    if (pair.allowance.distance > resolution) {
        pair.verdict = judge_distance(pair.allowance, pair.lower, pair.upper);
    } else if ((pair.pair.fixture || !follows_cuts) && pair.lower == 0.0
               && off > contact_depth(pair.allowance)) {
        pair.verdict = std::max(pair.verdict, Verdict::undecided);
    }
}

} // namespace core
