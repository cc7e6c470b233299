#include "app/guard/guard.h"

#include <fmt/format.h>

#include "core/base/platform.h"

namespace app {
namespace {

constexpr int64_t news_after = 500; // milliseconds

std::string refusal_text(const feeler_segment& motion, const LiveAnswer& answer) {
    std::string text = fmt::format("Feeler stops before line {}: {}", motion.line, answer.reason);
    if (!answer.cure.empty()) text += " " + answer.cure;
    return text + " Abort the program to go on.";
}

} // namespace

std::string why_unknown(const feeler_ring& ring) {
    if (__atomic_load_n(&ring.magic, __ATOMIC_ACQUIRE) != FEELER_RING_MAGIC)
        return "feeler_tp is not loaded";
    if (ring.version != FEELER_RING_VERSION || ring.bytes != sizeof(feeler_ring)
        || ring.segments != FEELER_RING_SEGMENTS)
        return fmt::format("feeler_tp has version {} of the ring, and this program knows version "
                           "{}: install both from one release",
                           ring.version, FEELER_RING_VERSION);
    return {};
}

Guard::Guard(const core::Setup& setup, feeler_ring& ring, double unit, double most_override)
    : ring_(ring), check_(setup, most_override), unit_(unit) {
    cleared_ = feeler_load(&ring_.cleared);
    is_latched_ = feeler_load(&ring_.latched) != 0;
    check_.after_motion = [this](const feeler_segment& motion) {
        if (after_motion) after_motion(motion);
    };
    // What an earlier guard has read and not permitted is checked again.
    feeler_store(&ring_.read, feeler_load(&ring_.permitted));
}

/// Takes note of a violation that the operator has cleared.
void Guard::follow_operator() {
    const uint64_t cleared = feeler_load(&ring_.cleared);
    if (cleared == cleared_) return;
    cleared_ = cleared;
    if (!is_latched_) return;
    is_latched_ = false;
    feeler_store(&ring_.latched, 0);
    if (tell) tell("Feeler: the violation is cleared.");
}

bool Guard::may_permit() {
    std::string why = objection ? objection() : std::string();
    const int64_t now = core::platform::steady_milliseconds();
    if (why != reason_) {
        reason_ = why;
        since_ = now;
    }
    // What passes at once is no news for the operator.
    if (reason_ == told_ || (!reason_.empty() && now - since_ < news_after)) return reason_.empty();
    told_ = reason_;
    if (tell)
        tell(told_.empty() ? "Feeler: motions are permitted again." : "Feeler holds: " + told_);
    return reason_.empty();
}

bool Guard::step() {
    constexpr size_t cuts_at_a_time = 16;
    feeler_store(&ring_.alive, ring_.alive + 1);
    follow_operator();
    const uint64_t next = ring_.read + 1;
    if (feeler_load(&ring_.written) < next) {
        check_.catch_up(feeler_load(&ring_.made) + 1, cuts_at_a_time);
        return false;
    }
    const feeler_segment motion = in_mm(ring_.segment[next % FEELER_RING_SEGMENTS], unit_);
    const bool is_dropped =
        next <= feeler_load(&ring_.dropped) && next > feeler_load(&ring_.released);
    if (!is_dropped && !may_permit()) return false;
    if (!is_dropped) judge(motion);
    feeler_store(&ring_.read, next);
    return true;
}

void Guard::judge(const feeler_segment& motion) {
    const bool follows_refusal = check_.is_refused() && !is_after_drop(motion);
    const LiveAnswer answer = is_latched_ ? check_.judge_retreat(motion) : check_.judge(motion);
    if (answer.may_move) {
        ++permitted_;
        feeler_store(&ring_.permitted, motion.number);
    } else if (!follows_refusal) {
        ++refused_;
        is_latched_ = true;
        feeler_store(&ring_.latched, 1);
        if (tell) tell(refusal_text(motion, answer));
        if (after_refusal) after_refusal(motion, answer);
    }
}

} // namespace app
