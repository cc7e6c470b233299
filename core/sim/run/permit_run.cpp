#include "core/sim/run/permit_run.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace core {
namespace {

/// Speeds that differ by less are equal, mm/s.
constexpr double same_speed = 1e-9;

/// A machine that brakes towards a point has reached it below this speed, mm/s.
constexpr double creeping = 1e-6;

bool has_no_length(const MotionTime& time) { return !(time.length > 0.0); }

/// Planned speed after a length `along` of a motion.
double planned_speed(const MotionTime& time, double along) {
    if (has_no_length(time)) return 0.0;
    const double a = time.acceleration;
    if (!std::isfinite(a)) return time.cruise;
    const double up = time.enter * time.enter + 2.0 * a * along;
    const double down = time.leave * time.leave + 2.0 * a * (time.length - along);
    return std::min(time.cruise, std::sqrt(std::max(0.0, std::min(up, down))));
}

/// Length of a motion that is covered after `seconds` by plan.
double covered(const MotionTime& time, double seconds) {
    if (has_no_length(time)) return 0.0;
    const double a = time.acceleration;
    const double rising = (time.cruise - time.enter) / a, falling = (time.cruise - time.leave) / a;
    const double left = time.duration - seconds;
    if (left <= 0.0) return time.length;
    if (seconds < rising) return seconds * (time.enter + 0.5 * a * seconds);
    if (left < falling) return time.length - left * (time.leave + 0.5 * a * left);
    return std::min(time.length, (rising > 0.0 ? 0.5 * rising * (time.enter + time.cruise) : 0.0)
                                     + (seconds - rising) * time.cruise);
}

/// Planned time after a length `along` of a motion, seconds from its start.
double moment_of(const MotionTime& time, double along) {
    return has_no_length(time) ? 0.0 : time.moment(along);
}

/// Advances a machine by one set point.
class Tick {
public:
    explicit Tick(PermitRun& run) : run_(run) {}

    void go(uint32_t permitted) {
        note_permits(permitted);
        note_due();
        if (run_.is_delayed && !must_brake() && run_.speed >= planned() - same_speed) catch_up();
        if (!run_.is_delayed && must_brake()) start_braking();
        if (run_.motion < run_.seen) {
            double& entered = run_.entries[run_.motion].entered;
            entered = std::min(entered, run_.time());
            run_.is_delayed ? follow() : keep_to_plan();
        }
        ++run_.ticks;
    }

private:
    double lag() const { return 3.0 * run_.servo.period + run_.servo.latency; }
    const MotionTime& motion(size_t i) const { return run_.motions[i].time; }
    /// Whether a permit is due but missing.
    bool is_late() const { return run_.seen < run_.due; }
    /// Planned speed at the current position.
    double planned() const {
        return run_.servo.feed
               * planned_speed(motion(run_.motion), run_.position() - run_.starts[run_.motion]);
    }
    bool must_brake() const { return is_late() && bearable_speed() < planned(); }

    void note_permits(uint32_t permitted) {
        for (; run_.seen < run_.motions.size() && run_.motions[run_.seen].segment < permitted;
             ++run_.seen)
            run_.entries[run_.seen].seen = run_.time();
    }

    void note_due() {
        if (run_.is_held()) return fall_due(run_.motion);
        const MotionTime& now = motion(run_.motion);
        if (has_no_length(now)) {
            if (now.duration - run_.into <= run_.servo.feed * lag()) fall_due(run_.motion + 1);
            return;
        }
        const double position = run_.position(), speed = run_.speed_now();
        const auto way_to_stop = [&](double a) { return speed * (0.5 * speed / a + lag()); };
        double weakest = now.acceleration; // from here to motion i
        for (size_t i = run_.motion + 1; i < run_.motions.size(); ++i) {
            const double left = run_.starts[i] - position;
            if (left > way_to_stop(run_.weakest)) return;
            if (left <= way_to_stop(weakest)) fall_due(i);
            if (has_no_length(motion(i))) return; // the machine stops there anyway
            weakest = std::min(weakest, motion(i).acceleration);
        }
    }

