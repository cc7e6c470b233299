#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/guard/control_state.h"
#include "app/guard/guard.h"
#include "app/guard/motion_log.h"
#include "app/setup/program_settings.h"
#include "app/setup/setup_file.h"
#include "core/base/file_reads.h"
#include "tests/app/checked.h"
#include "tests/support/scoped_folder.h"

namespace app_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// A block of aluminium of 100 x 60 x 20 in the middle of G54, a clamp beside it, an end mill of
/// 10 mm that is 100 mm long. G54 is 200 below the gauge line at home, so the tip is at machine
/// Z-100 at home and at Z100 of G54.
const std::string setup_text = R"(mesh_size = 0.5
[program]
dialect = "linuxcnc"
start = { X = 0, Y = 0, Z = 0 }
[[machine.axis]]
name = "X"
kind = "linear"
side = "tool"
parent = "base"
direction = [1, 0, 0]
rapid = 6000
acceleration = 1000
[[machine.axis]]
name = "Y"
kind = "linear"
side = "tool"
parent = "X"
direction = [0, 1, 0]
rapid = 6000
acceleration = 1000
[[machine.axis]]
name = "Z"
kind = "linear"
side = "tool"
parent = "Y"
direction = [0, 0, 1]
rapid = 6000
acceleration = 1000
[offsets]
G54 = { X = 0, Y = 0, Z = -200 }
[stock]
box = [[-50, -30, -20], [50, 30, 0]]
[[fixture]]
name = "clamp"
box = [[60, -40, -20], [80, 40, 30]]
[[tool]]
number = 1
shape = "flat"
diameter = 10
flute_length = 30
stick_out = 100
[[tool]]
number = 2
shape = "flat"
diameter = 6
flute_length = 20
stick_out = 60
)";

constexpr double tip = 100.0 - 200.0; // machine Z of the gauge line when tool 1 is at Z0 of G54

app::SetupFile setup_of(const std::string& text) {
    auto setup = app::read_setup_text(text, "mill.toml", {});
    if (!setup) throw std::runtime_error(setup.error().message);
    return *std::move(setup);
}

/// Plays LinuxCNC's part in a ring: numbers motions, moves as far as it is permitted, and stops.
class Machine {
public:
    Machine() {
        ring->magic = FEELER_RING_MAGIC;
        ring->version = FEELER_RING_VERSION;
        ring->bytes = sizeof *ring;
        ring->segments = FEELER_RING_SEGMENTS;
        ring->session = 0x1234;
        ring->permitted = feeler_permit(ring->session, 0);
        next.tool = 1;
        next.turns_on = 1;
        next.speed = 1000.0;
        next.blending = FEELER_EXACT_STOP;
        next.feed = 10.0;
        next.most_speed = 10.0; // of the machine's limits
    }

    /// Queues a line to X, Y and Z of the tip of tool 1 in G54.
    uint64_t line(double x, double y, double z, uint32_t purpose = FEELER_FEED) {
        feeler_segment motion = next;
        motion.shape = FEELER_LINE;
        motion.purpose = purpose;
        motion.to[0] = x, motion.to[1] = y, motion.to[2] = z + tip;
        return queue(motion);
    }
    uint64_t rapid(double x, double y, double z) { return line(x, y, z, FEELER_RAPID); }

    uint64_t queue(feeler_segment motion) {
        const uint64_t number = ring->written + 1;
        motion.number = number;
        motion.follows = follows.value_or(number - 1);
        motion.follows_part = follows_part ? 1 : 0;
        std::copy(std::begin(stopped_at), std::end(stopped_at), std::begin(motion.stopped_at));
        std::copy(std::begin(goal), std::end(goal), std::begin(motion.from));
        if (motion.acceleration == 0.0) motion.acceleration = acceleration_of(motion);
        motion.line = static_cast<int32_t>(number);
        if (std::exchange(was_jogged, false)) motion.from_rest = 1;
        if (ask_kinematics) ask_kinematics(motion);
        ring->segment[number % FEELER_RING_SEGMENTS] = motion;
        if (motion.shape != FEELER_TAP)
            std::copy(std::begin(motion.to), std::end(motion.to), std::begin(goal));
        follows.reset();
        follows_part = false;
        feeler_store(&ring->written, number);
        return number;
    }

    /// Along a straight line: as far as all axes can.
    double acceleration_of(const feeler_segment& motion) const {
        double length = 0.0, longest = 0.0;
        for (size_t i = 0; i < 3; ++i) {
            const double way = std::abs(motion.to[i] - motion.from[i]);
            length = std::hypot(length, way);
            longest = std::max(longest, way);
        }
        return longest > 0.0 ? most_acceleration * length / longest : most_acceleration;
    }

    uint64_t permitted() const {
        EXPECT_EQ(ring->permitted >> FEELER_NUMBER_BITS, ring->session);
        return feeler_permitted_number(ring->permitted);
    }

    /// Makes all motions that are permitted.
    void move() {
        ring->released = std::min(permitted(), ring->written);
        ring->made = ring->released;
    }

    /// The operator aborts while motion `during` is on its way at a place of the tip.
    void abort(uint64_t during, double x, double y, double z) {
        ring->released = std::min(permitted(), ring->written);
        ring->made = during - 1;
        ring->dropped = ring->written;
        follows = during;
        follows_part = true;
        const double at[] = {x, y, z + tip};
        std::copy(std::begin(at), std::end(at), std::begin(stopped_at));
        std::copy(std::begin(stopped_at), std::end(stopped_at), std::begin(goal));
    }

    /// The operator aborts while the machine waits for a permit.
    void abort_at_rest() {
        move();
        ring->dropped = ring->written;
        follows = ring->released;
        const feeler_segment& last = ring->segment[ring->released % FEELER_RING_SEGMENTS];
        std::copy(std::begin(last.to), std::end(last.to), std::begin(goal));
    }

    /// The machine is moved by hand, to a place of the tip.
    void jog(double x, double y, double z) {
        goal[0] = x, goal[1] = y, goal[2] = z + tip;
        was_jogged = true;
    }

    std::unique_ptr<feeler_ring> ring = std::make_unique<feeler_ring>();
    feeler_segment next{};             // what the next motion has besides its path
    double most_acceleration = 1000.0; // of each axis
    std::function<void(feeler_segment&)> ask_kinematics;
    double goal[9] = {};
    double stopped_at[9] = {};
    std::optional<uint64_t> follows;
    bool follows_part = false, was_jogged = false;
};

class GuardedMachine : public ::testing::Test {
protected:
    GuardedMachine() { listen(guard_); }

    void listen(app::Guard& guard) {
        guard.tell = [this](const std::string& text) { told_.push_back(text); };
        guard.after_motion = [this](const feeler_segment& motion) { made_.push_back(motion); };
    }
    void check_all(app::Guard& guard) {
        while (guard.has_motion() && guard.step()) {
        }
    }
    uint64_t permitted() {
        check_all(guard_);
        return machine_.permitted();
    }
    void catch_up() {
        for (int i = 0; i < 100; ++i) guard_.step();
    }

    app::SetupFile setup_ = setup_of(setup_text);
    Machine machine_;
    app::Guard guard_{setup_.setup, *machine_.ring, 1.0, 0.1};
    std::vector<std::string> told_;
    std::vector<feeler_segment> made_;
};

TEST_F(GuardedMachine, PermitsWhatIsClear) {
    machine_.rapid(-60, 0, 30);
    machine_.line(-60, 0, -2);
    const uint64_t last = machine_.line(40, 0, -2);
    EXPECT_EQ(permitted(), last);
    EXPECT_TRUE(told_.empty());
    EXPECT_EQ(machine_.ring->read, last);
}

TEST_F(GuardedMachine, PermitsNothingFromAViolationOn) {
    machine_.rapid(-60, 0, 30);
    const uint64_t safe = machine_.rapid(50, 0, 20);
    machine_.rapid(54, 0, 20); // 1 mm from the clamp, whose minimum is 2
    machine_.rapid(-60, 0, 20);
    EXPECT_EQ(permitted(), safe);
    ASSERT_EQ(told_.size(), 1U);
    EXPECT_THAT(told_[0], AllOf(HasSubstr("line 3"), HasSubstr("clamp"),
                                EndsWith("Abort the program, then clear the violation to go on.")));
    EXPECT_EQ(machine_.ring->latched, 1U);
    EXPECT_EQ(machine_.ring->read, 4U); // so the ring does not fill up
}

/// The clearance of 2 mm itself is enough, as in a check.
TEST_F(GuardedMachine, PermitsTheMinimumClearance) {
    machine_.rapid(0, 0, 30);
    const uint64_t last = machine_.rapid(53, 0, 20);
    EXPECT_EQ(permitted(), last);
}

TEST_F(GuardedMachine, TakesOnlyWhatWasMadeForCut) {
    machine_.rapid(-60, 0, 30);
    machine_.rapid(-60, 0, -5);
    const uint64_t cut = machine_.line(54, 0, -5);
    machine_.rapid(54, 0, 5);
    machine_.rapid(54, 0, -5);
    EXPECT_EQ(permitted(), cut - 1); // it would be too near to the clamp
    machine_.abort_at_rest();

    machine_.ring->cleared = 1;
    const uint64_t again = machine_.line(40, 0, -5);
    EXPECT_EQ(permitted(), again);
    machine_.abort(again, 0, 0, -5);
    const uint64_t back = machine_.rapid(-60, 0, -5); // along what was cut
    EXPECT_EQ(permitted(), back);
    machine_.move();
    machine_.rapid(5, 0, -5); // the flutes reach to X10, and material begins at X5
    EXPECT_EQ(permitted(), back);
    ASSERT_FALSE(told_.empty());
    EXPECT_THAT(told_.back(), HasSubstr("stock"));
}

/// Motions that were permitted ahead of an abort are not taken for made, whatever was refused
/// behind them.
TEST_F(GuardedMachine, ForgetsWhatWasPermittedAndNotMade) {
    const uint64_t first = machine_.rapid(-60, 0, 30);
    machine_.rapid(-60, 0, -5);
    const uint64_t cut = machine_.line(50, 0, -5);
    machine_.rapid(58, 0, -5); // into the clamp
    machine_.rapid(-60, 0, -5);
    EXPECT_EQ(permitted(), cut);
    machine_.ring->released = cut;
    machine_.ring->made = first;
    catch_up();
    machine_.abort(first + 1, -60, 0, 10);
    machine_.ring->cleared = 1;

    const uint64_t down = machine_.rapid(-60, 0, -5);
    EXPECT_EQ(permitted(), down);
    machine_.move();
    machine_.rapid(50, 0, -5); // through the stock, which was not cut
    EXPECT_EQ(permitted(), down);
    EXPECT_THAT(told_.back(), HasSubstr("stock"));
    catch_up();
    ASSERT_EQ(made_.size(), 3U); // two whole ones, and the second one up to Z10 before that
    EXPECT_DOUBLE_EQ(made_[1].to[2], 10 + tip);
}

