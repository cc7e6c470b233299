#include "app/session/permit_timing.h"

#include <algorithm>

namespace app {
namespace {

class TimedRun {
public:
    TimedRun(const std::vector<core::PermitMotion>& plan, const std::vector<BlockService>& services,
             const ControlConfig& control, bool past_refusals)
        : services_(services),
          control_(control),
          past_refusals_(past_refusals),
          machine_(core::permit_run(plan, control.servo)) {
        made_.blocks.resize(services.size());
        made_.planned = machine_.times.back() / control.servo.feed;
    }

    PermitTiming run() {
        while (!machine_.is_done() && !stands_for_good()) {
            ask_ahead();
            permit();
            core::step(machine_, permitted_);
        }
        made_.taken = machine_.time();
        if (machine_.is_done()) ask_for_the_rest();
        conclude();
        return std::move(made_);
    }

private:
    bool is_refused(size_t block) const { return !past_refusals_ && services_[block].refused; }
    bool stands_for_good() const {
        return machine_.is_held() && permitted_ < asked_ && is_refused(permitted_)
               && made_.blocks[permitted_].permitted <= machine_.time();
    }

    /// The control reads on, and the device takes what it has read.
    void ask_ahead() {
        const size_t here =
            machine_.is_done() ? services_.size() : machine_.motions[machine_.motion].segment;
        const size_t end = std::min(services_.size(), here + control_.look_ahead + 1);
        for (; asked_ < end; ++asked_) {
            BlockTiming& block = made_.blocks[asked_];
            block.asked = machine_.time();
            const BlockService& service = services_[asked_];
            block.permitted = permit_time(service, block.asked, last_permit_);
            made_.busy += service.interval;
            last_permit_ = is_refused(asked_) ? core::infinity : block.permitted; // it has stopped
        }
    }

    /// What moves nothing holds no machine up, but may be refused.
    void ask_for_the_rest() {
        ask_ahead();
        while (permitted_ < asked_ && !is_refused(permitted_)) ++permitted_;
    }

    void permit() {
        while (permitted_ < asked_ && !is_refused(permitted_)
               && made_.blocks[permitted_].permitted <= machine_.time())
            ++permitted_;
    }

    void conclude() {
        if (permitted_ < services_.size()) made_.refused = permitted_;
        for (size_t i = machine_.motions.size(); i-- > 0;) { // the first motion of a block last
            BlockTiming& block = made_.blocks[machine_.motions[i].segment];
            block.due = machine_.entries[i].due;
            block.entered = machine_.entries[i].entered;
        }
        for (size_t i = 0; i < made_.blocks.size(); ++i) {
            const BlockTiming& block = made_.blocks[i];
            if (block.due == core::infinity || block.permitted == core::infinity) continue;
            made_.missed += block.is_late();
            if (!made_.tightest || block.slack() < made_.blocks[*made_.tightest].slack())
                made_.tightest = i;
        }
    }

    const std::vector<BlockService>& services_;
    const ControlConfig& control_;
    bool past_refusals_;
    core::PermitRun machine_;
    PermitTiming made_;
    size_t asked_ = 0;
    uint32_t permitted_ = 0;
    double last_permit_ = 0.0;
};

} // namespace

PermitTiming timed_with_permits(const std::vector<core::PermitMotion>& plan,
                                const std::vector<BlockService>& services,
                                const ControlConfig& control, bool past_refusals) {
    return TimedRun(plan, services, control, past_refusals).run();
}

} // namespace app
