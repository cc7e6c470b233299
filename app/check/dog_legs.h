#pragma once

#include <optional>

#include "core/sim/run/simulator.h"
#include "core/sim/setup.h"

namespace gcode {
struct Environment;
struct ControlParameter;
} // namespace gcode

namespace app {

struct DogLegResult;

/// The parameter that decides whether rapids are straight, if that matters: the control has one,
/// nothing states it, and the machine is not stated to run one way. Null otherwise.
const gcode::ControlParameter* open_rapid_parameter(const gcode::Environment& environment);

/// Runs the rapids of blocks as dog-legs, besides the straight ones that a check assumes.
class DogLegTrial {
public:
    explicit DogLegTrial(const core::Setup& setup);

    /// Runs a block up to its last rapid of two or more axes, from a copy of `before`. Empty if the
    /// block has none, if its path is not known anyway, or if the boxes of the bodies stay away
    /// from each other.
    ///
    /// Cost: that of the block and of a copy of the stock, for blocks with such a rapid near them.
    std::optional<core::BlockResult> run(const core::BlockEvents& block,
                                         const core::SimulatorState& before) const;

private:
    core::Setup setup_;
};

/// Compares a block whose rapids are dog-legs with the same block whose rapids are straight.
std::optional<DogLegResult> worse_than(const core::BlockResult& straight,
                                       const core::BlockResult& dog_leg);

} // namespace app