/// What waits must begin where the motion before it ends.
TEST_F(GuardedMachine, RefusesAMotionThatBeginsElsewhere) {
    machine_.rapid(-60, 0, 30);
    machine_.goal[1] += 0.1;
    machine_.rapid(-60, 10, 30);
    EXPECT_EQ(permitted(), 1U);
    EXPECT_THAT(told_.back(), HasSubstr("does not begin where"));
}

TEST_F(GuardedMachine, FollowsMotionsByHand) {
    machine_.rapid(-60, 0, 30);
    EXPECT_EQ(permitted(), 1U);
    machine_.move();
    machine_.jog(50, 0, 20);
    const uint64_t back = machine_.rapid(-60, 0, 20);
    EXPECT_EQ(permitted(), back);
    machine_.move();
    machine_.jog(55, 0, 20); // through the minimum clearance of the clamp
    machine_.rapid(56, 0, 20);
    EXPECT_EQ(permitted(), back);
}

TEST_F(GuardedMachine, AllowsOnlyRetreatsAfterAViolation) {
    machine_.rapid(0, 0, 30);
    machine_.rapid(54.5, 0, 20);
    EXPECT_EQ(permitted(), 1U);
    machine_.abort_at_rest();
    machine_.jog(54.5, 0, 20); // by hand into the minimum clearance
    const uint64_t away = machine_.rapid(50, 0, 20);
    EXPECT_EQ(permitted(), away);
    machine_.move();
    machine_.rapid(52, 0, 20); // clear, but nearer
    EXPECT_EQ(permitted(), away);
    EXPECT_THAT(told_.back(), HasSubstr("clamp"));
    machine_.abort_at_rest();

    feeler_store(&machine_.ring->cleared, uint64_t{1});
    const uint64_t nearer = machine_.rapid(52, 0, 20);
    EXPECT_EQ(permitted(), nearer);
    EXPECT_EQ(machine_.ring->latched, 0U);
}

TEST_F(GuardedMachine, SaysThatWhatWaitsMustBeAborted) {
    machine_.rapid(0, 0, 30);
    machine_.rapid(54.5, 0, 20);
    EXPECT_EQ(permitted(), 1U);
    feeler_store(&machine_.ring->cleared, uint64_t{1});
    guard_.step();
    EXPECT_THAT(told_.back(), HasSubstr("Abort the program"));
    machine_.rapid(0, 0, 40);
    EXPECT_EQ(permitted(), 1U);
}

/// A wide tolerance of the path is no leave to come nearer.
TEST_F(GuardedMachine, LosesNoClearanceOnRetreatByRoundedCorners) {
    machine_.rapid(0, 0, 30);
    machine_.rapid(54.5, 0, 20);
    EXPECT_EQ(permitted(), 1U);
    machine_.abort_at_rest();
    machine_.jog(46, 0, 20); // 9 mm from the clamp
    machine_.next.blending = FEELER_BLENDED;
    machine_.next.tolerance = 8.0;
    machine_.rapid(50, 0, 20);
    EXPECT_EQ(permitted(), 1U);
    EXPECT_THAT(told_.back(), HasSubstr("nearer"));
    machine_.abort_at_rest();
    machine_.next.tolerance = 0.1;
    const uint64_t away = machine_.rapid(30, 0, 20);
    EXPECT_EQ(permitted(), away);
}

TEST_F(GuardedMachine, MayComeNearerOnRetreatToWhatIsFar) {
    machine_.rapid(0, 0, 30);
    machine_.rapid(54.5, 0, 20);
    EXPECT_EQ(permitted(), 1U);
    machine_.abort_at_rest();
    const uint64_t far = machine_.rapid(44, 0, 20); // 11 mm from the clamp
    EXPECT_EQ(permitted(), far);
    machine_.move();
    machine_.rapid(46, 0, 20); // 9 mm
    EXPECT_EQ(permitted(), far);
}

/// Rules that are about no pair of bodies hold on retreat, too.
TEST(GuardedSetups, KeepAxesWithinTheirLimits) {
    std::string text = setup_text;
    text.replace(text.find("direction = [1, 0, 0]"), 21,
                 "direction = [1, 0, 0]\nmin = -300\nmax = 300");
    const app::SetupFile setup = setup_of(text);
    Machine machine;
    app::Guard guard(setup.setup, *machine.ring, 1.0, 0.1);
    machine.rapid(0, 0, 70);
    machine.rapid(400, 0, 70);
    while (guard.has_motion() && guard.step()) {
    }
    EXPECT_EQ(machine.permitted(), 1U);
    machine.abort_at_rest();
    machine.rapid(400, 0, 70);
    while (guard.has_motion() && guard.step()) {
    }
    EXPECT_EQ(machine.permitted(), 1U);
}

/// How LinuxCNC rounds corners is not what the set-up says.
TEST(GuardedSetups, CannotChangeHowCornersAreRounded) {
    std::string text = setup_text;
    text.insert(text.find("[[machine.axis]]"), "[machine]\nrapid_corner_tolerance = 0\n");
    const app::SetupFile setup = setup_of(text);
    const std::map<double, uint64_t> last = {{0.0, 2}, {0.1, 3}, {5.0, 2}}; // by the tolerance
    for (const auto& [tolerance, permitted] : last) {
        Machine machine;
        app::Guard guard(setup.setup, *machine.ring, 1.0, 0.1);
        machine.next.blending = FEELER_BLENDED;
        machine.next.tolerance = tolerance;
        machine.rapid(40, 48, 20);
        machine.rapid(88, 48, 20);
        machine.rapid(88, -50, 20); // 8 mm around the clamp, unless the corner is cut
        while (guard.has_motion() && guard.step()) {
        }
        EXPECT_EQ(machine.permitted(), permitted) << tolerance;
    }
}

TEST(GuardedSetups, MayAskForLargeClearances) {
    const app::SetupFile setup = setup_of("allowance = 60\n" + setup_text);
    Machine machine;
    app::Guard guard(setup.setup, *machine.ring, 1.0, 0.1);
    machine.next.turns_on = 0;
    machine.rapid(0, 0, 95);
    machine.rapid(0, 0, 85); // 55 above the clamp, and beside it
    machine.rapid(70, 0, 85);
    while (guard.has_motion() && guard.step()) {
    }
    EXPECT_EQ(machine.permitted(), 2U);
}

/// A helix passes the clamp as often as it turns.
TEST_F(GuardedMachine, CountsTheTurnsOfAHelix) {
    const auto helix = [&](int turns) {
        feeler_segment arc = machine_.next;
        arc.shape = FEELER_ARC;
        arc.purpose = FEELER_CURVE;
        arc.normal[2] = 1.0;
        arc.turns = turns - 1;
        arc.centre[0] = 44.0;
        arc.to[0] = 34.0, arc.to[2] = 10 + tip;
        return machine_.queue(arc);
    };
    machine_.rapid(34, 0, 60);
    const uint64_t one = helix(1); // passes X54 at Z35
    EXPECT_EQ(permitted(), one);
    machine_.move();
    const uint64_t up = machine_.rapid(34, 0, 60);
    helix(3); // at Z51, Z35 and Z18
    EXPECT_EQ(permitted(), up);
}

/// Where an abort ended a motion beside its path, it is not known what was cut.
TEST_F(GuardedMachine, TakesLessForCutWhereThePathWasLeft) {
    for (const double beside : {0.0, 1.0}) {
        Machine machine;
        app::Guard guard(setup_.setup, *machine.ring, 1.0, 0.1);
        machine.rapid(-60, 0, 30);
        machine.rapid(-60, 0, -5);
        const uint64_t cut = machine.line(40, 0, -5);
        check_all(guard);
        ASSERT_EQ(machine.permitted(), cut);
        machine.abort(cut, 0, beside, -5);
        const uint64_t back = machine.rapid(-60, 0, -5); // straight back
        check_all(guard);
        EXPECT_EQ(machine.permitted(), beside == 0.0 ? back : cut);
    }
}

TEST_F(GuardedMachine, TakesNothingForCutOfTurnsThatAreNotKnown) {
    machine_.rapid(20, 0, 30);
    machine_.line(20, 0, -5);
    feeler_segment arc = machine_.next;
    arc.shape = FEELER_ARC;
    arc.purpose = FEELER_CURVE;
    arc.normal[2] = 1.0;
    arc.turns = 2;
    arc.centre[2] = -5 + tip;
    arc.to[0] = 20.0, arc.to[2] = -8 + tip;
    const uint64_t helix = machine_.queue(arc);
    EXPECT_EQ(permitted(), helix);
    machine_.abort(helix, 0, 20, -6);
    machine_.jog(0, 20, 5);
    machine_.rapid(0, 20, -4.9);
    EXPECT_EQ(permitted(), helix);
}

TEST_F(GuardedMachine, NeverRetreatsIntoACollision) {
    machine_.rapid(0, 0, 30);
    machine_.rapid(60, 0, 20);
    EXPECT_EQ(permitted(), 1U);
    machine_.abort_at_rest();
    machine_.jog(58, 0, 20); // the flutes are in the clamp
    machine_.rapid(70, 0, 20);
    EXPECT_EQ(permitted(), 1U);
    machine_.abort_at_rest();
    machine_.jog(58, 0, 20);
    machine_.rapid(58, 0, 60);
    EXPECT_EQ(permitted(), 1U);
}

