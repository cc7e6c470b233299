#include "tests/support/device_judgement.h"

#include <gtest/gtest.h>

#include "app/check/check_job.h"
#include "app/check/prepared_check.h"
#include "app/check/program_runner.h"
#include "app/coproc/device_check.h"

namespace test_support {

core::Result<JudgedProgram> judged_by_device(const app::CheckJob& job, hwsim::DevicePort port) {
    FEELER_TRY(app::PreparedCheck check, app::prepare_check(job));
    FEELER_TRY(app::CoprocessorCheck coprocessor,
               app::CoprocessorCheck::with(std::move(port), check.run.setup, check.machine->stock));
    JudgedProgram judged;
    app::ProgramRunner runner(check);
    while (true) {
        const auto block = runner.next_block();
        app::BlockPermit permit;
        if (block) {
            FEELER_TRY(permit, coprocessor.ask(block->events, runner.machine(), block->doubt));
        }
        if (!runner.advance()) break;
        judged.permits.push_back(std::move(permit));
    }
    judged.blocks = std::move(check.run.blocks);
    judged.findings = std::move(check.run.findings);
    return judged;
}

void judge_by_device(const app::CheckJob& job, hwsim::DevicePort port, DeviceJudgement& judgement) {
    const auto judged = judged_by_device(job, std::move(port));
    if (!judged) {
        judgement.errors += job.program + ": " + judged.error().message + "\n";
        return;
    }
    for (size_t i = 0; i < judged->permits.size(); ++i) {
        const app::CheckedBlock& block = judged->blocks[i];
        const size_t missed = judgement.counts.missed;
        add(judgement.counts, judged->permits[i], block.result);
        if (judgement.counts.missed > missed)
            judgement.missed += job.program + ":" + std::to_string(block.line) + "\n";
        if (judged->permits[i].permitted && block.result.verdict == core::Verdict::undecided)
            judgement.unproven += job.program + ":" + std::to_string(block.line) + "\n";
    }
    for (const core::Finding& finding : judged->findings)
        if (finding.rule == "undecided" && finding.block
            && judged->permits[core::value_of(*finding.block)].permitted)
            judgement.unproven += job.program + ": " + finding.message + "\n";
}

void record(const app::EngineAgreement& counts) {
    const auto write = [](const char* name, size_t count) {
        testing::Test::RecordProperty(name, static_cast<int>(count));
    };
    write("blocks", counts.blocks);
    write("violations", counts.violations);
    write("refused", counts.refused);
    write("not_asked", counts.not_queried);
    write("undecided", counts.undecided);
    write("false_alarms", counts.false_alarms);
}

} // namespace test_support
