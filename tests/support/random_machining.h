#pragma once

#include <vector>

#include "core/sim/run/simulator.h"
#include "core/sim/setup.h"
#include "tests/support/random_setup.h"

namespace test_support {

/// The events of a block and the corresponding true passages.
struct KnownBlock {
    std::vector<core::Event> events;
    std::vector<TruePassage> passages;
    bool is_cycle = false;
};

/// Generates random blocks above, in and next to a stock, without regard to collisions.
class RandomMachining {
public:
    RandomMachining(Dice& dice, const KnownSetup& known) : dice_(dice), known_(known) {
        for (const core::Fixture& fixture : known.setup.fixtures)
            there_.push_back(fixture.is_there);
        tip_ = {0, 0, known.box.max.z + 5.0};
        at_ = values_at(tip_, 0.0, 0.0);
    }

    const core::AxisValues& current() const { return at_; }

    KnownBlock next() {
        KnownBlock block;
        const size_t parts = dice_.chance(0.75) ? 1 : 1 + dice_.index(4);
        block.is_cycle = parts > 1 && dice_.chance(0.5);
        for (size_t i = 0; i < parts; ++i) {
            if (dice_.chance(0.06)) change_tool(block);
            if (dice_.chance(0.06)) change_spindle(block);
            if (dice_.chance(0.05)) change_fixture(block);
            if (dice_.chance(0.02)) jump();
            add_motion(block);
        }
        return block;
    }

private:
    const TrueTool& tool() const { return known_.tools.at(number_); }

    core::AxisValues values_at(const core::Vec3& tip, double a, double c) const {
        core::AxisValues at{};
        at[3] = a, at[5] = c;
        const core::Vec3 p =
            machine_position(known_.world.machine, known_.world.stock_mount, at, tip);
        at[0] = p.x, at[1] = p.y, at[2] = p.z + tool().length;
        return at;
    }

    core::AxisPosition position(const core::AxisValues& values) const {
        core::AxisPosition position;
        for (size_t i = 0; i < core::axis_count; ++i)
            if (known_.setup.machine.axes[i].present) position[i] = values[i];
        return position;
    }

    void change_tool(KnownBlock& block) {
        number_ = core::ToolNumber{1 + int(dice_.index(3))};
        block.events.push_back(core::ToolChange{number_});
    }
    void change_spindle(KnownBlock& block) {
        core::SpindleChange to{core::SpindleDirection::clockwise, 1e4};
        if (dice_.chance(0.2)) to.direction = core::SpindleDirection::stopped;
        if (dice_.chance(0.1)) to.speed = 0.0;
        turns_ = to.direction == core::SpindleDirection::clockwise && to.speed > 0.0;
        block.events.push_back(to);
    }
    void change_fixture(KnownBlock& block) {
        if (there_.empty()) return;
        const size_t fixture = dice_.index(there_.size());
        there_[fixture] = dice_.chance(0.6);
        block.events.push_back(core::FixtureChange{fixture, there_[fixture]});
        if (there_[fixture]) add_passage(block, {at_, at_}, false);
    }
    /// Moves the machine to another position without an event.
    void jump() {
        tip_ = dice_.within(known_.box.grown(10.0)) + core::Vec3(0, 0, 8);
        at_ = values_at(tip_, at_[3], at_[5]);
    }

    /// Drills cut along their axis only.
    bool cuts_along(const core::Motion& motion) const {
        return turns_ && core::cuts_along(known_.setup.tools.at(number_), motion);
    }

    void add_passage(KnownBlock& block, const TruePath& path, bool chips) {
        block.passages.push_back({&tool(), path, chips, there_});
    }

    core::Vec3 next_tip() {
        const double d = known_.setup.tools.at(number_).description.diameter;
        if (dice_.chance(0.2)) return last_[1]; // back to where it was
        if (dice_.chance(0.15)) {
            // Next to the previous path, close enough to leave a fin.
            const core::Vec3 way = last_[0] - last_[1];
            const core::Vec3 side = glm::length(way) > 0.1
                                        ? glm::normalize(glm::cross(way, core::Vec3(0.1, 0.2, 1)))
                                        : core::Vec3(1, 0, 0);
            return last_[dice_.index(2)]
                   + side * (d + known_.setup.mesh_size * dice_.between(0.0, 0.8));
        }
        constexpr double steps[] = {0.1, 0.6, 4.0, 20.0};
        const double step = steps[dice_.index(4)];
        core::Vec3 to = tip_;
        for (int axis = 0; axis < 3; ++axis)
            if (dice_.chance(0.6)) to[axis] += step * dice_.between(-1.0, 1.0);
        const core::Aabb box = known_.box.grown(8.0);
        return glm::clamp(to, core::Vec3(box.min.x, box.min.y, known_.box.min.z - 2.0),
                          core::Vec3(box.max.x, box.max.y, known_.box.max.z + 4.0));
    }

