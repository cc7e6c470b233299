#pragma once

#include <string>

#include "app/check/check_run.h"
#include "app/coproc/study/coprocessor_report.h"
#include "hwsim/driver.h"

namespace test_support {

/// What the coprocessor said of the blocks of programs, beside what the exact engine did.
struct DeviceJudgement {
    app::EngineAgreement counts;
    std::string missed; // violations that the device permitted: files and lines
    std::string errors; // why it could not be judged

    bool operator==(const DeviceJudgement&) const = default;
};

/// A program of which each block was asked of a device, one after the other.
struct JudgedProgram {
    std::vector<app::BlockPermit> permits;
    std::vector<app::CheckedBlock> blocks; // by the exact engine
};

/// Errors: those of the check and of the driver.
core::Result<JudgedProgram> judged_by_device(const app::CheckJob& job, hwsim::DevicePort port);

/// Writes the counts into the report of the test that runs.
void record(const app::EngineAgreement& counts);

/// Runs a program block by block, each first on the device at the port, and adds what came of it.
void judge_by_device(const app::CheckJob& job, hwsim::DevicePort port, DeviceJudgement& judgement);

} // namespace test_support
