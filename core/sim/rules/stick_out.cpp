#include <algorithm>

#include <fmt/format.h>

#include "core/base/math.h"
#include "core/base/rule_table.h"
#include "core/motion/kinematics.h"
#include "core/sim/leg/leg_check.h"
#include "core/sim/rules/rules.h"
#include "core/sim/setup.h"

namespace core {
namespace {

constexpr double longest_stick_out = 300.0; // mm, maximum increase that is tried
constexpr size_t enough = 500;      // maximum number of legs per tool that are checked again
constexpr size_t long_work = 20000; // tests; a computation counts once more for each of them

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

/// Tries other heights of a shank or holder on a leg, against the remaining stock alone.
class ReachTrial {
public:
    ReachTrial(const ExecutedLeg& cut, PartKind from)
        : cut_(cut),
          from_(from),
          setup_(cut.setup),
          tool_(cut.tool),
          turns_(turn_of(setup_.machine, cut.leg.positions.front(), cut.leg.positions.back())
                 > 0.0) {
        setup_.fixtures.clear();
        setup_.machine.bodies.clear();
        setup_.needs_only_verdict = true;
        std::erase_if(tool_.parts, [&](const ToolPart& part) {
            return part.kind != PartKind::flutes && part.kind != from;
        });
    }

    /// Whether the part, raised by `by`, keeps its allowance.
    bool keeps_clear(double by) {
        const ToolAssembly longer = raised(tool_, from_, by);
        CheckMemory memory;
        LegCheck check(setup_, longer, FluteUse::cutting, cut_.block, {}, memory, done_);
        // The flutes have cut the leg already: nothing more is removed on it.
        if (!turns_) return check.keeps_clear(from_, cut_.leg, cut_.stock);
        CutModel stock = cut_.stock;
        TrackedPairs pairs;
        check.run(cut_.leg, 0.0, stock, pairs);
        return std::all_of(pairs.begin(), pairs.end(), [&](const TrackedPair& pair) {
            return pair.pair.part == PartKind::flutes || pair.verdict == Verdict::clear;
        });
    }

    /// The tests of all trials; a recomputed square takes as long as 20 of them.
    size_t work() const { return done_.box_tests + done_.shape_tests + 20 * done_.refined; }

private:
    const ExecutedLeg& cut_;
    PartKind from_;
    Setup setup_;
    ToolAssembly tool_; // its flutes and the part
    bool turns_;        // rotary axes move on the leg
    Statistics done_;
};

/// The least raise, at least `known`, that keeps the leg clear and after which the height of the
/// part, now `now`, is a whole tenth; `longest_stick_out` if there is none.
double needed(ReachTrial& trial, double now, double known) {
    if (known > 0.0 && trial.keeps_clear(known)) return known;
    constexpr double tenths = 10.0;
    const auto raise = [&](int height) { return height / tenths - now; };
    int low = static_cast<int>(std::floor(tenths * (now + known) + 1e-9));
    const int highest = low + static_cast<int>(tenths * (longest_stick_out - known));
    int high = low + static_cast<int>(tenths * std::max(1.0, known));
    while (high < highest && !trial.keeps_clear(raise(high))) {
        const int step = high - low;
        low = high;
        high += 2 * step;
    }
    if (high >= highest) return longest_stick_out;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        (trial.keeps_clear(raise(middle)) ? high : low) = middle;
    }
    return raise(high);
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
    return core::hypot(to[0] - from[0], to[1] - from[1]) > 1.0;
}

} // namespace

void note_reach(ToolReaches& reaches, const ExecutedLeg& cut, const TrackedPairs& pairs) {
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
        if (reach.computations >= enough) {
            reach.computations = enough + 1; // this one is left out
            continue;
        }
        const double now = is_shank ? top_of_flutes(cut.tool) : stick_out_of(cut.tool);
        ReachTrial trial(cut, pair.pair.part);
        more = needed(trial, now, more);
        reach.computations = std::min(enough, reach.computations + 1 + trial.work() / long_work);
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
