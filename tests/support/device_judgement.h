#pragma once

#include <string>

#include "app/session/check_run.h"
#include "hwsim/device_port.h"

namespace test_support {

/// What the coprocessor said of the blocks of programs, beside what the exact engine did.
struct DeviceJudgement {
    int blocks = 0;
    int violations = 0;   // violations and collisions by the exact engine
    int refused = 0;      // by the device
    int not_asked = 0;    // of these, motions that the device cannot be asked
    int undecided = 0;    // refused, and undecided by the exact engine
    int false_alarms = 0; // refused, and clear by the exact engine
    std::string missed;   // violations that the device permitted: files and lines
    std::string errors;   // why it could not be judged

    bool operator==(const DeviceJudgement&) const = default;
};

/// Runs a program block by block, each first on the device at the port, and adds what came of it.
void judge_by_device(const app::CheckJob& job, hwsim::DevicePort port, DeviceJudgement& judgement);

} // namespace test_support