    /// Permits fall due in order.
    void fall_due(size_t i) {
        for (; run_.due <= i && run_.due < run_.motions.size(); ++run_.due)
            if (run_.due > 0) run_.entries[run_.due].due = run_.time();
    }

    void start_braking() {
        run_.along = covered(motion(run_.motion), run_.into);
        run_.speed = run_.speed_now();
        run_.is_delayed = true;
    }
    void catch_up() {
        run_.into = moment_of(motion(run_.motion), run_.along);
        run_.is_delayed = false;
    }

    /// Begins the next motion; false if there is none or its permit is missing.
    bool enter_next(double when) {
        if (++run_.motion == run_.motions.size()) return false;
        run_.into = run_.along = 0.0;
        fall_due(run_.motion);
        if (run_.motion < run_.seen) {
            run_.entries[run_.motion].entered = when;
            return true;
        }
        run_.is_delayed = true;
        run_.speed = 0.0;
        return false;
    }

    void keep_to_plan() {
        double left = run_.servo.feed * run_.servo.period;
        while (true) {
            const double rest = motion(run_.motion).duration - run_.into;
            if (rest > left) {
                run_.into += left;
                return;
            }
            left -= rest;
            if (!enter_next(run_.time() + run_.servo.period - left / run_.servo.feed)) return;
        }
    }

    /// Highest speed from which the machine can still stop before the first motion without a
    /// permit.
    double bearable_speed() const {
        if (!is_late()) return infinity;
        const double left = std::max(0.0, run_.starts[run_.seen] - run_.position());
        double a = infinity;
        for (size_t i = run_.motion; i < run_.seen; ++i) a = std::min(a, motion(i).acceleration);
        if (!std::isfinite(a)) return left / lag();
        return 2.0 * left / (lag() + std::sqrt(lag() * lag() + 2.0 * left / a));
    }

    void follow() {
        const double period = run_.servo.period;
        const double faster = run_.speed + motion(run_.motion).acceleration * period;
        const double bearable = bearable_speed();
        run_.speed = std::min({faster, planned(), bearable});
        if (is_late() && bearable < creeping) { // and less than 1e-6 mm before that point
            while (enter_next(run_.time() + period)) {
            }
            return;
        }
        double way = run_.speed * period;
        while (way > 0.0) {
            const double rest = motion(run_.motion).length - run_.along;
            if (rest > way) {
                run_.along += way;
                return;
            }
            way -= rest;
            const double fraction = run_.speed > 0.0 ? way / run_.speed : 0.0;
            if (!enter_next(run_.time() + period - fraction)) return;
            if (has_no_length(motion(run_.motion))) {
                run_.is_delayed = false;
                return;
            }
        }
    }

    PermitRun& run_;
};

} // namespace

double PermitRun::position() const {
    if (is_done()) return starts.back();
    return starts[motion] + (is_delayed ? along : covered(motions[motion].time, into));
}

double PermitRun::speed_now() const {
    if (is_done() || (!is_delayed && motion >= seen)) return 0.0;
    if (is_delayed) return speed;
    const MotionTime& now = motions[motion].time;
    return servo.feed * planned_speed(now, covered(now, into));
}

double PermitRun::waited() const {
    if (is_done()) return 0.0;
    const MotionTime& now = motions[motion].time;
    const double by_plan = times[motion] + (is_delayed ? moment_of(now, along) : into);
    return time() - by_plan / servo.feed;
}

PermitRun permit_run(std::vector<PermitMotion> motions, const ServoTiming& servo) {
    PermitRun run;
    run.servo = servo;
    run.starts = run.times = {0.0};
    for (const PermitMotion& motion : motions) {
        run.starts.push_back(run.starts.back() + motion.time.length);
        run.times.push_back(run.times.back() + motion.time.duration);
        if (!has_no_length(motion.time))
            run.weakest = std::min(run.weakest, motion.time.acceleration);
    }
    run.entries.resize(motions.size());
    run.motions = std::move(motions);
    return run;
}

void step(PermitRun& run, uint32_t permitted) {
    if (run.is_done()) return;
    Tick(run).go(permitted);
}

} // namespace core
