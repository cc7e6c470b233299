#include "app/check/check_run.h"

#include <algorithm>

#include "app/base/stopwatch.h"
#include "app/check/check_job.h"
#include "app/check/conclusion.h"
#include "app/check/input_file.h"
#include "app/check/prepared_check.h"
#include "app/check/program_runner.h"
#include "app/coproc/device_judge.h"
#include "app/setup/setup_file.h"
#include "core/dbm/stock_mesh.h"
#include "core/sim/run/simulator.h"

namespace app {

const char* name_of(Engine engine) { return engine == Engine::exact ? "exact" : "coprocessor"; }

bool CheckRun::has_errors() const {
    return std::any_of(findings.begin(), findings.end(), [](const core::Finding& finding) {
        return finding.severity == core::Severity::error;
    });
}

double least_clearance(const core::Setup& setup, const core::BlockResult& result) {
    double lower = result.checked ? setup.search_limit : 0.0;
    for (const core::PairClearance& pair : result.pairs) lower = std::min(lower, pair.lower);
    return lower;
}

const CheckedBlock* nearest_block(const CheckRun& run) {
    const CheckedBlock* nearest = nullptr;
    const auto margin = [](const CheckedBlock& block) {
        return block.result.pairs[*block.result.deciding].margin();
    };
    for (const CheckedBlock& block : run.blocks)
        if (block.result.deciding && (!nearest || margin(block) < margin(*nearest)))
            nearest = &block;
    return nearest;
}

void look_beside(CheckJob& job) {
    if (!job.setup.empty() || job.program.empty()) return;
    job.setup = setup_beside(job.program);
    job.setup_was_found = !job.setup.empty();
}

core::Result<CheckRun> run_check(const CheckJob& job) {
    const InputRecorder recorder;
    FEELER_TRY(PreparedCheck check, prepare_check(job));
    const Stopwatch checking;
    ProgramRunner runner(check);
    runner.after_block = job.after_block;
    std::optional<DeviceJudge> device;
    if (job.engine == Engine::coprocessor) {
        FEELER_TRY(device, DeviceJudge::with(check.run.setup, runner.state().machine.stock));
        runner.let_judge([&](std::span<const core::Event> block, const auto& before) {
            return device->judge(block, before);
        });
        check.run.engine = Engine::coprocessor;
        check.run.assumptions.push_back(
            "the coprocessor alone judges clearances and may refuse a clear block: its models are "
            "larger than the bodies by about a mesh size");
    }
    if (!job.start_line.empty())
        if (const auto begun = runner.start_at(job.start_line); !begun)
            return tl::unexpected(named(begun.error(), job.program));
    runner.run_to_end();
    check.run.times.check = checking.seconds();
    const std::vector<LengthMismatch> mismatches = runner.length_mismatches();
    conclude(check, std::move(runner.mutable_state().machine), mismatches, job.needs_surface);
    check.run.inputs = recorder.inputs();
    return std::move(check.run);
}

} // namespace app