TEST_F(GuardedMachine, RefusesWhatItCannotCheck) {
    const auto refusal_of = [&](const std::function<void(feeler_segment&)>& change) {
        feeler_segment motion = machine_.next;
        motion.shape = FEELER_LINE;
        motion.purpose = FEELER_RAPID;
        motion.to[0] = 10.0;
        change(motion);
        machine_.queue(motion);
        const uint64_t before = machine_.permitted();
        EXPECT_EQ(permitted(), before);
        machine_.abort_at_rest();
        ++machine_.ring->cleared;
        guard_.step();
        told_.erase(std::remove(told_.begin(), told_.end(), "Feeler: the violation is cleared."),
                    told_.end());
        return told_.empty() ? std::string() : told_.back();
    };
    EXPECT_THAT(refusal_of([](auto& motion) { motion.tool = -1; }), HasSubstr("tool-number"));
    EXPECT_THAT(refusal_of([](auto& motion) { motion.tool = 7; }), HasSubstr("tool 7"));
    EXPECT_THAT(refusal_of([](auto& motion) { motion.to[3] = 1.0; }), HasSubstr("Axis A"));
    for (const auto& change : std::vector<std::function<void(feeler_segment&)>>{
             [](auto& motion) { motion.centre[0] = std::numeric_limits<double>::quiet_NaN(); },
             [](auto& motion) { motion.normal[2] = std::numeric_limits<double>::infinity(); },
             [](auto& motion) { motion.feed = std::numeric_limits<double>::infinity(); },
             [](auto& motion) { motion.tolerance = std::numeric_limits<double>::quiet_NaN(); }})
        EXPECT_THAT(refusal_of(change), HasSubstr("not a number"));
    EXPECT_THAT(refusal_of([](auto& motion) { motion.shape = 0; }), HasSubstr("kind"));
    EXPECT_THAT(refusal_of([](auto& motion) { motion.purpose = 8; }), HasSubstr("kind"));
    EXPECT_THAT(
        refusal_of([](auto& motion) { motion.to[1] = std::numeric_limits<double>::quiet_NaN(); }),
        HasSubstr("not a number"));
    EXPECT_THAT(refusal_of([](auto& motion) {
                    motion.shape = FEELER_ARC;
                    motion.normal[1] = motion.normal[2] = 1.0;
                }),
                HasSubstr("main plane"));
}

TEST_F(GuardedMachine, RefusesAFeedWithoutTheSpindle) {
    machine_.rapid(-60, 0, 30);
    machine_.rapid(-60, 0, -2);
    machine_.next.turns_on = 0;
    machine_.next.speed = 0.0;
    machine_.line(0, 0, -2);
    EXPECT_EQ(permitted(), 2U);
    EXPECT_THAT(told_.back(), HasSubstr("spindle"));
}

/// A corner that the control may round is measured with what it may round off.
TEST_F(GuardedMachine, CountsRoundedCorners) {
    machine_.next.blending = FEELER_BLENDED;
    machine_.next.tolerance = 1.0;
    machine_.rapid(0, 0, 30);
    machine_.line(0, 0, 20);
    machine_.line(52.5, 0, 20); // 2.5 from the clamp, or 1.5
    EXPECT_EQ(permitted(), 2U);
    machine_.abort_at_rest();
    machine_.ring->cleared = 1;
    machine_.next.tolerance = 0.1;
    const uint64_t last = machine_.line(52.5, 0, 20);
    EXPECT_EQ(permitted(), last);
    machine_.move();
    EXPECT_EQ(machine_.ring->feed_tolerance, 0.1); // for what states none
    machine_.next.tolerance = 0.0;
    machine_.line(52.5, 5, 20);
    EXPECT_EQ(permitted(), last);
    EXPECT_THAT(told_.back(), HasSubstr("rounded"));
}

/// A corner between rapids is not rounded if the machine rests there.
TEST_F(GuardedMachine, KnowsWhereTheMachineRests) {
    for (const uint32_t from_rest : {0U, 1U}) {
        Machine machine;
        app::Guard guard(setup_.setup, *machine.ring, 1.0, 0.1);
        machine.next.blending = FEELER_BLENDED;
        machine.rapid(40, 48, 20);
        machine.rapid(88, 48, 20);
        machine.next.from_rest = from_rest;
        machine.rapid(88, -50, 20); // 8 mm around the clamp, unless the corner is cut
        check_all(guard);
        EXPECT_EQ(machine.permitted(), 2U + from_rest);
    }
}

TEST_F(GuardedMachine, SaysWhereItStopsAndThatItStillDoes) {
    const uint64_t last = machine_.rapid(0, 0, 30);
    machine_.line(70, 0, 5, FEELER_TOOL_CHANGE);
    EXPECT_EQ(permitted(), last);
    EXPECT_THAT(told_.back(), HasSubstr("before the way to the tool change, after line 2: "));
    ASSERT_EQ(machine_.ring->latched, 1U);
    app::Guard next(setup_.setup, *machine_.ring, 1.0, 0.1);
    listen(next);
    told_.clear();
    next.step();
    next.step();
    ASSERT_EQ(told_.size(), 1U);
    EXPECT_THAT(told_[0], HasSubstr("an earlier violation is not cleared yet"));
}

/// LinuxCNC leaves a corner by more than its tolerance if it brakes less than it then accelerates.
TEST_F(GuardedMachine, RoundsCornersMoreWhereAccelerationsDiffer) {
    struct Limits {
        double acceleration, within; // of Z, mm/s2; the deviation, as a multiple of the tolerance
    };
    for (const Limits& limits : {Limits{1000.0, 1.843}, {200.0, 2.687}, {5.0, 3.884}})
        for (const double gap : {limits.within - 0.01, limits.within + 0.01}) {
            Machine machine;
            core::Setup setup = setup_.setup;
            for (size_t i = 0; i < 3; ++i)
                setup.machine.axes[i].acceleration = i == 2 ? limits.acceleration : 1000.0;
            app::Guard guard(setup, *machine.ring, 1.0, 0.1);
            machine.rapid(0, 0, 30);
            machine.line(0, 0, 20);
            machine.next.blending = FEELER_BLENDED;
            machine.next.tolerance = 0.5;
            machine.next.acceleration = 1000.0;
            machine.line(55.0 - 2.0 - 0.5 * gap, 0, 20); // 2 from the clamp, and the corner
            check_all(guard);
            EXPECT_EQ(machine.permitted(), gap > limits.within ? 3U : 2U)
                << limits.acceleration << " " << gap;
        }
}

/// LinuxCNC decides by the distance of the ends whether an arc is a full circle.
TEST_F(GuardedMachine, TakesAnArcForAFullCircleOnlyIfItsEndsMeet) {
    for (const double gap : {0.0, 1e-7, 1e-5, -1e-5}) {
        Machine machine;
        app::Guard guard(setup_.setup, *machine.ring, 1.0, 0.1);
        machine.rapid(20, 0, 5);
        machine.line(20, 0, -3);
        feeler_segment arc = machine.next;
        arc.shape = FEELER_ARC;
        arc.purpose = FEELER_CURVE;
        arc.normal[2] = 1.0;
        std::copy(std::begin(machine.goal), std::end(machine.goal), std::begin(arc.to));
        arc.to[1] += gap;
        arc.centre[2] = arc.to[2];
        machine.queue(arc);
        machine.line(20, gap, 5);
        machine.rapid(-20, 0, 5);
        machine.rapid(-20, 0, -3); // where only a full circle has cut
        check_all(guard);
        const bool is_full = gap <= 0.0; // or nearly
        EXPECT_EQ(machine.permitted(), gap == 1e-7 ? 2U : is_full ? 6U : 5U) << gap;
    }
}

/// Pins of LinuxCNC change its limits while it runs.
TEST_F(GuardedMachine, RefusesRapidsWithOtherLimitsThanItKnows) {
    const core::MachineAxis& axis = setup_.setup.machine.axes[0];
    ASSERT_TRUE(axis.acceleration && axis.rapid);
    struct Limits {
        double acceleration, speed;
        bool is_permitted;
    };
    for (const Limits& limits :
         {Limits{1.0, 1.0, true}, {0.98, 1.0, false}, {1.02, 1.0, false}, {1.0, 1.02, false}}) {
        Machine machine;
        app::Guard guard(setup_.setup, *machine.ring, 1.0, 0.1);
        machine.next.blending = FEELER_BLENDED;
        machine.rapid(0, 0, 50);
        machine.next.acceleration = limits.acceleration * *axis.acceleration;
        machine.next.most_speed = limits.speed * *axis.rapid / 60.0;
        machine.rapid(20, 0, 50);
        check_all(guard);
        EXPECT_EQ(machine.permitted(), limits.is_permitted ? 2U : 1U);
    }
}

TEST_F(GuardedMachine, RefusesFeedsWithOtherAccelerationsThanItKnows) {
    for (const double factor : {1.0, 0.9, 1.1}) {
        Machine machine;
        app::Guard guard(setup_.setup, *machine.ring, 1.0, 0.1);
        machine.rapid(0, 0, 50);
        machine.next.blending = FEELER_BLENDED;
        machine.next.tolerance = 0.02;
        machine.next.acceleration = factor * *setup_.setup.machine.axes[0].acceleration;
        machine.line(20, 0, 50);
        check_all(guard);
        EXPECT_EQ(machine.permitted(), factor == 1.0 ? 2U : 1U) << factor;
    }
}

/// The control does not know what is in the spindle when it starts.
TEST_F(GuardedMachine, TrustsNoEmptySpindle) {
    machine_.next.tool = 0;
    machine_.next.turns_on = 0;
    machine_.rapid(0, 0, 30);
    const uint64_t clear = machine_.rapid(50, 0, 20);
    machine_.rapid(54, 0, 20); // too near to the clamp, if it is tool 1
    EXPECT_EQ(permitted(), clear);
    EXPECT_THAT(told_.back(), HasSubstr("clamp"));
    machine_.abort_at_rest();
    machine_.ring->cleared = 1;
    machine_.line(0, 0, 20);
    EXPECT_EQ(permitted(), clear);
    EXPECT_THAT(told_.back(), HasSubstr("M61"));
}

/// What is known of the distances of one tool does not hold for another.
TEST_F(GuardedMachine, TrustsNoEmptySpindleAfterAKnownTool) {
    machine_.next.tool = 2;
    machine_.rapid(0, 0, 50);
    const uint64_t over = machine_.rapid(70, 0, 0); // tip of tool 2: 10 mm above the clamp
    EXPECT_EQ(permitted(), over);
    machine_.move();
    machine_.next.tool = 0;
    machine_.rapid(70, 0.5, 0); // tool 1 would be in it
    EXPECT_EQ(permitted(), over);
}

