#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "app/guard/live_check.h"

namespace app {

/// How long the permits of many motions took, to within a tenth.
class PermitTimes {
public:
    void add(double seconds);
    /// The time within which this share of them was given; 0 if there are none.
    double within(double share) const;

private:
    std::array<uint64_t, 192> counts_{}; // of each power of 1.1, from a tenth of a microsecond on
    uint64_t all_ = 0;
};

/// What feeler guard does with a ring: reads motions in order, checks them, and permits them.
///
/// After a refusal nothing more is permitted until the control drops its motions, as it does when
/// the operator aborts. Then only motions that lose no clearance are, until the violation is
/// cleared (feeler-tp.clear).
class Guard {
public:
    /// The ring must outlive the object. It is taken over where an earlier guard has left it: the
    /// motions that wait are checked. `unit`: mm per unit of the machine's lengths.
    /// `feed_tolerance`: with which feeds are blended where a program states none, mm.
    /// `kinematics`: with which motions are read and compared. `speed_by_hand`: as LiveCheck.
    Guard(const core::Setup& setup, feeler_ring& ring, double unit, double feed_tolerance,
          ControlKinematics kinematics, bool speed_by_hand = false);
    /// The planner's positions are those of the axes, and joints are not compared.
    Guard(const core::Setup& setup, feeler_ring& ring, double unit, double feed_tolerance)
        : Guard(setup, ring, unit, feed_tolerance, ControlKinematics(unit)) {}

    /// Why a motion may not be permitted now, such as a work offset that differs from the set-up;
    /// empty if there is no reason. The motion waits as long as there is one.
    std::function<std::string(const feeler_segment&)> objection;
    /// Whether the operator gives commands by MDI, so that lines of a program mean nothing to him.
    std::function<bool()> is_mdi;
    /// For the operator: what holds the machine, and that it is over.
    std::function<void(const std::string&)> tell;
    /// After each motion that was refused, in mm.
    std::function<void(const LiveMotion&, const LiveAnswer&)> after_refusal;
    /// After each motion that was made, in mm, as LiveCheck::after_motion.
    std::function<void(const LiveMotion&)> after_motion;

    /// Checks the next motion. False if there was none, or if none may be permitted now; then it
    /// has followed some of the cuts that were made.
    bool step();

    /// Whether a motion waits to be checked.
    bool has_motion() const { return feeler_load(&ring_.written) > ring_.read; }

    /// Whether another process has written to the guard's side of the ring. This one must end then.
    bool is_disturbed() const { return is_disturbed_; }

    /// How many motions were permitted and refused.
    uint64_t permitted() const { return permitted_; }
    uint64_t refused() const { return refused_; }
    /// CPU time of each check.
    const PermitTimes& times() const { return times_; }

private:
    void follow_operator();
    bool may_permit(const feeler_segment& motion);
    bool can_begin() const;
    void judge(const LiveMotion& motion);
    void permit(uint64_t number);

    feeler_ring& ring_;
    LiveCheck check_;
    bool is_latched_ = false;
    uint64_t cleared_ = 0, ended_ = 0;
    std::string reason_, told_; // why nothing is permitted now; and what the operator knows of it
    int64_t since_ = 0;         // milliseconds
    uint64_t told_at_drop_ = 0; // after this motion was dropped
    uint64_t session_ = 0, last_permit_ = 0;
    bool has_begun_ = false, is_disturbed_ = false;
    bool has_said_latch_ = false;
    bool waits_refused_ = false; // what an earlier guard has refused, and the operator not aborted
    uint64_t permitted_ = 0, refused_ = 0;
    PermitTimes times_;
};

/// Makes this process the guard of the ring. False if another one is that and still runs.
bool claim(feeler_ring& ring);

/// A text as messages of LinuxCNC, which hold 255 characters: divided at the ends of sentences, or
/// else between words.
std::vector<std::string> messages_of(const std::string& text);

/// Why a ring is of another kind than this program knows; empty if it is not.
std::string why_unknown(const feeler_ring& ring);

} // namespace app
