#include "tests/support/device_judgement.h"

#include "app/session/coprocessor_check.h"
#include "app/session/program_runner.h"

namespace test_support {
namespace {

using app::BlockPermit;

bool violates(const core::BlockResult& result) {
    for (const core::PairClearance& pair : result.pairs)
        if (pair.verdict >= core::Verdict::violation) return true;
    return false;
}

void compare(const BlockPermit& permit, const app::CheckedBlock& block, DeviceJudgement& judgement,
             const std::string& file) {
    ++judgement.blocks;
    judgement.refused += permit.permitted ? 0 : 1;
    judgement.not_asked += permit.not_asked.empty() ? 0 : 1;
    if (violates(block.result)) {
        ++judgement.violations;
        if (permit.permitted) judgement.missed += file + ":" + std::to_string(block.line) + "\n";
    } else if (!permit.permitted && permit.not_asked.empty()) {
        const bool is_open = block.result.verdict == core::Verdict::undecided;
        ++(is_open ? judgement.undecided : judgement.false_alarms);
    }
}

/// What the device says of the block that the runner will run next.
core::Result<BlockPermit> ask_next(app::CoprocessorCheck& device, const app::RunPlace& place,
                                   app::BlockRunner& ahead) {
    core::Result<BlockPermit> permit;
    ahead.visit_ahead(place.control, place.lowering,
                      [&](const gcode::BlockResult& block, std::span<const core::Event> events) {
                          permit =
                              device.ask({.block = block.block, .events = events}, place.machine);
                          return false;
                      });
    return permit;
}

} // namespace

void judge_by_device(const app::CheckJob& job, hwsim::DevicePort port, DeviceJudgement& judgement) {
    const auto fail = [&](const core::Error& error) {
        judgement.errors += job.program + ": " + error.message + "\n";
    };
    auto check = app::prepare_check(job);
    if (!check) return fail(check.error());
    auto coprocessor =
        app::CoprocessorCheck::with(std::move(port), check->run.setup, check->machine.stock);
    if (!coprocessor) return fail(coprocessor.error());
    app::ProgramRunner runner(*check);
    app::BlockRunner ahead(*check);
    while (true) {
        const auto permit = ask_next(*coprocessor, runner.place(), ahead);
        if (!permit) return fail(permit.error());
        if (!runner.advance()) return;
        compare(*permit, check->run.blocks.back(), judgement, job.program);
    }
}

} // namespace test_support
