#include "core/sim/run/simulator.h"

#include <thread>

#include "core/sim/run/block_run.h"
#include "core/sim/setup.h"

namespace core {

Result<SimulatorState> start_of_run(const Setup& setup, const AxisPosition& position) {
    auto made = make_cut_model(setup.stock, setup.mesh_size, setup.memory_limit);
    if (!made) {
        made.error().message = "stock: " + made.error().message;
        return tl::unexpected(std::move(made).error());
    }
    CutModel& stock = *made;
    if (setup.earlier_cuts) cut(stock, *setup.earlier_cuts, std::thread::hardware_concurrency());
    SimulatorState state{.stock = std::move(stock)};
    state.tool = setup.tool_at_start;
    state.tool_known = setup.tool_at_start.has_value();
    if (state.tool == ToolNumber{0} && !setup.tools.contains(*state.tool)) state.tool.reset();
    state.position = position;
    state.is_assumed = setup.start_is_assumed;
    for (const Fixture& fixture : setup.fixtures)
        state.mounted_fixtures.push_back(fixture.is_there);
    state.pieces = piece_tracker(state.stock);
    state.corners = corners_at_start(setup.machine);
    return state;
}

BlockResult run_block(const Setup& setup, const BlockEvents& block, SimulatorState& state) {
    BlockRun run{setup, block, state};
    const size_t cuts_before = state.stock.log.size();
    run.result.time = state.time;
    run.result.tool = state.tool;
    for (const Event& event : block.events)
        std::visit([&](const auto& e) { run.execute_motion(e); }, event);
    if (block.is_cycle && run.result.motion != BlockMotion::none)
        run.result.motion = BlockMotion::cycle;
    if (!block.is_trial)
        for (Finding& finding :
             track_pieces(setup, state.mounted_fixtures, state.stock, cuts_before, state.pieces))
            run.add(std::move(finding));
    if (block.judgement && block.path < PathCertainty::pose_unknown)
        run.conclude(*block.judgement);
    else
        run.conclude();
    if (block.path != PathCertainty::known && run.result.motion != BlockMotion::none) {
        // The bodies may have moved otherwise.
        run.result.verdict = std::max(run.result.verdict, Verdict::undecided);
        for (TrackedPair& pair : run.pairs)
            pair.verdict = std::max(pair.verdict, Verdict::undecided);
    }
    run.result.pairs.assign(run.pairs.begin(), run.pairs.end());
    state.time += run.result.duration;
    return std::move(run.result);
}

std::vector<Finding> end_of_run(const Setup& setup, SimulatorState& state) {
    std::vector<Finding> findings = findings_of(state.rules.reaches, setup);
    const auto tool = state.tool ? setup.tools.find(*state.tool) : setup.tools.end();
    if (tool != setup.tools.end())
        if (auto air = end_air(state.rules.air, tool->second.description.diameter))
            findings.push_back(*std::move(air));
    for (Finding& finding : findings) settle_severity(setup, finding);
    std::erase_if(findings,
                  [](const Finding& finding) { return finding.severity == Severity::off; });
    return findings;
}

} // namespace core