/// A stop near the start of a full circle may be one near its end.
TEST_F(GuardedMachine, TakesNoFullCircleForCutThatWasHardlyBegun) {
    for (const double beside : {0.0, -0.02, 0.02}) {
        Machine machine;
        app::Guard guard(setup_.setup, *machine.ring, 1.0, 0.1);
        machine.rapid(20, 0, 30);
        machine.line(20, 0, -5);
        feeler_segment arc = machine.next;
        arc.shape = FEELER_ARC;
        arc.purpose = FEELER_CURVE;
        arc.normal[2] = 1.0;
        arc.centre[2] = -5 + tip;
        arc.to[0] = 20.0, arc.to[2] = -5 + tip;
        const uint64_t circle = machine.queue(arc);
        check_all(guard);
        ASSERT_EQ(machine.permitted(), circle);
        machine.abort(circle, 20, beside, -5);
        machine.jog(-20, 0, 30);
        machine.rapid(-20, 0, -4.5);
        check_all(guard);
        EXPECT_EQ(machine.permitted(), circle) << beside;
    }
}

/// The corner behind a blended motion is rounded, whatever the mode of the next one is.
TEST_F(GuardedMachine, RoundsTheCornerByTheModeOfTheMotionBefore) {
    for (const double tolerance : {0.1, 1.0}) {
        Machine machine;
        app::Guard guard(setup_.setup, *machine.ring, 1.0, 0.1);
        machine.rapid(0, 50, 20);
        machine.next.blending = FEELER_BLENDED;
        machine.next.tolerance = tolerance;
        const uint64_t before = machine.line(52.5, 50, 20);
        machine.next.blending = FEELER_EXACT_STOP;
        machine.next.tolerance = 0.0;
        machine.line(52.5, 45, 20);
        machine.line(52.5, -50, 20); // 2.5 mm beside the clamp
        check_all(guard);
        // The corner is away from the clamp, and the mode is not passed on.
        EXPECT_EQ(machine.permitted(), before + 2);
        machine.next.blending = FEELER_BLENDED;
        machine.next.tolerance = tolerance;
        machine.line(52.5, -45, 20);
        machine.next.blending = FEELER_EXACT_STOP;
        machine.line(52.5, 45, 20);
        check_all(guard);
        EXPECT_EQ(machine.permitted(), tolerance < 0.5 ? before + 4 : before + 3);
    }
}

TEST_F(GuardedMachine, ChangesTools) {
    machine_.rapid(-60, 0, 50);
    machine_.next.tool = 2; // 40 mm shorter, so its tip is 40 mm higher
    machine_.rapid(-60, 0, -35);
    const uint64_t cut = machine_.line(40, 0, -42);
    EXPECT_EQ(permitted(), cut);
    machine_.move();
    machine_.next.tool = 1; // where tool 2 is
    machine_.rapid(40, 0, -40);
    EXPECT_EQ(permitted(), cut);
}

TEST_F(GuardedMachine, RefusesAFeedWithTheSpindleReversed) {
    machine_.rapid(-60, 0, 30);
    machine_.rapid(-60, 0, -2);
    machine_.next.turns_on = 2;
    machine_.line(0, 0, -2);
    EXPECT_EQ(permitted(), 2U);
}

TEST_F(GuardedMachine, RefusesAFeedWithASpindleThatIsOnAtNoSpeed) {
    machine_.rapid(-60, 0, 30);
    machine_.rapid(-60, 0, -2);
    machine_.next.speed = 0.0;
    machine_.line(0, 0, -2);
    EXPECT_EQ(permitted(), 2U);
    EXPECT_THAT(told_.back(), HasSubstr("spindle"));
}

TEST_F(GuardedMachine, TakesASpindleWhoseSpeedIsSetByHandForTurning) {
    app::Guard other(setup_.setup, *machine_.ring, 1.0, 0.1, app::ControlKinematics(1.0), true);
    listen(other);
    machine_.rapid(-60, 0, 30);
    machine_.rapid(-60, 0, -2);
    machine_.next.speed = 0.0;
    const uint64_t cut = machine_.line(0, 0, -2);
    check_all(other);
    EXPECT_EQ(machine_.permitted(), cut);
}

TEST_F(GuardedMachine, ChecksTapsAsAWhole) {
    machine_.rapid(53, 0, 50);
    const auto tap = [&](double x, double z) {
        feeler_segment motion = machine_.next;
        motion.shape = FEELER_TAP;
        motion.purpose = FEELER_FEED;
        motion.to[0] = x, motion.to[2] = z + tip;
        return machine_.queue(motion);
    };
    const uint64_t clear = tap(53, 35);
    EXPECT_EQ(permitted(), clear);
    machine_.move();
    EXPECT_EQ(machine_.goal[2], 50 + tip); // it ends where it began
    const uint64_t over = machine_.rapid(70, 0, 50);
    tap(70, 31);
    EXPECT_EQ(permitted(), over);
}

/// A probe looks for the stock, which may not be there. Everything else must be clear all along.
TEST_F(GuardedMachine, ChecksAProbeBeyondItsContact) {
    machine_.next.turns_on = 0;
    machine_.rapid(-80, 0, 40);
    machine_.rapid(-80, 0, -5);
    const uint64_t probe = machine_.line(40, 0, -5, FEELER_PROBE);
    EXPECT_EQ(permitted(), probe);
    machine_.abort(probe, -55, 0, -5); // it has touched
    const uint64_t back = machine_.rapid(-80, 0, -5);
    EXPECT_EQ(permitted(), back);
    machine_.move();
    machine_.line(120, 0, -5, FEELER_PROBE); // behind the stock is the clamp
    EXPECT_EQ(permitted(), back);
    EXPECT_THAT(told_.back(), HasSubstr("clamp"));
}

/// Such a motion does not end where it goes deeper into the stock.
TEST_F(GuardedMachine, LetsAProbeLeaveItsContactOnlyOutOfTheStock) {
    machine_.next.turns_on = 0;
    machine_.rapid(-80, 0, 40);
    machine_.rapid(-80, 0, -5);
    const uint64_t probe = machine_.line(-40, 0, -5, FEELER_PROBE);
    EXPECT_EQ(permitted(), probe);
    machine_.abort(probe, -55, 0, -5); // it has touched
    const uint64_t back = machine_.line(-58, 0, -5, FEELER_PROBE_AWAY);
    EXPECT_EQ(permitted(), back);
    machine_.abort(back, -55.1, 0, -5);
    machine_.line(-40, 0, -5, FEELER_PROBE_AWAY);
    EXPECT_EQ(permitted(), back);
    EXPECT_THAT(told_.back(), HasSubstr("stock"));
}

/// What was refused is not permitted by a guard that is started after that.
TEST_F(GuardedMachine, StaysRefusedWhenTheGuardIsStartedAnew) {
    machine_.rapid(0, 0, 30);
    machine_.rapid(54, 0, 20);
    EXPECT_EQ(permitted(), 1U);
    machine_.move();
    app::Guard other(setup_.setup, *machine_.ring, 1.0, 0.1);
    listen(other);
    check_all(other);
    EXPECT_EQ(machine_.permitted(), 1U);
    machine_.abort_at_rest();
    const uint64_t up = machine_.rapid(0, 0, 40);
    check_all(other);
    EXPECT_EQ(machine_.permitted(), up);
}

/// A guard that is started anew takes what was cut for stock. The tool may leave it.
TEST_F(GuardedMachine, LetsTheToolOutOfACutThatItDoesNotKnow) {
    machine_.rapid(-60, 0, 30);
    machine_.rapid(-60, 0, -5);
    const uint64_t cut = machine_.line(0, 0, -5);
    EXPECT_EQ(permitted(), cut);
    machine_.move();
    app::Guard other(setup_.setup, *machine_.ring, 1.0, 0.1);
    listen(other);
    machine_.rapid(20, 0, -5);
    check_all(other);
    EXPECT_EQ(machine_.permitted(), cut);
    EXPECT_THAT(told_.back(), Not(HasSubstr("loaded"))); // no tool was changed
    machine_.abort_at_rest();
    machine_.rapid(20, 0, -5);
    check_all(other);
    EXPECT_EQ(machine_.permitted(), cut);
    machine_.abort_at_rest();
    const uint64_t up = machine_.rapid(0, 0, 30);
    check_all(other);
    EXPECT_EQ(machine_.permitted(), up);
}

/// Above the head of a T-slot cutter there may be stock.
TEST_F(GuardedMachine, LetsNoToolOutThatIsWiderBelow) {
    for (const char* tool :
         {"shape = \"tslot\"\ndiameter = 20\nflute_length = 5\nneck_diameter = 8\n"
          "neck_length = 40\nshank_diameter = 10\nstick_out = 100",
          "shape = \"drill\"\ndiameter = 14\nflute_length = 40\nshank_diameter = 10\n"
          "stick_out = 100",
          "shape = \"ball\"\ndiameter = 6\nflute_length = 20\nshank_diameter = 10\n"
          "stick_out = 100"}) {
        const std::string flat =
            "shape = \"flat\"\ndiameter = 10\nflute_length = 30\nstick_out = 100";
        std::string text = setup_text;
        text.replace(text.find(flat), flat.size(), tool);
        const app::SetupFile setup = setup_of(text);
        Machine machine;
        machine.rapid(-30, 0, 30);
        app::Guard guard(setup.setup, *machine.ring, 1.0, 0.1);
        check_all(guard);
        machine.abort_at_rest();
        machine.jog(-30, 0, -10); // where an earlier guard has let it cut
        machine.rapid(-20, 0, -10);
        check_all(guard);
        machine.abort_at_rest();
        machine.jog(-30, 0, -10);
        const uint64_t up = machine.rapid(-30, 0, 20);
        check_all(guard);
        EXPECT_EQ(machine.permitted() == up, std::string(tool).find("tslot") == std::string::npos)
            << tool;
    }
}

/// What a motion would have reached that was not made is no measure.
TEST_F(GuardedMachine, MayGoBackAfterAChainOfRetreatsThatWasEnded) {
    machine_.rapid(0, 0, 30);
    machine_.rapid(54.5, 0, 20);
    EXPECT_EQ(permitted(), 1U);
    machine_.abort_at_rest();
    machine_.jog(54.5, 0, 20);
    const uint64_t first = machine_.rapid(52, 0, 20);
    const uint64_t second = machine_.rapid(48, 0, 20);
    EXPECT_EQ(permitted(), second);
    machine_.abort(first, 54, 0, 20);
    const uint64_t up = machine_.rapid(54, 0, 25);
    EXPECT_EQ(permitted(), up);
    machine_.move();
    machine_.rapid(54.3, 0, 25); // nearer than at the start
    EXPECT_EQ(permitted(), up);
}

