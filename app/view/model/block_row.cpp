#include "app/view/model/block_row.h"

#include <algorithm>

#include "app/check/check_run.h"
#include "app/debug/condition.h"
#include "core/sim/clearance.h"
#include "core/sim/run/simulator.h"

namespace app::viewer {
namespace {

/// The deciding pair that was found, or nothing.
const core::PairClearance* shown_pair(const core::BlockResult& result) {
    if (!result.deciding || *result.deciding >= result.pairs.size()) return nullptr;
    const core::PairClearance& pair = result.pairs[*result.deciding];
    return pair.found() ? &pair : nullptr;
}

PairWitness witness_of(const core::Setup& setup, const core::PairClearance& pair) {
    return {.names = {core::part_name(setup, pair.pair), core::body_name(setup, pair.pair)},
            .on_tool = pair.on_tool,
            .on_body = pair.on_body,
            .time = pair.time,
            .verdict = pair.verdict};
}

} // namespace

BlockRow row_of(const core::Setup& setup, const CheckedBlock& checked) {
    const core::BlockResult& result = checked.result;
    BlockRow row;
    row.line = checked.line;
    row.text = checked.text;
    row.file = checked.file;
    row.depth = static_cast<uint32_t>(checked.calls.size());
    row.motion = result.motion;
    row.tool = result.tool;
    row.time = result.time;
    row.duration = result.duration;
    row.removed = result.removed;
    row.is_known = true;
    row.is_judged = result.checked;
    row.verdict = result.verdict;
    if (!moves(row) || !result.checked) return row;
    const core::PairClearance* pair = shown_pair(result);
    if (!pair) {
        row.lower = least_clearance(setup, result);
        return row;
    }
    row.lower = std::max(pair->lower, 0.0);
    row.upper = std::max(pair->upper, 0.0);
    row.allowance = pair->allowance.distance;
    row.part = core::part_name(setup, pair->pair);
    row.body = core::body_name(setup, pair->pair);
    row.on_tool = pair->on_tool;
    row.on_body = pair->on_body;
    row.witness_time = pair->time;
    for (const core::PairClearance& other : result.pairs)
        if (&other != pair && other.found() && other.verdict != core::Verdict::clear)
            row.others.push_back(witness_of(setup, other));
    for (const core::Finding& finding : result.findings)
        if (finding.overlap && finding.pair[0] == row.part && finding.pair[1] == row.body)
            row.overlap = finding.overlap;
    return row;
}

std::optional<PairWitness> witness_in(const BlockRow& row, const BodyNames& names) {
    for (const PairWitness& other : row.others)
        if (other.names == names) return other;
    if (!row.has_witness()) return {};
    return PairWitness{.names = {row.part, row.body},
                       .on_tool = row.on_tool,
                       .on_body = row.on_body,
                       .time = row.witness_time,
                       .verdict = row.verdict};
}

BlockFacts facts_of(const BlockRow& row, size_t block) {
    BlockFacts facts;
    facts.block = block;
    facts.line = row.line;
    facts.depth = row.depth;
    facts.text = row.text;
    facts.file = row.file;
    facts.motion = row.motion;
    facts.tool = row.tool;
    facts.removed = row.removed;
    facts.duration = row.duration;
    facts.time = row.time;
    if (row.is_known) facts.verdict = row.verdict;
    if (row.upper) {
        facts.clearance = row.lower;
        facts.upper = row.upper;
        facts.allowance = row.allowance;
        facts.margin = *row.lower - row.allowance.value_or(0.0);
        facts.bodies = {row.part, row.body};
    } else if (row.is_known && row.is_judged) {
        facts.clearance = facts.upper = facts.margin = core::infinity;
    }
    return facts;
}

bool is_near(const BlockRow& row) {
    return !is_offending(row) && row.upper && row.allowance && *row.allowance > 0.0
           && *row.lower < 2.0 * *row.allowance;
}

render::ClearanceState state_of(const BlockRow& row) {
    if (is_offending(row)) return render::ClearanceState::violation;
    if (is_near(row)) return render::ClearanceState::near;
    return row.is_known && row.is_judged ? render::ClearanceState::clear
                                         : render::ClearanceState::none;
}

} // namespace app::viewer
