#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/guard/live_motion.h"
#include "app/guard/motion_judge.h"
#include "core/base/result.h"
#include "core/sim/run/simulator.h"
#include "core/sim/setup.h"

namespace app {

/// Checks the motions of a running machine one by one, before they are made, against fixtures,
/// machine bodies and the stock as it is cut. Bodies, bounds and rules are those of a check of the
/// same motions in a program.
///
/// Motions are those of the ring (feeler_ring.h), in their order, as `kinematics` reads them.
class LiveCheck {
public:
    /// `speed_by_hand`: a spindle that is switched on turns even at a speed of 0.
    LiveCheck(const core::Setup& setup, ControlKinematics kinematics, bool speed_by_hand);

    LiveMotion read(const feeler_segment& motion) const { return kinematics_.read(motion); }

    /// Checks the next motion. It may move only if it is proven clear and breaks no rule. After one
    /// that may not, none may until the control has dropped it: what follows would start elsewhere.
    LiveAnswer judge(const LiveMotion& queued);

    /// As judge(), after a violation that the operator has not cleared: the motion may move if it
    /// loses no clearance, without cutting. All along it, no pair of bodies is nearer to each other
    /// than at its start, or at an earlier one since the violation, by more than 0.01 mm, unless it
    /// stays 10 mm apart and twice its allowance.
    /// Straight up, a tool that gets no narrower upwards may leave the stock in any case: a guard
    /// that was started anew does not know what was cut.
    LiveAnswer judge_retreat(const LiveMotion& queued);

    /// Whether the motions that the control has queued cannot move any more, after a refusal.
    bool is_refused() const { return is_refused_; }
    /// Judges nothing until the control has dropped its motions: one of them was refused before.
    void refuse_until_drop() { is_refused_ = true; }

    /// Called with each motion that was made, once it is known that it was. One that was stopped on
    /// its way ends where it was stopped.
    std::function<void(const LiveMotion&)> after_motion;

    /// Follows the cuts of motions before number `begun`, which have been made; at most `most` at a
    /// time. To be called when there is nothing to judge. Whether some are left.
    bool catch_up(uint64_t begun, size_t most);

private:
    struct Permitted {
        LiveMotion queued, checked;        // as the control has queued it, and with_corner()
        MotionJudge::Reached reached = {}; // by retreats up to its start
    };

    std::string begin(const LiveMotion& motion);
    core::Result<void> place(const LiveMotion& motion);
    void make(const Permitted& motion);
    void leave(const LiveMotion& part);
    void make_part(const LiveMotion& motion, const core::AxisValues& stopped_at);
    std::string objection(const LiveMotion& motion) const;
    std::vector<core::Event> events_of(const LiveMotion& motion,
                                       const core::SimulatorState& state) const;
    core::Motion line_of(const LiveMotion& motion, const core::AxisValues& from,
                         const core::AxisValues& to) const;
    void add_chords(const LiveMotion& motion, const core::ArcPath& arc,
                    std::vector<core::Event>& events) const;
    LiveMotion with_corner(LiveMotion motion);
    LiveAnswer permitted(const LiveMotion& queued, const LiveMotion& checked);
    LiveAnswer refused(LiveAnswer answer);

    MotionJudge judge_;
    ControlKinematics kinematics_;
    bool speed_by_hand_ = false;
    std::optional<core::SimulatorState> ahead_; // after all motions that may move
    std::optional<core::SimulatorState> made_;  // after those that have been made
    std::deque<Permitted> waiting_;             // what is in `ahead_` and not in `made_`
    bool is_refused_ = false;                   // until the control drops what it has queued
    bool follows_probe_ = false;                // the last motion was a probing move
};

} // namespace app