/// The stock begins where the probe has found it, a little deeper than stated.
TEST_F(GuardedMachine, MayGoUpFromAContactAndNotOn) {
    machine_.next.turns_on = 0;
    machine_.rapid(0, 0, 20);
    const uint64_t probe = machine_.line(0, 0, -5, FEELER_PROBE);
    EXPECT_EQ(permitted(), probe);
    machine_.abort(probe, 0, 0, -0.3);
    const uint64_t up = machine_.rapid(0, 0, 2);
    EXPECT_EQ(permitted(), up);
    EXPECT_EQ(machine_.ring->latched, 0U);
    machine_.move();
    const uint64_t again = machine_.line(0, 0, -5, FEELER_PROBE);
    EXPECT_EQ(permitted(), again);
    machine_.abort(again, 0, 0, -0.3);
    machine_.rapid(5, 0, -0.3);
    EXPECT_EQ(permitted(), again);
}

TEST_F(GuardedMachine, DoesNotCutOnRetreat) {
    machine_.rapid(-60, 0, 30);
    machine_.rapid(-60, 0, -5);
    const uint64_t cut = machine_.line(0, 0, -5);
    machine_.rapid(20, 0, -5); // into the stock
    EXPECT_EQ(permitted(), cut);
    machine_.move();
    machine_.abort_at_rest();
    machine_.line(40, 0, -5);
    EXPECT_EQ(permitted(), cut);
    machine_.abort_at_rest();
    const uint64_t back = machine_.line(-60, 0, -5);
    EXPECT_EQ(permitted(), back);
}

TEST_F(GuardedMachine, WaitsWhileThereIsAnObjection) {
    std::string why = "G54 X differs.";
    guard_.objection = [&](const feeler_segment&) { return why; };
    machine_.rapid(0, 0, 30);
    EXPECT_FALSE(guard_.step());
    EXPECT_EQ(machine_.permitted(), 0U);
    EXPECT_EQ(machine_.ring->read, 0U);
    why.clear();
    EXPECT_EQ(permitted(), 1U);
}

/// Who aborts and tries again is told again.
TEST_F(GuardedMachine, TellsWhatHoldsAgainAfterAnAbort) {
    guard_.objection = [&](const feeler_segment&) { return "G54 X differs."; };
    machine_.rapid(0, 0, 30);
    while (told_.empty()) guard_.step();
    catch_up();
    EXPECT_THAT(told_, ElementsAre("Feeler holds: G54 X differs."));
    machine_.abort_at_rest();
    catch_up();
    machine_.rapid(0, 0, 20);
    catch_up();
    EXPECT_THAT(told_, ElementsAre("Feeler holds: G54 X differs.", "Feeler holds: G54 X differs."));
}

TEST_F(GuardedMachine, NamesNoLineOfAProgramInMdi) {
    guard_.is_mdi = [] { return true; };
    machine_.rapid(-60, 0, 30);
    machine_.rapid(54, 0, 20);
    permitted();
    ASSERT_EQ(told_.size(), 1U);
    EXPECT_THAT(told_[0],
                AllOf(StartsWith("Feeler stops before this command: "), Not(HasSubstr("line"))));
}

/// What was refused, and not aborted, does not start to move when a guard is started again.
TEST_F(GuardedMachine, StillRefusesWhatAnEarlierGuardHasRefused) {
    machine_.rapid(-60, 0, 30);
    const uint64_t safe = machine_.rapid(50, 0, 20);
    machine_.rapid(54, 0, 20);
    EXPECT_EQ(permitted(), safe);
    machine_.move();
    machine_.ring->cleared = 1;
    catch_up();
    EXPECT_EQ(machine_.ring->latched, 0U);
    told_.clear();
    app::SetupFile corrected = setup_of(setup_text);
    corrected.setup.fixtures.clear();
    app::Guard other(corrected.setup, *machine_.ring, 1.0, 0.1);
    listen(other);
    check_all(other);
    EXPECT_EQ(machine_.permitted(), safe);
    EXPECT_THAT(told_, ElementsAre("Feeler: what waits was refused before. Abort the program or "
                                   "command to go on."));
    machine_.abort_at_rest();
    machine_.rapid(54, 0, 20);
    check_all(other);
    EXPECT_EQ(machine_.permitted(), machine_.ring->written);
}

/// An earlier guard may have read motions that it did not permit.
TEST_F(GuardedMachine, TakesOverFromAGuardThatWasKilled) {
    machine_.rapid(-60, 0, 30);
    EXPECT_EQ(permitted(), 1U);
    machine_.move();
    machine_.rapid(-60, 0, -5);
    machine_.ring->read = 2;
    app::Guard other(setup_.setup, *machine_.ring, 1.0, 0.1);
    listen(other);
    check_all(other);
    EXPECT_EQ(machine_.permitted(), 2U);
}

/// A guard does not know how motions end that an earlier one has permitted.
TEST_F(GuardedMachine, BeginsWhenTheMotionsOfAnEarlierGuardAreComplete) {
    machine_.rapid(-60, 0, 30);
    EXPECT_EQ(permitted(), 1U);
    machine_.rapid(-60, 0, -5);
    app::Guard other(setup_.setup, *machine_.ring, 1.0, 0.1);
    EXPECT_FALSE(other.step());
    machine_.move();
    machine_.ring->busy = 1;
    EXPECT_FALSE(other.step());
    machine_.ring->busy = 0;
    EXPECT_TRUE(other.step());
    EXPECT_EQ(machine_.permitted(), 2U);
}

TEST_F(GuardedMachine, EndsWhenAnotherGuardPermits) {
    machine_.rapid(-60, 0, 30);
    EXPECT_EQ(permitted(), 1U);
    machine_.move();
    machine_.rapid(-60, 0, 20);
    app::Guard other(setup_.setup, *machine_.ring, 1.0, 0.1);
    EXPECT_TRUE(other.step());
    machine_.move();
    machine_.rapid(-60, 0, 10);
    check_all(guard_);
    EXPECT_TRUE(guard_.is_disturbed());
    EXPECT_EQ(machine_.permitted(), 2U);
}

TEST_F(GuardedMachine, IsTheOnlyOne) {
    EXPECT_TRUE(app::claim(*machine_.ring));
    EXPECT_TRUE(app::claim(*machine_.ring));
    machine_.ring->process = 1; // always runs
    EXPECT_FALSE(app::claim(*machine_.ring));
    machine_.ring->process = 0x3FFFFFFF; // cannot run
    EXPECT_TRUE(app::claim(*machine_.ring));
}

TEST_F(GuardedMachine, IgnoresPermitsOfAnotherSession) {
    machine_.ring->permitted = feeler_permit(0x4321, 7);
    app::Guard other(setup_.setup, *machine_.ring, 1.0, 0.1);
    EXPECT_EQ(machine_.permitted(), 0U);
    machine_.rapid(-60, 0, 30);
    EXPECT_TRUE(other.step());
    EXPECT_EQ(machine_.permitted(), 1U);
}

/// An arc that is stopped on its way has cut up to there.
TEST_F(GuardedMachine, FollowsPartsOfArcs) {
    const auto half_turn = [&] {
        feeler_segment arc = machine_.next; // from X20 over Y20 to X-20, about the middle
        arc.shape = FEELER_ARC;
        arc.purpose = FEELER_CURVE;
        arc.normal[2] = 1.0;
        arc.centre[2] = -5 + tip;
        arc.to[0] = -20.0, arc.to[2] = -5 + tip;
        return machine_.queue(arc);
    };
    machine_.rapid(20, 0, 30);
    machine_.line(20, 0, -5);
    const uint64_t arc = half_turn();
    EXPECT_EQ(permitted(), arc);
    machine_.abort(arc, 0, 20, -5);
    machine_.rapid(0, 20, 5);
    const uint64_t down = machine_.rapid(0, 20, -4.9); // into its own cut
    EXPECT_EQ(permitted(), down);
    machine_.move();
    const uint64_t up = machine_.rapid(0, 20, 5);
    machine_.rapid(-20, 0, 5);
    machine_.rapid(-20, 0, -4.9); // the second half was not cut
    EXPECT_EQ(permitted(), up + 1);
    EXPECT_THAT(told_.back(), HasSubstr("stock"));
}

TEST_F(GuardedMachine, SkipsMotionsThatWereDropped) {
    machine_.rapid(-60, 0, 30);
    EXPECT_EQ(permitted(), 1U);
    machine_.move();
    machine_.rapid(60, 0, 20); // into the clamp, but dropped before it is read
    machine_.abort_at_rest();
    const uint64_t last = machine_.rapid(0, 0, 30);
    EXPECT_EQ(permitted(), last);
    EXPECT_TRUE(told_.empty());
}

TEST_F(GuardedMachine, CountsInTheUnitOfTheMachine) {
    Machine inch;
    inch.most_acceleration = 1000.0 / 25.4;
    app::Guard guard(setup_.setup, *inch.ring, 25.4, 0.1);
    feeler_segment motion = inch.next;
    motion.shape = FEELER_LINE;
    motion.purpose = FEELER_RAPID;
    motion.to[0] = 52.9 / 25.4;
    motion.to[2] = (20.0 + tip) / 25.4;
    std::copy(std::begin(motion.to), std::end(motion.to), std::begin(inch.goal));
    motion.to[0] = 52.99 / 25.4;
    inch.queue(motion);
    motion.to[0] = 53.01 / 25.4;
    inch.queue(motion);
    check_all(guard);
    EXPECT_EQ(inch.permitted(), 1U);
    EXPECT_DOUBLE_EQ(inch.ring->feed_tolerance, 0.1 / 25.4);
}

