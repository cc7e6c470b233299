#pragma once

#include <string>

#include "app/check/check_run.h"
#include "app/coproc/device_answer.h"
#include "app/coproc/device_judge.h"
#include "hwsim/driver.h"

namespace app {
struct CheckJob;
}

namespace test_support {

/// The coprocessor's decisions on the blocks of programs compared with the exact engine.
struct DeviceJudgement {
    app::EngineAgreement counts;
    std::string missed;   // violations that the device permitted: files and lines
    std::string unproven; // blocks that it permitted and that the exact engine does not clear
    std::string errors;   // why the comparison failed

    bool operator==(const DeviceJudgement&) const = default;
};

/// A program whose blocks were submitted to a device one after the other.
struct JudgedProgram {
    std::vector<app::BlockPermit> permits;
    app::CheckedBlocks blocks; // from the exact engine
    std::vector<core::Finding> findings;
};

/// Errors: those of the check and of the driver.
core::Result<JudgedProgram> judged_by_device(const app::CheckJob& job, hwsim::DevicePort port);

/// Records the counts in the report of the running test.
void record(const app::EngineAgreement& counts);

/// Runs a program block by block, first on the device at the port, and adds the results.
void judge_by_device(const app::CheckJob& job, hwsim::DevicePort port, DeviceJudgement& judgement);

} // namespace test_support
