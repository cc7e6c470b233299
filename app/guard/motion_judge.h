#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/motion/event.h"
#include "core/sim/block_result.h"
#include "core/sim/run/simulator.h"
#include "core/sim/setup.h"

namespace app {

/// What is said about a motion of a running machine.
struct LiveAnswer {
    bool may_move = false;
    std::string reason = {}; // why it may not: one or two sentences for the operator
    std::string cure = {};   // how to go on; may be empty
};

/// Whether all motions of a block move Z upwards and nothing else, or nothing at all.
bool goes_straight_up(const std::vector<core::Event>& events);

/// Brings a run to a place without a motion.
void put_at(core::SimulatorState& state, const core::AxisPosition& position);

/// Judges what a running machine is about to do, given as the events of a block. Bodies, bounds and
/// rules are those of a check of the same events in a program. Each function brings the state to
/// the end of the events.
class MotionJudge {
public:
    /// Corners are rounded as the events say, and not as the set-up's machine does it.
    explicit MotionJudge(const core::Setup& setup);

    const core::Setup& setup() const { return setup_; }

    /// Follows the cuts of events that have been made, without measuring.
    void follow(const std::vector<core::Event>& events, core::SimulatorState& state);

    /// The events may be made only if they are proven clear and break no rule.
    LiveAnswer judge(const std::vector<core::Event>& events, core::SimulatorState& state);

    /// As judge, with each tool of the set-up in turn, where it is not known which one is in the
    /// spindle. Leaves the state as it is.
    LiveAnswer judge_with_each_tool(std::vector<core::Event> events,
                                    const core::SimulatorState& state);

    /// What is wrong with probing motions if the work is not where it should be: all but the flutes
    /// must be clear on the whole way, and the flutes of all but the stock. Empty if nothing is.
    /// Leaves the state as it is.
    std::string problem_beyond_contact(std::vector<core::Event> events, core::SimulatorState state);

    /// The largest lower bounds of pairs at rest since begin_retreat.
    using Reached = std::vector<std::pair<core::Pair, double>>;
    const Reached& reached() const { return reached_; }
    /// Goes back to what was reached before.
    void return_to(Reached reached) { reached_ = std::move(reached); }
    /// Forgets the clearances that retreats have reached.
    void begin_retreat() { reached_.clear(); }
    /// Events may be made that lose no clearance, without cutting: all along them, no pair of
    /// bodies is nearer to each other than it has been at rest since begin_retreat, by more than
    /// 0.01 mm and `rounding`, unless it stays 10 mm apart and twice its allowance. Straight up
    /// a tool that gets no narrower upwards may leave the stock in any case: nobody may know
    /// what was cut.
    LiveAnswer judge_retreat(std::vector<core::Event> events, double rounding,
                             core::SimulatorState& state);

private:
    core::BlockResult run(const core::Setup& setup, const std::vector<core::Event>& events,
                          core::SimulatorState& state, bool measures);

    core::Setup setup_;    // measures only what a verdict needs
    core::Setup thorough_; // measures every pair
    uint32_t block_ = 0;
    Reached reached_;
};

} // namespace app