TEST_F(GuardedMachine, CountsTolerancesAndCentresInTheUnitOfTheMachine) {
    const auto is_permitted = [&](const std::function<void(feeler_segment&)>& change) {
        Machine inch;
        inch.most_acceleration = 1000.0 / 25.4;
        app::Guard guard(setup_.setup, *inch.ring, 25.4, 0.1);
        inch.goal[0] = 40.0 / 25.4;
        inch.goal[2] = (20.0 + tip) / 25.4;
        feeler_segment motion = inch.next;
        motion.shape = FEELER_LINE;
        motion.purpose = FEELER_FEED;
        std::copy(std::begin(inch.goal), std::end(inch.goal), std::begin(motion.to));
        motion.to[0] = 52.5 / 25.4; // 2.5 mm from the clamp
        change(motion);
        inch.queue(motion);
        check_all(guard);
        return inch.permitted() == 1;
    };
    const auto blend = [](double tolerance) {
        return [tolerance](feeler_segment& motion) {
            motion.blending = FEELER_BLENDED;
            motion.tolerance = tolerance / 25.4;
        };
    };
    EXPECT_TRUE(is_permitted(blend(0.27)));
    EXPECT_FALSE(is_permitted(blend(0.29)));
    const auto circle = [](double centre) {
        return [centre](feeler_segment& motion) {
            motion.shape = FEELER_ARC;
            motion.purpose = FEELER_CURVE;
            motion.normal[2] = 1.0;
            motion.centre[0] = centre / 25.4;
            motion.to[0] = motion.from[0] = 40.0 / 25.4;
        };
    };
    EXPECT_TRUE(is_permitted(circle(46.0)));
    EXPECT_FALSE(is_permitted(circle(47.0)));
}

TEST_F(GuardedMachine, ShowsThatItLives) {
    guard_.step();
    const uint64_t before = machine_.ring->alive;
    guard_.step();
    EXPECT_GT(machine_.ring->alive, before);
}

TEST_F(GuardedMachine, TakesNoPermitOverForMotionsThatAreNotThere) {
    machine_.ring->permitted = feeler_permit(machine_.ring->session, 9);
    app::Guard other(setup_.setup, *machine_.ring, 1.0, 0.1);
    EXPECT_EQ(machine_.permitted(), 0U);
}

TEST_F(GuardedMachine, EndsWhenTheRingDoesNotHoldTheNextMotion) {
    machine_.rapid(0, 0, 30);
    machine_.ring->segment[1].number = 2;
    EXPECT_FALSE(guard_.step());
    EXPECT_TRUE(guard_.is_disturbed());
    EXPECT_EQ(machine_.permitted(), 0U);
}

TEST_F(GuardedMachine, KnowsOneVersionOfTheRing) {
    EXPECT_EQ(app::why_unknown(*machine_.ring), "");
    machine_.ring->version = FEELER_RING_VERSION - 1;
    EXPECT_THAT(app::why_unknown(*machine_.ring), HasSubstr("version"));
    machine_.ring->version = FEELER_RING_VERSION;
    machine_.ring->bytes = 8;
    EXPECT_NE(app::why_unknown(*machine_.ring), "");
    machine_.ring->magic = 0;
    EXPECT_THAT(app::why_unknown(*machine_.ring), HasSubstr("not loaded"));
}

TEST(PermitTimes, TellsQuantiles) {
    app::PermitTimes times;
    EXPECT_EQ(times.within(0.5), 0.0);
    for (int i = 0; i < 999; ++i) times.add(1e-4);
    times.add(0.5);
    EXPECT_NEAR(times.within(0.5), 1e-4, 1e-5);
    EXPECT_NEAR(times.within(0.999), 1e-4, 1e-5);
    EXPECT_NEAR(times.within(1.0), 0.5, 0.05);
    times.add(0.0);
    times.add(1e9);
    EXPECT_GT(times.within(1.0), 5.0);
}

TEST(LiveControl, ComparesOffsetsAndLengths) {
    const app::SetupFile setup = setup_of(setup_text);
    app::ControlState control{.origin = {0, 0, -200}};
    EXPECT_THAT(app::difference(setup, control, 1.0, 0.01), HasSubstr("not homed"));
    control.is_homed = true;
    EXPECT_EQ(app::difference(setup, control, 1.0, 0.01), "");
    control.origin[0] = 0.009;
    EXPECT_EQ(app::difference(setup, control, 1.0, 0.01), "");
    control.origin[0] = 0.011;
    EXPECT_THAT(app::difference(setup, control, 1.0, 0.01),
                AllOf(HasSubstr("G54 X"), HasSubstr("0.0110"), HasSubstr("0.0000")));
    control.origin = {0, 0, -200 / 25.4};
    EXPECT_EQ(app::difference(setup, control, 25.4, 0.01), "");
    EXPECT_NE(app::difference(setup, control, 1.0, 0.01), "");
    control.origin = {0, 0, -200};
    control.rotation_deg = 1.0;
    EXPECT_THAT(app::difference(setup, control, 1.0, 0.01), HasSubstr("turned"));
    control.rotation_deg = 0.0;
    control.work_offset = 2;
    EXPECT_THAT(app::difference(setup, control, 1.0, 0.01), HasSubstr("G55"));
    control.work_offset = 1;
    control.tool = 1;
    EXPECT_THAT(app::difference(setup, control, 1.0, 0.01), HasSubstr("length of tool 1"));
    control.tool_length = 100.0;
    EXPECT_EQ(app::difference(setup, control, 1.0, 0.01), "");
    control.tool = 3;
    EXPECT_THAT(app::difference(setup, control, 1.0, 0.01), HasSubstr("Tool 3"));
}

TEST(LiveControl, GetsLongTextsInSentences) {
    const std::string first(150, 'a'), second(120, 'b'), words = "ccc " + std::string(248, 'd');
    EXPECT_THAT(app::messages_of("Short. Enough."), ElementsAre("Short. Enough."));
    EXPECT_THAT(app::messages_of(first + ". X. " + second + ". Y."),
                ElementsAre(first + ". X.", second + ". Y."));
    EXPECT_THAT(app::messages_of(words + " e"), ElementsAre("ccc", std::string(248, 'd') + " e"));
    EXPECT_THAT(app::messages_of(std::string(260, 'f')),
                ElementsAre(std::string(250, 'f'), std::string(10, 'f')));
    EXPECT_TRUE(app::messages_of("").empty());
}

TEST(LiveControl, ReadsTheStatus) {
    const auto state = app::read_control_state(
        R"({"work_offset": 3, "origin": [1, 2, 3, 4, 5, 6, 7, 8, 9], "rotation": 0.5, "tool": 4, "tool_length": 80.25, "homed": true, "mdi": true})");
    ASSERT_TRUE(state.has_value());
    EXPECT_TRUE(state->is_mdi);
    EXPECT_EQ(state->work_offset, 3);
    EXPECT_EQ(state->origin[8], 9.0);
    EXPECT_EQ(state->tool, 4);
    EXPECT_EQ(state->tool_length, 80.25);
    EXPECT_TRUE(state->is_homed);
    for (
        const char* const bad :
        {"", "{}", "[1]", "{\"work_offset\": 1}",
         R"({"work_offset": 1, "origin": [1], "rotation": 0, "tool": 4, "tool_length": 1, "homed": true})",
         R"({"work_offset": 1, "origin": [1,2,3,4,5,6,7,8,9], "rotation": 0, "tool": 4, "tool_length": 1})",
         R"({"work_offset": "a", "origin": [1,2,3,4,5,6,7,8,9], "rotation": 0, "tool": 4, "tool_length": 1, "homed": true})"})
        EXPECT_FALSE(app::read_control_state(bad).has_value()) << bad;
}

/// A table that tilts about X and turns about Z, as LinuxCNC's xyzac-trt-kins has it.
const std::string five_axes_ini = R"([KINS]
KINEMATICS = xyzac-trt-kins sparm=identityfirst
[TRAJ]
COORDINATES = XYZAC
[HAL]
HALCMD = net select motion.analog-out-03 => motion.switchkins-type
HALCMD = net length motion.tooloffset.z => xyzac-trt-kins.tool-offset
HALCMD = setp xyzac-trt-kins.x-rot-point 10
HALCMD = setp xyzac-trt-kins.y-rot-point -5
HALCMD = setp xyzac-trt-kins.z-rot-point -250
HALCMD = setp xyzac-trt-kins.y-offset 20
HALCMD = setp xyzac-trt-kins.z-offset 15
)";

/// Its joints, by the formulas of LinuxCNC's trtfuncs.c, at a part of the way of a motion.
void find_joints(const feeler_segment& motion, double part, bool is_aside,
                 double (&joint)[FEELER_JOINTS]) {
    constexpr double aside[] = FEELER_ASIDE;
    double at[9];
    for (size_t i = 0; i < 9; ++i) {
        at[i] = motion.from[i] + part * (motion.to[i] - motion.from[i]);
        if (is_aside && i < 3) at[i] += aside[i];
    }
    const double a = at[3] * std::numbers::pi / 180.0, c = at[5] * std::numbers::pi / 180.0;
    const double dy = 20.0, dz = 15.0 + motion.tool_length;
    const double x = at[0] - 10.0, y = at[1] + 5.0, z = at[2] + 250.0;
    const double q = std::sin(c) * x + std::cos(c) * y - dy, r = z - dz;
    joint[0] = std::cos(c) * x - std::sin(c) * y + 10.0;
    joint[1] = std::cos(a) * q - std::sin(a) * r + dy - 5.0;
    joint[2] = std::sin(a) * q + std::cos(a) * r + dz - 250.0;
    joint[3] = at[3];
    joint[4] = at[5];
}

/// What feeler_tp would write about a motion.
void ask_five_axes(feeler_segment& motion) {
    motion.joints = 5;
    find_joints(motion, 0.0, false, motion.joint_from);
    find_joints(motion, FEELER_BETWEEN, true, motion.joint_aside);
    find_joints(motion, 1.0, false, motion.joint_to);
}

/// A program of random lines and arcs, and the same motions as LinuxCNC queues them; of the tip of
/// a tool on a table that turns, if `turns`.
struct RandomMotions {
    explicit RandomMotions(uint32_t seed, bool turns_work = false)
        : random(seed), turns(turns_work) {
        program = "G21 G90 G17 G54 G61.1\nM61 Q1\nG43 H1\nM3 S1000\n";
        machine.next.turns_on = 1;
        if (turns) follow_tip();
        const double start[] = {-60.0, 0.0, 40.0};
        move_to(start, true);
        for (int i = 0; i < 40; ++i) add();
        program += "M2\n";
    }

    double between(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    }
    bool chance(double share) { return between(0, 1) < share; }

    void follow_tip() {
        program += "M68 E3 Q1\nM66 E0 L0\n";
        machine.next.tool_length = 100.0;
        machine.ask_kinematics = ask_five_axes;
    }

