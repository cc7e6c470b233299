#pragma once

#include <deque>
#include <functional>
#include <memory>

#include "app/coproc/device_check.h"
#include "hwsim/coprocessor.h"
#include "hwsim/driver.h"

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

/// Sums since reset, in the device's own counters.
struct DeviceTotals {
    std::array<uint64_t, hwsim::counter_count> counters{};

    uint64_t operator[](hwsim::Counter counter) const {
        return counters[static_cast<size_t>(counter)];
    }
};

/// What the coprocessor did for a block.
struct DeviceBlock {
    BlockPermit permit;
    uint64_t cycles = 0;   // from the first word of the stock or the block to its permit
    uint64_t interval = 0; // of these, those behind the permit of the block before
    uint64_t nodes = 0;    // visited in both trees
    uint64_t pairs = 0;    // of records compared
    DeviceTotals after;    // at its permit; those of the block before if nothing was asked
};

/// The blocks that are in a device: the oldest that has no answer yet, and the newest.
struct BlocksInDevice {
    size_t oldest = 0, newest = 0;
};

/// An emulated device that is given the blocks of a program one behind the other, each before those
/// in front of it have been answered: as many as its FIFO holds. A block that is refused stops the
/// device; those behind it are asked again then, as if a person had let the machine go on. Refers
/// to the set-up. It stays where it is.
class DevicePipeline {
public:
    /// Brings the stock into a device. `on_cycle` sees it after each cycle, if there is one.
    ///
    /// Errors: a device that cannot be, a stock that does not fit.
    static core::Result<std::unique_ptr<DevicePipeline>>
    with(const hwsim::DeviceConfig& config, const core::Setup& setup, const core::CutModel& stock,
         std::function<void(const BlocksInDevice&, const hwsim::CoprocessorState&)> on_cycle = {});

    /// Asks about the next block, as soon as there is room for it.
    ///
    /// Errors: models that do not fit into the device.
    core::Result<void> push(std::span<const core::Event> block, const core::SimulatorState& before);

    /// Waits until all blocks are answered.
    core::Result<void> finish();

    /// Those that have been answered, in order.
    const std::vector<DeviceBlock>& blocks() const { return blocks_; }
    DeviceTotals totals();

private:
    /// A block without an answer.
    struct Pending {
        std::vector<core::Event> events;
        core::SimulatorState before;
        bool is_pushed = false;
        uint64_t begin = 0; // cycle of its first word
        PushedBlock pushed = {};
        DeviceBlock block = {}; // what is known of it
        uint64_t end = 0;       // cycle of its last answer
    };
    /// A segment that the device has finished.
    struct Finished {
        uint32_t sequence = 0;
        uint64_t cycle = 0;
        hwsim::SearchCounts counts;
        DeviceTotals after;
    };

    DevicePipeline(hwsim::EmulatedDevice device, const core::Setup& setup)
        : device_(std::move(device)), setup_(&setup) {}

    void note(const hwsim::CoprocessorState& state);
    /// Goes on until every block is in the device.
    core::Result<void> settle();
    core::Result<void> ask(Pending& pending);
    /// Gives finished segments to their blocks, and blocks that have all of them to the list.
    void collect();
    bool is_answered(const Pending& pending) const;
    /// What the device said when it had permitted a block.
    static hwsim::DeviceReport permitted(const Pending& pending);
    /// The oldest block has its answer.
    void close(const hwsim::DeviceReport& report);
    /// The block that made the device stop is refused; those behind it are to be asked again.
    void take_stop();

    hwsim::EmulatedDevice device_;
    const core::Setup* setup_;
    std::optional<CoprocessorCheck> check_ = {};
    std::function<void(const BlocksInDevice&, const hwsim::CoprocessorState&)> on_cycle_ = {};
    std::deque<Pending> pending_ = {};
    std::vector<Finished> finished_ = {}; // and not given to their blocks
    std::vector<DeviceBlock> blocks_ = {};
    uint64_t last_end_ = 0;
};

} // namespace app
