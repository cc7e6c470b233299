#include "app/check/block_facts.h"

#include "app/check/check_run.h"

namespace app {
namespace {

void add_bodies(const CheckRun& record, const core::BlockResult& result, BlockFacts& facts) {
    for (const core::PairClearance& pair : result.pairs) {
        if (!pair.found()) continue;
        facts.bodies.push_back(core::part_name(record.setup, pair.pair));
        facts.bodies.push_back(core::body_name(record.setup, pair.pair));
    }
}

/// Also those that are told with another one.
void add_findings(const CheckRun& record, BlockFacts& facts) {
    const core::BlockIndex block{static_cast<uint32_t>(facts.block)};
    for (const auto* findings : {&record.findings, &record.taken_in})
        for (const core::Finding& finding : *findings)
            if (finding.block == block) facts.findings.push_back(&finding);
}

} // namespace

BlockFacts facts_of(const CheckRun& record, size_t block, const WantedFacts& wanted) {
    const CheckedBlock& checked = record.blocks[block];
    const core::BlockResult& result = checked.result;
    BlockFacts facts;
    facts.block = block;
    facts.line = checked.line;
    facts.depth = checked.calls.size();
    facts.text = checked.text;
    facts.file = checked.file;
    facts.motion = result.motion;
    facts.tool = result.tool;
    facts.verdict = result.verdict;
    facts.removed = result.removed;
    facts.duration = result.duration;
    facts.time = result.time;
    if (result.deciding) {
        const core::PairClearance& pair = result.pairs[*result.deciding];
        facts.clearance = pair.lower;
        facts.upper = pair.upper;
        facts.allowance = pair.allowance.distance;
        facts.margin = pair.margin();
    } else if (result.checked) {
        facts.clearance = facts.upper = facts.margin = core::infinity;
    }
    if (wanted.bodies) add_bodies(record, result, facts);
    if (wanted.findings) add_findings(record, facts);
    return facts;
}

} // namespace app