    /// Turns the table in the next motion, sometimes. The words for that.
    std::string turn() {
        std::string words;
        if (!turns || program.size() < 100) return words;
        for (const auto& [axis, most] : {std::pair{3, 40.0}, std::pair{5, 200.0}})
            if (chance(0.4)) {
                machine.next.to[axis] = round6(between(-most, most));
                words += fmt::format(" {}{:.6f}", axis == 3 ? 'A' : 'C', machine.next.to[axis]);
            }
        return words;
    }

    void move_to(const double (&to)[3], bool is_rapid) {
        program += fmt::format("{} X{:.6f} Y{:.6f} Z{:.6f}{}{}\n", is_rapid ? "G0" : "G1", to[0],
                               to[1], to[2], turn(), is_rapid ? "" : " F600");
        machine.line(to[0], to[1], to[2], is_rapid ? FEELER_RAPID : FEELER_FEED);
        std::copy(std::begin(to), std::end(to), std::begin(at));
    }

    /// An arc about a centre in one of the three planes, of less than a turn, or some turns.
    void arc() {
        const int normal = static_cast<int>(random() % 3);
        const int u = (normal + 1) % 3, v = (normal + 2) % 3;
        double centre[3] = {at[0], at[1], at[2]};
        centre[u] += round6(between(-8, 8));
        centre[v] += round6(between(-8, 8));
        const double radius = std::hypot(at[u] - centre[u], at[v] - centre[v]);
        const double begin = std::atan2(at[v] - centre[v], at[u] - centre[u]);
        const bool is_clockwise = chance(0.5), is_full = chance(0.2);
        const double angle = begin + between(0.3, 6.0);
        double to[3] = {at[0], at[1], at[2]};
        if (!is_full) {
            to[u] = round6(centre[u] + radius * std::cos(angle));
            to[v] = round6(centre[v] + radius * std::sin(angle));
        }
        to[normal] = round6(to[normal] + between(-2, 3));
        const int rounds = chance(0.2) ? 2 : 1;
        const char* const planes[] = {"G19", "G18", "G17"};
        // The third axis of G18 counts its angle from Z to X, as here.
        program += fmt::format("{} {} X{:.6f} Y{:.6f} Z{:.6f}", planes[normal],
                               is_clockwise ? "G2" : "G3", to[0], to[1], to[2]);
        for (const int axis : {u, v})
            program += fmt::format(" {}{:.6f}", "IJK"[axis], centre[axis] - at[axis]);
        program += turn();
        program += rounds > 1 ? fmt::format(" P{} F600\n", rounds) : " F600\n";

        feeler_segment motion = machine.next;
        motion.shape = FEELER_ARC;
        motion.purpose = FEELER_CURVE;
        // Clockwise about an axis is counterclockwise about its opposite.
        const bool is_reversed = chance(0.5);
        motion.turns = is_clockwise != is_reversed ? -rounds : rounds - 1;
        motion.normal[normal] = is_reversed ? -1.0 : 1.0;
        for (int i = 0; i < 3; ++i) {
            motion.to[i] = to[i] + (i == 2 ? tip : 0.0);
            motion.centre[i] = centre[i] + (i == 2 ? tip : 0.0);
        }
        machine.queue(motion);
        std::copy(std::begin(to), std::end(to), std::begin(at));
    }

    static double round6(double value) { return std::round(value * 1e6) / 1e6; }

    void add() {
        if (chance(0.4)) return arc();
        const double to[] = {round6(between(-58, 56)), round6(between(-38, 38)),
                             round6(chance(0.5) ? between(-3, 2) : between(1, 40))};
        move_to(to, chance(0.3));
    }

    std::mt19937 random;
    bool turns;
    Machine machine;
    std::string program;
    double at[3] = {};
};

/// How many motions of a program come before the first one that a check does not call clear.
uint64_t clear_motions(const std::string& program, const std::string& setup) {
    app::CheckJob job;
    job.program = program;
    job.setup = setup;
    job.detail = core::Detail::every_pair;
    const auto run = app::run_check(job);
    if (!run || run->stopped) throw std::runtime_error("the program cannot be checked");
    uint64_t clear = 0;
    for (const app::CheckedBlock& block : run->blocks) {
        if (block.result.motion == core::BlockMotion::none) continue;
        const bool has_error =
            std::any_of(run->findings.begin(), run->findings.end(), [&](const auto& finding) {
                return finding.severity == core::Severity::error && finding.block == block.block;
            });
        if (block.result.verdict != core::Verdict::clear || has_error) break;
        ++clear;
    }
    return clear;
}

/// The guard permits the motions before the first one that a check of the program does not call
/// clear, and no more.
TEST(GuardedPrograms, StopWhereACheckFindsTheFirstProblem) {
    const test_support::ScopedFolder folder;
    const std::string path = folder.write("mill.toml", setup_text);
    const app::SetupFile setup = setup_of(setup_text);
    size_t stopped_late = 0;
    for (uint32_t seed = 1; seed <= 60; ++seed) {
        RandomMotions motions(seed);
        const uint64_t clear = clear_motions(folder.write("random.ngc", motions.program), path);
        app::Guard guard(setup.setup, *motions.machine.ring, 1.0, 0.1);
        while (guard.has_motion() && guard.step()) {
        }
        EXPECT_EQ(motions.machine.permitted(), clear) << "seed " << seed << "\n" << motions.program;
        stopped_late += clear > 3 && clear < motions.machine.ring->written;
    }
    EXPECT_GT(stopped_late, 20U);
}

/// The set-up of RandomMotions on five axes, in a folder.
std::string five_axes_setup(const test_support::ScopedFolder& folder) {
    folder.write("mill.ini", five_axes_ini);
    std::string text = setup_text;
    text.replace(text.find("start = {"), 9, "ini = \"mill.ini\"\nstart = { A = 0, C = 0,");
    return folder.write("mill.toml", text);
}

/// Along an axis of rotation, the control has the same joints whether it follows the tip or not.
TEST(GuardedMotions, OfWhichTheEndsAreOnAnAxisOfRotationHaveTheirKinematics) {
    const test_support::ScopedFolder folder;
    const auto setup = app::read_setup(five_axes_setup(folder), {});
    ASSERT_TRUE(setup.has_value()) << setup.error().message;
    const app::ControlKinematics kinematics(1.0, setup->environment.kinematics.value(),
                                            setup->setup.machine, 0.01);
    for (const double a : {-30.0, 0.02, 60.0})
        for (const bool is_full : {false, true}) {
            feeler_segment arc{};
            arc.shape = FEELER_ARC;
            arc.purpose = FEELER_CURVE;
            arc.tool_length = 100.0;
            arc.from[0] = 30.0, arc.from[1] = 15.0, arc.from[2] = -135.0, arc.from[3] = a;
            std::copy(std::begin(arc.from), std::end(arc.from), std::begin(arc.to));
            if (!is_full) arc.to[0] = -20.0;
            ask_five_axes(arc);
            EXPECT_TRUE(std::abs(arc.joint_from[1] - arc.from[1]) < 1e-9); // as the axes would be
            const app::LiveMotion read = kinematics.read(arc);
            EXPECT_TRUE(read.follows_tip) << a;
            EXPECT_EQ(read.problem, "");
            arc.joint_aside[2] = std::numeric_limits<double>::quiet_NaN();
            EXPECT_NE(kinematics.read(arc).problem, "");
        }
}

/// With trivkins, each joint is where its letter says, also where two have the same.
TEST(GuardedMotions, OfOtherKinematicsThanTheIniFileHasAreRefused) {
    gcode::SwitchableKinematics trivial;
    trivial.types = {gcode::SwitchableKinematics::Type::axes};
    trivial.coordinates = "XYYZAC";
    const app::ControlKinematics kinematics(25.4, trivial, setup_of(setup_text).setup.machine,
                                            0.01);
    feeler_segment line{};
    line.shape = FEELER_LINE;
    EXPECT_THAT(kinematics.read(line).problem, HasSubstr("could not be asked"));
    constexpr double aside[] = FEELER_ASIDE;
    line.joints = 6;
    line.to[0] = 10.0, line.to[3] = line.from[3] = 30.0;
    const size_t axes[] = {0, 1, 1, 2, 3, 5};
    for (size_t joint = 0; joint < 6; ++joint) {
        const size_t axis = axes[joint];
        line.joint_from[joint] = line.from[axis];
        line.joint_to[joint] = line.to[axis];
        line.joint_aside[joint] = line.from[axis]
                                  + FEELER_BETWEEN * (line.to[axis] - line.from[axis])
                                  + (axis < 3 ? aside[axis] : 0.0);
    }
    const app::LiveMotion read = kinematics.read(line);
    EXPECT_EQ(read.problem, "");
    EXPECT_FALSE(read.follows_tip);
    EXPECT_DOUBLE_EQ(read.axes_to[0], 254.0);
    line.joint_aside[2] += 0.001; // inches
    EXPECT_THAT(kinematics.read(line).problem,
                AllOf(HasSubstr("Y would be at -11887.1746"), HasSubstr("-11887.2000 (mm)")));
}

/// A motion that may be blended while a rotary axis turns counts as four times its tolerance off
/// its path, and as far off as the one before it.
TEST(GuardedMotions, CountAsFarOffTheirPathAsTurningCornersAre) {
    const test_support::ScopedFolder folder;
    const auto setup = app::read_setup(five_axes_setup(folder), {});
    ASSERT_TRUE(setup.has_value()) << setup.error().message;
    const app::ControlKinematics kinematics(1.0, setup->environment.kinematics.value(),
                                            setup->setup.machine, 0.01);
    // Permits for motions beside the clamp, which is at X60, to an end this far from the tool.
    const auto permits = [&](uint32_t first, uint32_t second, double gap) {
        Machine machine;
        machine.ask_kinematics = ask_five_axes;
        machine.next.tool_length = 100.0;
        machine.next.tolerance = 0.02;
        const auto move = [&](double x, double y, double c, uint32_t blending, uint32_t purpose) {
            machine.next.blending = blending;
            std::fill(std::begin(machine.next.to), std::end(machine.next.to), 0.0);
            machine.next.to[5] = c;
            machine.line(x, y, 10, purpose);
        };
        move(40, -10, 0, FEELER_EXACT_STOP, FEELER_RAPID);
        move(52.5, -10, 0.5, first, FEELER_FEED);
        move(55 - gap, 10, 1, second, FEELER_FEED);
        app::Guard guard(setup->setup, *machine.ring, 1.0, 0.1, kinematics);
        while (guard.has_motion() && guard.step()) {
        }
        return machine.permitted();
    };
    EXPECT_EQ(permits(FEELER_EXACT_PATH, FEELER_EXACT_PATH, 2.05), 3U);
    EXPECT_EQ(permits(FEELER_EXACT_PATH, FEELER_BLENDED, 2.05), 2U);
    EXPECT_EQ(permits(FEELER_BLENDED, FEELER_EXACT_PATH, 2.05), 2U);
    EXPECT_EQ(permits(FEELER_BLENDED, FEELER_BLENDED, 2.2), 3U);
}

