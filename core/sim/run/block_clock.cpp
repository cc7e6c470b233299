#include "core/sim/run/block_clock.h"

#include <algorithm>

#include "core/motion/path.h"
#include "core/sim/run/simulator.h"

namespace core {
namespace {

/// A block while its events are added.
struct Adding {
    BlockClock& clock;
    uint32_t tag;
    std::vector<MotionTime> settled = {};

    BlockTime& block() { return clock.open.back(); }

    void rest() { plan_stop(clock.plan, settled); }

    void from_rest_to_rest(double seconds, double at_full_speed) {
        rest();
        MotionTime time;
        time.duration = seconds;
        block().stretches.push_back({at_full_speed, time, true});
    }

    void operator()(const Motion& motion) {
        if (is_dogleg(motion, clock.machine)) {
            const DoglegTime time = dogleg_time(motion, clock.machine);
            return from_rest_to_rest(time.duration, time.at_full_speed);
        }
        const auto path = path_motion(motion, clock.machine);
        if (!path) return;
        block().stretches.push_back({path->length / path->speed, {}, false});
        add_motion(clock.plan, *path, tag, settled);
    }
    void operator()(const Dwell& dwell) { from_rest_to_rest(dwell.seconds, dwell.seconds); }
    void operator()(const ToolChange&) { rest(); }
    void operator()(const SpindleChange&) { rest(); }
    void operator()(const LengthOffsetChange&) {}
    void operator()(const FixtureChange&) { rest(); }
    void operator()(const PathModeChange& change) {
        clock.plan.blending = change.blending;
        clock.plan.tolerance = change.tolerance.value_or(default_blend_tolerance);
    }
};

void enter(BlockClock& clock, const std::vector<MotionTime>& settled) {
    for (const MotionTime& time : settled) {
        BlockTime& block = clock.open[time.tag - clock.first_open];
        const auto waiting = std::find_if(block.stretches.begin(), block.stretches.end(),
                                          [](const BlockStretch& s) { return !s.final; });
        waiting->time = time;
        waiting->final = true;
    }
}

bool is_final(const BlockTime& block) {
    return std::all_of(block.stretches.begin(), block.stretches.end(),
                       [](const BlockStretch& stretch) { return stretch.final; });
}

void give_out(BlockClock& clock, std::vector<BlockTime>& done) {
    while (!clock.open.empty() && is_final(clock.open.front())) {
        BlockTime& block = clock.open.front();
        block.start = clock.time;
        for (const BlockStretch& stretch : block.stretches) block.duration += stretch.time.duration;
        clock.time += block.duration;
        done.push_back(std::move(block));
        clock.open.pop_front();
        ++clock.first_open;
    }
}

} // namespace

double BlockTime::moment(double fraction) const {
    double whole = 0.0;
    for (const BlockStretch& stretch : stretches) whole += stretch.at_full_speed;
    double left = fraction * whole, before = 0.0;
    for (const BlockStretch& stretch : stretches) {
        if (left <= stretch.at_full_speed && stretch.at_full_speed > 0.0) {
            const double part = left / stretch.at_full_speed;
            const MotionTime& time = stretch.time;
            return before
                   + (time.length > 0.0 ? time.moment(part * time.length) : part * time.duration);
        }
        left -= stretch.at_full_speed;
        before += stretch.time.duration;
    }
    return before;
}

BlockClock start_clock(const Machine& machine) {
    BlockClock clock;
    clock.machine = machine;
    clock.plan.limits = limits_of(machine);
    return clock;
}

void add_block(BlockClock& clock, const BlockEvents& block, std::vector<BlockTime>& done) {
    Adding adding{clock, clock.first_open + static_cast<uint32_t>(clock.open.size())};
    clock.open.push_back({.block = block.block});
    for (const Event& event : block.events) std::visit(adding, event);
    enter(clock, adding.settled);
    give_out(clock, done);
}

void stop_clock(BlockClock& clock, std::vector<BlockTime>& done) {
    std::vector<MotionTime> settled;
    plan_stop(clock.plan, settled);
    enter(clock, settled);
    give_out(clock, done);
}

void settle_time(BlockResult& result, const BlockTime& time) {
    for (PairClearance& pair : result.pairs)
        pair.time =
            time.moment(result.duration > 0.0 ? std::min(1.0, pair.time / result.duration) : 0.0);
    result.time = time.start;
    result.duration = time.duration;
}

} // namespace core