    void add_motion(KnownBlock& block) {
        const bool rapid = dice_.chance(0.3);
        if (!rapid && dice_.chance(0.12)) return add_arc(block);
        const core::Vec3 to = next_tip();
        double a = at_[3], c = at_[5];
        if (known_.setup.machine.has_rotary() && dice_.chance(0.3)) {
            const double most = dice_.chance(0.8) ? 5.0 : 60.0;
            a = std::clamp(a + dice_.between(-most, most), -100.0, 100.0);
            c += dice_.between(-most, most);
        }
        const core::AxisValues there = values_at(to, a, c);
        core::Motion motion{.kind = rapid ? core::MotionKind::rapid : core::MotionKind::feed,
                            .from = position(at_),
                            .to = position(there)};
        motion.feed = rapid ? 0.0 : 800.0;
        block.events.push_back(motion);
        if (rapid && known_.setup.machine.rapid == core::RapidStyle::dogleg)
            add_dogleg(block, there);
        else
            add_passage(block, {at_, there}, !rapid && cuts_along(motion));
        arrive(there, to);
    }

    void arrive(const core::AxisValues& there, const core::Vec3& tip) {
        at_ = there;
        last_[1] = tip_;
        last_[0] = tip_ = tip;
    }

    /// Each axis at its own speed, arbitrary where none is given.
    void add_dogleg(KnownBlock& block, const core::AxisValues& there) {
        core::AxisValues arrival{};
        std::vector<double> bends;
        for (size_t i = 0; i < core::axis_count; ++i) {
            const double speed =
                known_.setup.machine.axes[i].rapid.value_or(dice_.between(2e3, 3e4));
            if (there[i] != at_[i])
                bends.push_back(arrival[i] = std::abs(there[i] - at_[i]) / speed);
        }
        std::sort(bends.begin(), bends.end());
        core::AxisValues here = at_;
        for (const double bend : bends) {
            core::AxisValues next = there;
            for (size_t i = 0; i < core::axis_count; ++i)
                if (bend < arrival[i]) next[i] = at_[i] + (there[i] - at_[i]) * (bend / arrival[i]);
            add_passage(block, {here, next}, false);
            here = next;
        }
        if (bends.empty()) add_passage(block, {at_, there}, false);
    }

    void add_arc(KnownBlock& block) {
        core::ArcPath arc{.normal = dice_.chance(0.8) ? 2 : int(dice_.index(3))};
        const double r = dice_.between(0.5, 6.0), start = dice_.between(0.0, 6.28);
        const int u = (arc.normal + 1) % 3, v = (arc.normal + 2) % 3;
        for (int i = 0; i < 3; ++i) arc.centre[i] = at_[size_t(i)];
        arc.centre[u] += r * std::cos(start), arc.centre[v] += r * std::sin(start);
        arc.angle = dice_.between(0.1, 6.5) * (dice_.chance(0.5) ? 1.0 : -1.0);
        TruePath path{at_, at_, arc};
        core::AxisValues there = path.at(1.0);
        if (dice_.chance(0.5)) there[size_t(arc.normal)] += dice_.between(-4.0, 3.0);
        path.to = there;
        core::Motion motion{.kind = core::MotionKind::arc,
                            .from = position(at_),
                            .to = position(there),
                            .arc = arc,
                            .feed = 800.0};
        block.events.push_back(motion);
        add_passage(block, path, cuts_along(motion));
        arrive(there, mounted_place(known_.world.machine, known_.world.stock_mount, there,
                                    {there[0], there[1], there[2] - tool().length}));
    }

    Dice& dice_;
    const KnownSetup& known_;
    core::ToolNumber number_{1};
    bool turns_ = true;
    std::vector<bool> there_;
    core::Vec3 tip_ = core::Vec3(0.0);
    core::AxisValues at_{};
    core::Vec3 last_[2] = {core::Vec3(0.0), core::Vec3(10, 0, 0)};
};

} // namespace test_support
