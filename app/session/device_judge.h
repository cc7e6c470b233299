#pragma once

#include <memory>

#include "app/session/coprocessor_check.h"

namespace app {

/// A coprocessor that judges the blocks of a check in place of the distance core: what it says has
/// gone through its registers and its memory only. Its functional model is asked, which gives the
/// answers of the device without their time. Refers to the set-up.
class DeviceJudge {
public:
    /// Brings the stock into a device.
    ///
    /// Errors: a stock that does not fit into its memory.
    static core::Result<DeviceJudge> with(const core::Setup& setup, const core::CutModel& stock);

    /// What the device says of a block: each pair that it was asked about, with a lower bound of
    /// its clearance, and a finding `refused` if it permits less than all.
    ///
    /// Errors: models that do not fit into the device.
    core::Result<core::Judgement> judge(std::span<const core::Event> block,
                                        const core::SimulatorState& before);

private:
    explicit DeviceJudge(const core::Setup& setup) : setup_(&setup) {}

    const core::Setup* setup_;
    std::unique_ptr<hwsim::FunctionalDevice> device_ = {}; // the driver refers to it
    std::optional<CoprocessorCheck> check_ = {};
};

} // namespace app
