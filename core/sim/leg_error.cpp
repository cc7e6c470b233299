#include "core/sim/leg_check.h"
#include "core/sim/pair_entry.h"

namespace core {

void LegCheck::look_half_way(Observation& seen, const MovingBody& body, const Leg& leg,
                             const CutModel& stock, double nearest) {
    // Where the body really is at one moment is a sure witness.
    const Observation here = observe(body, still_half_way(leg), stock, nearest);
    seen.shrunk.upper = here.shrunk.upper;
    if (here.plain.upper >= seen.plain.upper) return;
    const double lower = seen.plain.lower;
    seen.plain = here.plain;
    seen.plain.lower = std::min(lower, here.plain.upper);
    seen.plain.time_a = 0.5;
}

void LegCheck::make_sure(Observation& seen, const MovingBody& body, const Leg& leg,
                         const RelativeLeg& relative, const CutModel& stock, double nearest) {
    const bool near = seen.plain.lower <= relative.error, overlaps = seen.plain.upper == 0.0;
    const bool overlaps_shrunk = seen.shrunk.upper == 0.0;
    seen.plain = widened(seen.plain, relative);
    seen.shrunk = widened(seen.shrunk, relative);
    const bool has_way = leg.places.size() > 1;
    if ((relative.turns || !body.profile) && near && has_way)
        look_half_way(seen, body, leg, stock, nearest);
    if (!overlaps || !body.profile) return;
    const RevolvedProfile sure = surely_passing(*body.profile, relative);
    if (sure.empty()) return;
    MovingBody inner = body;
    inner.profile = &sure;
    Separation found =
        to_stock(inner, relative, stock, {.limit = resolution, .bound = StockBound::upper});
    if (found.upper > 0.0) return;
    found.lower = 0.0;
    seen.plain = found;
    if (overlaps_shrunk) seen.shrunk.upper = 0.0;
}

} // namespace core
