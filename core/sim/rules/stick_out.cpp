#include <algorithm>

#include <fmt/format.h>

#include "core/base/rule_table.h"
#include "core/sim/leg/leg_check.h"
#include "core/sim/rules/rules.h"
#include "core/sim/setup.h"

namespace core {
namespace {

constexpr double longest_stick_out = 300.0; // mm, maximum increase that is tried
constexpr double stick_out_step = 0.01;     // mm, precision of the result
constexpr size_t enough = 500; // maximum number of legs per tool that are checked again

/// The tool with its holder, or its shank and holder, raised by `by`. Raising the holder leaves no
/// gap: the shank becomes longer.
ToolAssembly raised(ToolAssembly tool, PartKind from, double by) {
    for (ToolPart& part : tool.parts) {
        if (part.kind != from && part.kind != PartKind::holder) continue;
        for (ProfileElement& element : part.profile.elements) {
            element.z0 += by;
            element.z1 += by;
        }
    }
    if (from != PartKind::holder) return tool;
    for (ToolPart& part : tool.parts)
        if (part.kind == PartKind::shank && !part.profile.empty()) {
            ProfileElement& top = part.profile.elements.back();
            part.profile.elements.push_back({top.z1, top.r1, top.z1 + by, top.r1, top.margin});
        }
    return tool;
}

/// Whether the part `from`, raised by `by`, keeps its allowance to the remaining stock on the leg.
bool keeps_clear(const ExecutedLeg& cut, PartKind from, double by) {
    const ToolAssembly longer = raised(cut.tool, from, by);
    CutModel stock = cut.stock;
    CheckMemory memory;
    Statistics statistics;
    std::vector<TrackedPair> pairs;
    LegCheck(cut.setup, longer, FluteUse::cutting, cut.block, cut.mounted_fixtures, memory,
             statistics)
        .run(cut.leg, 0.0, stock, pairs);
    return std::all_of(pairs.begin(), pairs.end(), [&](const TrackedPair& pair) {
        const bool concerns = from == PartKind::holder ? pair.pair.part == PartKind::holder
                                                       : pair.pair.part == PartKind::shank;
        return !concerns || pair.pair.fixture || pair.verdict == Verdict::clear;
    });
}

/// Least raise, to within `stick_out_step` and at least `known`, that keeps the leg clear, mm;
/// `longest_stick_out` if there is none.
double needed(const ExecutedLeg& cut, PartKind from, double known) {
    if (keeps_clear(cut, from, known)) return known;
    double low = known, high = std::max(1.0, 2.0 * known);
    while (high < longest_stick_out && !keeps_clear(cut, from, high)) {
        low = high;
        high *= 2.0;
    }
    if (high >= longest_stick_out) return longest_stick_out;
    while (high - low > stick_out_step) {
        const double middle = 0.5 * (low + high);
        (keeps_clear(cut, from, middle) ? high : low) = middle;
    }
    return high;
}

/// Stated flute length, else the height of the flutes' shape, which may reach a little into the
/// neck.
double top_of_flutes(const ToolAssembly& tool) {
    const double stated = tool.description.flute_length;
    return stated > 0.0 ? stated : bounds(tool.parts[0].profile).max.z;
}

double stick_out_of(const ToolAssembly& tool) {
    for (const ToolPart& part : tool.parts)
        if (part.kind == PartKind::holder) return bounds(part.profile).min.z;
    return tool.length;
}

/// A length, rounded up to a tenth.
double tenths_up(double length) { return std::ceil(10.0 * length - 1e-9) / 10.0; }

/// By how much a part is raised so that its new height above the tip is a whole tenth, at least
/// `more`, if the leg was tried with it and is clear; else `longest_stick_out`.
double tried_raise(const ExecutedLeg& cut, PartKind from, double now, double more) {
    if (more >= longest_stick_out) return more;
    const double raise = tenths_up(now + more) - now;
    return raise <= more || keeps_clear(cut, from, raise) ? raise : longest_stick_out;
}

/// In which blocks a length was tried.
std::string in_blocks(const ToolReach& reach) {
    if (reach.computations > enough)
        return " in the first of these blocks (the others were not tried)";
    if (reach.blocks == 2) return " in both blocks (tried)";
    return reach.blocks > 1 ? fmt::format(" in all {} blocks (tried)", reach.blocks) : " (tried)";
}

Finding about(const char* rule, std::optional<BlockIndex> block) {
    Finding finding;
    finding.rule = rule;
    finding.block = block;
    return finding;
}

Finding short_stick_out(const ToolAssembly& tool, const ToolReach& reach) {
    const int number = value_of(tool.description.number);
    const double now = stick_out_of(tool);
    Finding finding = about(rule_id("stick-out-short"), reach.holder_block);
    finding.pair = {name_of(PartKind::holder), "stock"};
    finding.shortfall = reach.more_stick_out;
    finding.message = fmt::format("Tool {} sticks out {:.1f} mm, too little for this depth: its "
                                  "holder comes too close to the stock.",
                                  number, now);
    finding.cure =
        reach.more_stick_out >= longest_stick_out
            ? "No stick-out is long enough: use less depth or a slimmer holder."
            : fmt::format("A stick-out of {:.1f} mm gives enough clearance from the stock{}; or "
                          "use a slimmer holder.",
                          tenths_up(now + reach.more_stick_out), in_blocks(reach));
    return finding;
}

/// Adds the findings about a shank in the way: the flutes, or the flutes with the neck, are too
/// short for the depth.
void add_short_flutes(const ToolAssembly& tool, const ToolReach& reach,
                      std::vector<Finding>& findings) {
    const int number = value_of(tool.description.number);
    const double now = top_of_flutes(tool);
    const bool hopeless = reach.more_flute >= longest_stick_out;
    Finding deep = about(rule_id("over-engagement"), reach.shank_block);
    deep.pair = {name_of(PartKind::shank), "stock"};
    deep.shortfall = reach.more_flute;
    deep.message =
        fmt::format("Tool {} cuts deeper than its flutes are long ({:.1f} mm): the shank "
                    "is pushed into material.",
                    number, now);
    deep.cure =
        hopeless
            ? "Use less depth, or a tool with a slimmer shank."
            : fmt::format("Flutes of {:.1f} mm would be long enough{}; or use shallower passes.",
                          tenths_up(now + reach.more_flute), in_blocks(reach));
    Finding reach_short = deep;
    reach_short.rule = rule_id("stick-out-short");
    reach_short.message = fmt::format("Tool {} does not reach this depth: its shank "
                                      "begins {:.1f} mm above the tip and meets the wall.",
                                      number, now);
    reach_short.cure =
        hopeless ? "Use a tool with a slimmer shank or a neck, or less depth."
                 : fmt::format(
                     "Use a tool that is relieved up to {:.1f} mm above its tip{}, or less depth.",
                     tenths_up(now + reach.more_flute), in_blocks(reach));
    findings.push_back(std::move(deep));
    findings.push_back(std::move(reach_short));
}

Finding rubbing(const ToolAssembly& tool, const ToolReach& reach) {
    Finding finding = about(rule_id("over-engagement"), reach.rub_block);
    finding.severity = Severity::note;
    finding.pair = {name_of(PartKind::shank), "stock"};
    finding.message = fmt::format("Tool {} cuts deeper than its flutes are long ({:.1f} mm): its "
                                  "shank rubs along the wall that they have cut.",
                                  value_of(tool.description.number), top_of_flutes(tool));
    finding.cure = "Use a tool with longer flutes or a relieved neck.";
    return finding;
}

bool goes_sideways(const Leg& leg) {
    const AxisValues &from = leg.positions.front(), &to = leg.positions.back();
    return std::hypot(to[0] - from[0], to[1] - from[1]) > 1.0;
}

} // namespace

void note_reach(ToolReaches& reaches, const ExecutedLeg& cut,
                const std::vector<TrackedPair>& pairs) {
    constexpr double touch = 0.02; // mm
    for (const TrackedPair& pair : pairs) {
        const bool is_shank = pair.pair.part == PartKind::shank;
        if (pair.pair.fixture || !(is_shank || pair.pair.part == PartKind::holder)) continue;
        const bool is_clear = pair.verdict == Verdict::clear;
        const bool rubs = is_shank && is_clear && pair.upper <= touch && pair.lower <= resolution
                          && goes_sideways(cut.leg);
        if (is_clear && !rubs) continue;
        ToolReach& reach = reaches[cut.tool.description.number];
        if (rubs) {
            if (!reach.rub_block) reach.rub_block = cut.block;
            continue;
        }
        reach.blocks += reach.last != cut.block;
        reach.last = cut.block;
        auto& first = is_shank ? reach.shank_block : reach.holder_block;
        if (!first) first = cut.block;
        double& more = is_shank ? reach.more_flute : reach.more_stick_out;
        if (reach.computations++ >= enough) continue;
        const double now = is_shank ? top_of_flutes(cut.tool) : stick_out_of(cut.tool);
        more = tried_raise(cut, pair.pair.part, now, needed(cut, pair.pair.part, more));
    }
}

std::vector<Finding> findings_of(const ToolReaches& reaches, const Setup& setup) {
    std::vector<Finding> findings;
    for (const auto& [number, reach] : reaches) {
        const ToolAssembly& tool = setup.tools.at(number);
        if (reach.holder_block) findings.push_back(short_stick_out(tool, reach));
        if (reach.shank_block)
            add_short_flutes(tool, reach, findings);
        else if (reach.rub_block)
            findings.push_back(rubbing(tool, reach));
    }
    return findings;
}

} // namespace core
