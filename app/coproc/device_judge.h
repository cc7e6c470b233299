#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/motion/event.h"

namespace core {
struct BlockResult;
struct CutModel;
struct Judgement;
struct Setup;
struct SimulatorState;
} // namespace core
namespace hwsim {
struct CoprocessorState;
struct DeviceConfig;
} // namespace hwsim

namespace app {

struct BlockPermit;
struct BlocksInDevice;
struct DeviceBlock;
struct DeviceTotals;

/// A coprocessor that judges the blocks of a check in place of the distance core. All questions and
/// answers pass through its registers and memory. Uses the functional model, which gives the
/// answers of the device without its timing. Refers to the set-up.
class DeviceJudge {
public:
    /// Loads the stock into a device.
    ///
    /// Errors: a stock that does not fit into its memory.
    static core::Result<DeviceJudge> with(const core::Setup& setup, const core::CutModel& stock);

    DeviceJudge(DeviceJudge&&) noexcept;
    DeviceJudge& operator=(DeviceJudge&&) noexcept;
    ~DeviceJudge();

    /// The device's answer for a block: each pair asked about, with a lower bound of the clearance,
    /// and a finding `refused` if the block is not fully permitted. `doubt`: why nothing can be
    /// proven about it, or empty.
    ///
    /// Errors: models that do not fit into the device.
    core::Result<core::Judgement> judge(std::span<const core::Event> block,
                                        const core::SimulatorState& before,
                                        const std::string& doubt);

private:
    struct State;
    explicit DeviceJudge(std::unique_ptr<State> state);

    std::unique_ptr<State> state_;
};

/// An emulated device that receives the blocks of a program in order, as far ahead of the answers
/// as its FIFO allows. A refused block stops the device; the blocks after it are asked again, as if
/// an operator had let the machine continue. Refers to the set-up.
class DevicePipeline {
public:
    /// Loads the stock into a device. Calls `on_cycle`, if given, after each cycle. With
    /// `on_circuit`, the circuit answers, and the emulated device is held against it.
    ///
    /// Errors: an invalid device configuration; a stock that does not fit; those of
    ///         port_with_circuit().
    static core::Result<std::unique_ptr<DevicePipeline>>
    with(const hwsim::DeviceConfig& config, const core::Setup& setup, const core::CutModel& stock,
         std::function<void(const BlocksInDevice&, const hwsim::CoprocessorState&)> on_cycle = {},
         bool on_circuit = false);

    ~DevicePipeline();

    /// Asks about the next block as soon as there is room for it. `doubt`: why nothing can be
    /// proven about it, or empty.
    ///
    /// Errors: models that do not fit into the device.
    core::Result<void> push(std::span<const core::Event> block, const core::SimulatorState& before,
                            const std::string& doubt);

    /// Waits until all blocks are answered.
    ///
    /// Errors: those of push(); the circuit has differed from the emulated device.
    core::Result<void> finish();

    /// The answered blocks, in order.
    const std::vector<DeviceBlock>& blocks() const;
    DeviceTotals totals();

private:
    struct State;
    explicit DevicePipeline(std::unique_ptr<State> state);

    std::unique_ptr<State> state_;
};

/// Agreement of a coprocessor with the exact engine, in blocks.
struct EngineAgreement {
    size_t blocks = 0;
    size_t violations = 0;   // violations and collisions by the exact engine
    size_t refused = 0;      // by the device
    size_t not_queried = 0;  // of these, blocks that the device cannot check
    size_t missed = 0;       // violations that the device permitted
    size_t unproven = 0;     // permitted, and undecided by the exact engine
    size_t undecided = 0;    // refused, and undecided by the exact engine
    size_t false_alarms = 0; // refused, and clear by the exact engine

    bool operator==(const EngineAgreement&) const = default;
};

/// Adds a block.
void add(EngineAgreement& agreement, const BlockPermit& permit, const core::BlockResult& exact);

} // namespace app
