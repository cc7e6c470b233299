#include <algorithm>

#include <fmt/format.h>

#include "core/sim/leg/leg_check.h"
#include "core/sim/rules/rules.h"
#include "core/sim/setup.h"
#include "core/sim/verdict.h"

namespace core {
namespace {

constexpr double room = 0.5;              // mm that a rapid should pass over the stock by
constexpr double highest_retract = 500.0; // mm that a retract could be higher by
constexpr double retract_step = 0.01;

Setup with_every_pair(Setup setup) {
    setup.detail = Detail::every_pair;
    return setup;
}

/// Looks at every pair, whatever the report wants.
struct Look {
    const LegAsRun& link;
    Setup setup = with_every_pair(link.setup);
    CheckMemory memory = {};
    Statistics statistics = {};

    LegCheck check() {
        return {setup,  link.tool, FluteUse::not_cutting, link.block, link.fixtures_there,
                memory, statistics};
    }

    std::vector<TrackedPair> at(const AxisValues& place) {
        std::vector<TrackedPair> pairs;
        check().rest(place, 0.0, link.stock, pairs);
        return pairs;
    }

    std::vector<TrackedPair> along(double higher) {
        Leg leg = link.leg;
        for (AxisValues& place : leg.places) place[2] += higher;
        CutModel stock = link.stock;
        std::vector<TrackedPair> pairs;
        check().run(leg, 0.0, stock, pairs);
        return pairs;
    }
};

bool is_flutes_over_stock(const PairClearance& pair) {
    return !pair.pair.fixture && pair.pair.part == PartKind::flutes;
}

bool are_clear(const std::vector<TrackedPair>& pairs) {
    return std::all_of(pairs.begin(), pairs.end(),
                       [](const TrackedPair& pair) { return pair.verdict == Verdict::clear; });
}

/// How near the flutes are to the stock.
double flutes_to_stock(const std::vector<TrackedPair>& pairs) {
    for (const TrackedPair& pair : pairs)
        if (is_flutes_over_stock(pair)) return pair.found() ? pair.upper : pair.lower;
    return infinity;
}

/// Whether the flutes pass over the face of the stock from above, no wall beside them.
bool passes_over(const LegAsRun& link, const PairClearance& pair) {
    const Vec3 up = pair.on_tool - pair.on_body;
    return up.z > 0.7 * glm::length(up) && pair.on_body.z >= link.stock.outer_box.max.z - room;
}

/// What the rapid comes too near to, of the pairs on the way.
const PairClearance* in_the_way(const LegAsRun& link, const std::vector<TrackedPair>& pairs) {
    const PairClearance* worst = deciding_pair(pairs);
    if (worst && worst->verdict != Verdict::clear) return worst;
    for (const TrackedPair& pair : pairs)
        if (is_flutes_over_stock(pair) && pair.found() && pair.upper > 0.0 && pair.upper < room
            && passes_over(link, pair))
            return &pair;
    return nullptr;
}

/// Whether anything on the way is too near, or the flutes pass the stock with little room.
bool is_doubtful(const LegAsRun& link, const std::vector<TrackedPair>& known) {
    if (!are_clear(known)) return true;
    CheckMemory memory;
    Statistics statistics;
    return LegCheck(link.setup, link.tool, FluteUse::not_cutting, link.block, link.fixtures_there,
                    memory, statistics)
               .room_of_flutes(link.leg, link.stock, room)
           < room;
}

/// How much higher, to within `step`, the leg would pass everything; empty if it never does.
std::optional<double> lift(Look& look) {
    const auto passes = [&](double higher) {
        const auto pairs = look.along(higher);
        return are_clear(pairs) && flutes_to_stock(pairs) >= room;
    };
    double low = 0.0, high = 1.0;
    while (high < highest_retract && !passes(high)) {
        low = high;
        high *= 2.0;
    }
    if (high >= highest_retract) return std::nullopt;
    while (high - low > retract_step) {
        const double middle = 0.5 * (low + high);
        (passes(middle) ? high : low) = middle;
    }
    return high;
}

} // namespace

bool goes_across(const Leg& leg) {
    if (!leg.straight || !leg.start_known || leg.places.size() < 2) return false;
    const AxisValues &from = leg.places.front(), &to = leg.places.back();
    for (size_t i = 3; i < axis_count; ++i)
        if (from[i] != to[i]) return false;
    return std::hypot(to[0] - from[0], to[1] - from[1]) > 1.0;
}

std::optional<Finding> low_retract(const LegAsRun& link, const std::vector<TrackedPair>& known) {
    if (!is_doubtful(link, known)) return std::nullopt;
    Look look{link};
    const std::vector<TrackedPair> pairs = look.along(0.0);
    const PairClearance* near = in_the_way(link, pairs);
    if (!near) return std::nullopt;
    for (const AxisValues& place : {link.leg.places.front(), link.leg.places.back()}) {
        const auto there = look.at(place);
        if (!are_clear(there)) return std::nullopt;
        if (near->verdict == Verdict::clear && flutes_to_stock(there) < near->upper + room)
            return std::nullopt;
    }
    const std::optional<double> higher = lift(look);
    if (!higher) return std::nullopt;
    Finding finding;
    finding.rule = "low-retract";
    finding.block = link.block;
    finding.pair = {part_name(link.setup, near->pair), body_name(link.setup, near->pair)};
    finding.shortfall = *higher;
    finding.message =
        near->verdict == Verdict::clear
            ? fmt::format("The retract before this rapid is low: on the way the {} pass over the "
                          "{} by {} mm only.",
                          finding.pair[0], finding.pair[1],
                          bounds_text(near->lower, near->upper, " to ", 2))
            : fmt::format("The retract before this rapid is too low: {} is in the way of the {}.",
                          finding.pair[1], finding.pair[0]);
    finding.cure = fmt::format("Retract {:.1f} mm higher before moving across.",
                               std::ceil(10.0 * *higher - 1e-9) / 10.0);
    return finding;
}

} // namespace core
