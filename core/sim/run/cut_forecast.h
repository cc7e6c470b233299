#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/sim/run/simulator.h"

namespace core {

/// Tells from the events of the blocks to come with which moves the flutes will cut the stock,
/// without measuring anything. It knows feeds of an upright or tilted tool; it does not know what
/// follows from measuring: rapids that run into the stock, probing moves, motions of rotary axes.
class CutForecast {
public:
    /// From a state between two blocks on. The set-up must outlive this.
    CutForecast(const Setup& setup, const SimulatorState& state);
    ~CutForecast();
    CutForecast(const CutForecast&) = delete;
    CutForecast& operator=(const CutForecast&) = delete;

    /// Adds the moves of the next block. False if it has motions that cannot be foreseen; then the
    /// forecast is over.
    bool add(const BlockEvents& block, std::vector<CutterSweep>& moves);

private:
    bool add(const Motion& motion, BlockIndex block, std::vector<CutterSweep>& moves);
    void hold(std::optional<ToolNumber> tool);

    struct HeldTool;

    const Setup& setup_;
    SpindleChange spindle_;
    bool is_certain_; // where the machine is
    CheckMemory memory_;
    std::unique_ptr<HeldTool> held_; // none if the tool is unknown or has no flutes
};

} // namespace core