/// A cut that was ended on its way while the table turned counts as far as it went, if the table
/// was where it belongs there.
TEST(GuardedMotions, CountAsCutUpToWhereTheyWereEnded) {
    const test_support::ScopedFolder folder;
    const auto setup = app::read_setup(five_axes_setup(folder), {});
    ASSERT_TRUE(setup.has_value()) << setup.error().message;
    const app::ControlKinematics kinematics(1.0, setup->environment.kinematics.value(),
                                            setup->setup.machine, 0.01);
    for (const double turned : {0.25, 0.35}) {
        Machine machine;
        machine.ask_kinematics = ask_five_axes;
        machine.next.tool_length = 100.0;
        machine.rapid(-70, 0, -5);
        machine.next.to[5] = 0.5;
        const uint64_t cut = machine.line(20, 0, -5);
        app::Guard guard(setup->setup, *machine.ring, 1.0, 0.1, kinematics);
        const auto permitted = [&] {
            while (guard.has_motion() && guard.step()) {
            }
            return machine.permitted();
        };
        EXPECT_EQ(permitted(), cut);
        machine.abort(cut, -25, 0, -5); // half-way
        machine.stopped_at[5] = machine.goal[5] = machine.next.to[5] = turned;
        const uint64_t back = machine.rapid(-70, 0, -5);
        EXPECT_EQ(permitted(), turned == 0.25 ? back : cut);
    }
}

/// The same on a table that turns, while the control follows the tip.
TEST(GuardedPrograms, StopWhereACheckFindsTheFirstProblemOnFiveAxes) {
    const test_support::ScopedFolder folder;
    const std::string path = five_axes_setup(folder);
    const auto setup = app::read_setup(path, {});
    ASSERT_TRUE(setup.has_value()) << setup.error().message;
    const app::ControlKinematics kinematics(1.0, setup->environment.kinematics.value(),
                                            setup->setup.machine, 0.01);
    size_t stopped_late = 0;
    for (uint32_t seed = 1; seed <= 12; ++seed) {
        RandomMotions motions(seed, true);
        const uint64_t clear = clear_motions(folder.write("random.ngc", motions.program), path);
        app::Guard guard(setup->setup, *motions.machine.ring, 1.0, 0.1, kinematics);
        while (guard.has_motion() && guard.step()) {
        }
        EXPECT_EQ(motions.machine.permitted(), clear) << "seed " << seed << "\n" << motions.program;
        stopped_late += clear > 3 && clear < motions.machine.ring->written;
    }
    EXPECT_GE(stopped_late, 4U);
}

/// The log of a run is a program with the same motions.
TEST(GuardedPrograms, AreRepeatedByTheirLogs) {
    const test_support::ScopedFolder folder;
    const std::string path = folder.write("mill.toml", setup_text);
    const app::SetupFile setup = setup_of(setup_text);
    const auto check_of = [&](const std::string& program) {
        app::CheckJob job;
        job.program = program;
        job.setup = path;
        return app::run_check(job);
    };
    double in_all = 0.0;
    for (uint32_t seed = 101; seed <= 120; ++seed) {
        RandomMotions motions(seed);
        const std::string log_path = folder / "log.ngc";
        std::vector<double> ends;
        {
            app::Guard guard(setup.setup, *motions.machine.ring, 1.0, 0.1);
            auto log = app::MotionLog::begin(log_path, setup);
            ASSERT_TRUE(log.has_value());
            guard.after_motion = [&](const app::LiveMotion& motion) {
                log->add(motion);
                ends.push_back(motion.to[0]);
            };
            while (guard.has_motion() && guard.step()) {
            }
            motions.machine.move();
            for (int i = 0; i < 100; ++i) guard.step();
        }
        ASSERT_EQ(ends.size(), motions.machine.permitted());
        const auto logged = check_of(log_path);
        const auto original = check_of(folder.write("random.ngc", motions.program));
        ASSERT_TRUE(logged.has_value() && original.has_value());
        ASSERT_FALSE(logged->stopped.has_value()) << logged->stopped->message;
        double removed = 0.0, expected = 0.0;
        size_t count = 0, moves = 0;
        for (const app::CheckedBlock& block : logged->blocks) {
            removed += block.result.removed;
            if (block.result.motion == core::BlockMotion::none) continue;
            ++count;
            EXPECT_EQ(block.result.verdict, core::Verdict::clear) << "seed " << seed;
        }
        for (const app::CheckedBlock& block : original->blocks) {
            if (block.result.motion == core::BlockMotion::none || moves == ends.size()) continue;
            ++moves;
            expected += block.result.removed;
        }
        EXPECT_GE(count, ends.size());
        EXPECT_LE(count, ends.size() + 1); // and the way to the first one
        EXPECT_NEAR(removed, expected, 1e-3 * expected + 0.1) << "seed " << seed;
        in_all += removed;
    }
    EXPECT_GT(in_all, 10000.0);
}

/// What it says before it watches anything.
TEST(GuardCommand, NamesWhatItCannotWorkWith) {
    const test_support::ScopedFolder folder;
    const auto refusal = [&](std::string text, const std::string& ini) {
        const std::string setup = folder.write("mill.toml", text);
        const auto ran = feeler(
            {"guard", "--setup", setup, "--ini", folder.write("mill.ini", ini), "--wait", "0"});
        EXPECT_EQ(ran.status, 2) << ran.err;
        return ran.err;
    };
    const std::string ini = "[KINS]\nKINEMATICS = trivkins\n";
    const auto without = [](std::string text, const std::string& from, const std::string& to) {
        const size_t begin = text.find(from);
        return text.erase(begin, text.find(to, begin + 1) - begin);
    };
    EXPECT_THAT(refusal(without(setup_text, "[stock]", "[[fixture]]"), ini), HasSubstr("stock"));
    EXPECT_THAT(refusal(without(setup_text, "[offsets]", "[stock]"), ini),
                HasSubstr("work offsets"));
    EXPECT_THAT(refusal(without(setup_text, "[[tool]]", "\n\n"), ini), HasSubstr("tools"));
    EXPECT_THAT(refusal(setup_text, "[KINS]\nKINEMATICS = genhexkins\n"), HasSubstr("genhexkins"));
    EXPECT_THAT(refusal(setup_text, ini + "[EMCMOT]\nSERVO_PERIOD = 2000000\n"),
                HasSubstr("mill.ini: [EMCMOT] SERVO_PERIOD"));
    EXPECT_THAT(
        refusal(setup_text, "[KINS]\nKINEMATICS = xyzac-trt-kins\n[HAL]\nHALFILE = pins.tcl\n"),
        HasSubstr("_hal[xyzac-trt-kins"));
    const std::string five_axes = "[KINS]\nKINEMATICS = xyzac-trt-kins\n[HAL]\nHALCMD = setp "
                                  "xyzac-trt-kins.y-offset 20\n";
    const std::string rotary =
        "name = \"A\"\nkind = \"rotary\"\nside = \"table\"\nparent = \"base\"\n"
        "direction = [-1, 0, 0]\npoint = [0, 19, 0]\n";
    EXPECT_THAT(refusal(setup_text + "[[machine.axis]]\n" + rotary, five_axes),
                HasSubstr("rotary axes are not where xyzac-trt-kins"));
}

TEST(MotionLog, BeginsWithThePlacesOfAllAxes) {
    const test_support::ScopedFolder folder;
    const auto setup = app::read_setup(five_axes_setup(folder), {});
    ASSERT_TRUE(setup.has_value()) << setup.error().message;
    const app::ControlKinematics kinematics(1.0, setup->environment.kinematics.value(),
                                            setup->setup.machine, 0.01);
    Machine machine;
    machine.ask_kinematics = ask_five_axes;
    machine.next.tool_length = 100.0;
    machine.goal[3] = machine.next.to[3] = 30.0;
    machine.rapid(10, 0, 60);
    machine.rapid(20, 0, 60);
    {
        auto log = app::MotionLog::begin(folder / "log.ngc", *setup);
        ASSERT_TRUE(log.has_value());
        for (const uint64_t number : {1, 2})
            log->add(kinematics.read(machine.ring->segment[number]));
    }
    const std::string text = core::file_bytes(folder / "log.ngc").value();
    EXPECT_THAT(text, HasSubstr("G43.1 Z100.000000\nM68 E3 Q1\nM66 E0 L0\n"));
    EXPECT_THAT(text, HasSubstr(" A30.000000 C0.000000\n"));
}

TEST(MotionLog, WritesARefusalBehindTheMotionsBeforeIt) {
    const test_support::ScopedFolder folder;
    const app::SetupFile setup = setup_of(setup_text);
    Machine machine;
    machine.rapid(0, 0, 30);
    machine.line(0, 0, 20);
    machine.rapid(60, 0, 20);
    machine.rapid(0, 0, 40);
    const auto motion = [&](uint64_t number) {
        return app::ControlKinematics(1.0).read(machine.ring->segment[number]);
    };
    {
        auto log = app::MotionLog::begin(folder / "log.ngc", setup);
        ASSERT_TRUE(log.has_value());
        log->add(motion(1));
        log->add_refused(motion(3), "too near (to the clamp)");
        log->add(motion(2));
        log->add(motion(4));
        log->add_refused(motion(3), "again");
    }
    const std::string text = core::file_bytes(folder / "log.ngc").value();
    const auto at = [&](const char* what) { return text.find(what); };
    EXPECT_LT(at("(line 2)"), at("(refused, not made: too near  to the clamp )"));
    EXPECT_LT(at("too near"), at("(line 4)"));
    EXPECT_LT(at("(line 4)"), at("(refused, not made: again)"));
    EXPECT_NE(at("G0 X60.000000"), std::string::npos); // the last one is a motion
    EXPECT_FALSE(app::MotionLog::begin("/no/such/folder/log.ngc", setup).has_value());
}

} // namespace
} // namespace app_test
