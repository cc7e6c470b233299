#include "tests/support/device_judgement.h"

#include <gtest/gtest.h>

#include "app/session/program_runner.h"

namespace test_support {

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
        const app::RunPlace& place = runner.place();
        const auto events = app::first_events([&](const app::BlockVisit& look) {
            ahead.visit_ahead(place.control, place.lowering, look);
        });
        core::Result<app::BlockPermit> permit;
        if (events) permit = coprocessor->ask(*events, place.machine);
        if (!permit) return fail(permit.error());
        if (!runner.advance()) return;
        const app::CheckedBlock& block = check->run.blocks.back();
        const size_t missed = judgement.counts.missed;
        add(judgement.counts, *permit, block.result);
        if (judgement.counts.missed > missed)
            judgement.missed += job.program + ":" + std::to_string(block.line) + "\n";
    }
}

void record(const app::EngineAgreement& counts) {
    const auto write = [](const char* name, size_t count) {
        testing::Test::RecordProperty(name, static_cast<int>(count));
    };
    write("blocks", counts.blocks);
    write("violations", counts.violations);
    write("refused", counts.refused);
    write("not_asked", counts.not_asked);
    write("undecided", counts.undecided);
    write("false_alarms", counts.false_alarms);
}

} // namespace test_support
