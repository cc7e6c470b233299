#include <algorithm>

#include <fmt/format.h>

#include "core/base/math.h"
#include "core/base/rule_table.h"
#include "core/sim/leg/leg_check.h"
#include "core/sim/rules/rules.h"
#include "core/sim/setup.h"
#include "core/sim/verdict.h"

namespace core {
namespace {

constexpr double room = 0.5;              // mm, minimum distance of a rapid over the stock
constexpr double highest_retract = 500.0; // mm, maximum increase that is tried
constexpr double retract_step = 0.01;

Setup with_every_pair(Setup setup) {
    setup.detail = Detail::every_pair;
    return setup;
}

/// Measures every pair, whatever detail the report has.
struct LinkCheck {
    const ExecutedLeg& link;
    Setup setup = with_every_pair(link.setup);
    CheckMemory memory = {};
    Statistics statistics = {};

    LegCheck check() {
        return {setup,  link.tool, FluteUse::not_cutting, link.block, link.mounted_fixtures,
                memory, statistics};
    }

    TrackedPairs at(const AxisValues& position) {
        TrackedPairs pairs;
        check().rest(position, 0.0, link.stock, pairs);
        return pairs;
    }

    TrackedPairs along(double higher) {
        Leg leg = link.leg;
        for (AxisValues& position : leg.positions) position[2] += higher;
        CutModel stock = link.stock;
        TrackedPairs pairs;
        check().run(leg, 0.0, stock, pairs);
        return pairs;
    }
};

bool is_flutes_over_stock(const PairClearance& pair) {
    return !pair.pair.fixture && pair.pair.part == PartKind::flutes;
}

bool are_clear(const TrackedPairs& pairs) {
    return std::all_of(pairs.begin(), pairs.end(),
                       [](const TrackedPair& pair) { return pair.verdict == Verdict::clear; });
}

/// Distance from the flutes to the stock, mm.
double flutes_to_stock(const TrackedPairs& pairs) {
    for (const TrackedPair& pair : pairs)
        if (is_flutes_over_stock(pair)) return pair.found() ? pair.upper : pair.lower;
    return infinity;
}

/// Whether the flutes pass above the top of the stock, rather than next to a wall.
bool passes_over(const ExecutedLeg& link, const PairClearance& pair) {
    const Vec3 up = pair.on_tool - pair.on_body;
    return up.z > 0.7 * glm::length(up) && pair.on_body.z >= link.stock.outer_box.max.z - room;
}

/// The pair that the rapid brings too near; null if there is none.
const PairClearance* in_the_way(const ExecutedLeg& link, const TrackedPairs& pairs) {
    const PairClearance* worst = deciding_pair(pairs);
    if (worst && worst->verdict != Verdict::clear) return worst;
    for (const TrackedPair& pair : pairs)
        if (is_flutes_over_stock(pair) && pair.found() && pair.upper > 0.0 && pair.upper < room
            && passes_over(link, pair))
            return &pair;
    return nullptr;
}

/// Whether any pair is below its allowance on the link, or the flutes pass close to the stock.
bool is_doubtful(const ExecutedLeg& link, const TrackedPairs& known) {
    if (!are_clear(known)) return true;
    CheckMemory memory;
    Statistics statistics;
    return !LegCheck(link.setup, link.tool, FluteUse::not_cutting, link.block,
                     link.mounted_fixtures, memory, statistics)
                .flutes_have_room(link.leg, link.stock, room);
}

/// Increase in height at which the leg is clear of everything, to within `retract_step`, mm; empty
/// if there is none.
std::optional<double> lift(LinkCheck& probe) {
    const auto passes = [&](double higher) {
        const auto pairs = probe.along(higher);
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

/// The cure: the rapid at a height, rounded up, at which it was tried and is clear.
std::string cure_by(LinkCheck& probe, const Pair& pair, double higher, const std::string& body) {
    const double tried = std::ceil(10.0 * higher - 1e-9) / 10.0;
    const TrackedPairs above = probe.along(tried);
    if (!are_clear(above) || flutes_to_stock(above) < room)
        return "Retract higher before moving across.";
    double keeps = probe.setup.search_limit;
    for (const TrackedPair& each : above)
        if (each.pair == pair) keeps = each.lower;
    constexpr double least_shown = 0.001; // mm
    const std::string kept = keeps < least_shown
                                 ? std::string("is clear")
                                 : fmt::format("keeps {} mm from {}", clearance_at_least(keeps),
                                               pair.fixture ? body : "the stock");
    return fmt::format("Retract {:.1f} mm higher before moving across (tried: this rapid then {}).",
                       tried, kept);
}

} // namespace

bool goes_across(const Leg& leg) {
    if (!leg.straight || !leg.start_known || leg.positions.size() < 2) return false;
    const AxisValues &from = leg.positions.front(), &to = leg.positions.back();
    for (size_t i = 3; i < axis_count; ++i)
        if (from[i] != to[i]) return false;
    return core::hypot(to[0] - from[0], to[1] - from[1]) > 1.0;
}

std::optional<Finding> low_retract(const ExecutedLeg& link, const TrackedPairs& known) {
    if (!is_doubtful(link, known)) return std::nullopt;
    LinkCheck probe{link};
    const TrackedPairs pairs = probe.along(0.0);
    const PairClearance* near = in_the_way(link, pairs);
    if (!near) return std::nullopt;
    for (const AxisValues& position : {link.leg.positions.front(), link.leg.positions.back()}) {
        const auto there = probe.at(position);
        if (!are_clear(there)) return std::nullopt;
        if (near->verdict == Verdict::clear && flutes_to_stock(there) < near->upper + room)
            return std::nullopt;
    }
    const std::optional<double> higher = lift(probe);
    if (!higher) return std::nullopt;
    Finding finding;
    finding.rule = rule_id("low-retract");
    finding.block = link.block;
    finding.pair = {part_name(link.setup, near->pair), body_name(link.setup, near->pair)};
    finding.shortfall = *higher;
    finding.message =
        near->verdict == Verdict::clear
            ? fmt::format("The retract before this rapid is low: the {} pass over the {} with "
                          "only {} mm to spare.",
                          finding.pair[0], finding.pair[1],
                          bounds_text(near->lower, near->upper, " to ", 2))
            : fmt::format("The retract before this rapid is too low: {} is in the way of the {}.",
                          finding.pair[1], finding.pair[0]);
    finding.cure = cure_by(probe, near->pair, *higher, finding.pair[1]);
    return finding;
}

} // namespace core
