#include "app/session/check_run.h"

#include <algorithm>
#include <chrono>

#include "app/session/conclusion.h"
#include "app/session/program_runner.h"

namespace app {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

} // namespace

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

core::Result<CheckRun> run_check(const CheckJob& job) {
    FEELER_TRY(PreparedCheck check, prepare_check(job));
    const Clock::time_point checking = Clock::now();
    ProgramRunner runner(check);
    runner.after_block = job.after_block;
    if (!job.start_line.empty())
        if (const auto begun = runner.start_at(job.start_line); !begun)
            return tl::unexpected(named(begun.error(), job.program));
    runner.to_the_end();
    check.run.times.check = seconds_since(checking);
    conclude(check, runner.place().machine, runner.length_doubts(), job.needs_surface);
    return std::move(check.run);
}

} // namespace app
