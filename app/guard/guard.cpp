#include "app/guard/guard.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/base/math.h"
#include "core/base/platform.h"

namespace app {
namespace {

constexpr int64_t news_after = 500;     // milliseconds
constexpr double least_time = 1e-7;     // seconds
constexpr double turn_tolerance = 0.02; // mm

std::string refusal_text(const feeler_segment& motion, const LiveAnswer& answer, bool is_mdi) {
    std::string text = "Feeler stops before the next motion: ";
    if (is_mdi)
        text = "Feeler stops before this command: ";
    else if (motion.line > 0 && motion.purpose == FEELER_TOOL_CHANGE)
        text = fmt::format("Feeler stops before the way to the tool change, after line {}: ",
                           motion.line);
    else if (motion.line > 0)
        text = fmt::format("Feeler stops before line {}: ", motion.line);
    text += answer.reason;
    if (!answer.cure.empty()) text += " " + answer.cure;
    return text
           + fmt::format(" Abort the {}, then clear the violation to go on.",
                         is_mdi ? "command" : "program");
}

} // namespace

std::vector<std::string> messages_of(const std::string& text) {
    constexpr size_t most = 250;
    std::vector<std::string> messages;
    std::string rest = text;
    while (rest.size() > most) {
        const size_t sentence = rest.rfind(". ", most - 1), blank = rest.rfind(' ', most);
        size_t end = most;
        if (sentence != std::string::npos)
            end = sentence + 1;
        else if (blank != std::string::npos && blank > 0)
            end = blank;
        messages.push_back(rest.substr(0, end));
        rest.erase(0, rest[end] == ' ' ? end + 1 : end);
    }
    if (!rest.empty()) messages.push_back(rest);
    return messages;
}

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

void PermitTimes::add(double seconds) {
    const double steps = core::log(std::max(seconds, least_time) / least_time) / core::log(1.1);
    ++counts_[std::min(static_cast<size_t>(steps), counts_.size() - 1)];
    ++all_;
}

double PermitTimes::within(double share) const {
    uint64_t seen = 0;
    for (size_t i = 0; i < counts_.size(); ++i) {
        seen += counts_[i];
        if (seen > 0 && static_cast<double>(seen) >= share * static_cast<double>(all_))
            return least_time * core::pow(1.1, static_cast<double>(i + 1));
    }
    return 0.0;
}

bool claim(feeler_ring& ring) {
    uint64_t owner = feeler_load(&ring.process);
    const uint64_t own = core::platform::process_id();
    if (owner == own) return true;
    if (owner != 0 && core::platform::is_running(static_cast<unsigned>(owner))) return false;
    return __atomic_compare_exchange_n(&ring.process, &owner, own, false, __ATOMIC_ACQ_REL,
                                       __ATOMIC_ACQUIRE);
}

Guard::Guard(const core::Setup& setup, feeler_ring& ring, double unit, double feed_tolerance,
             ControlKinematics kinematics, bool speed_by_hand)
    : ring_(ring), check_(setup, std::move(kinematics), speed_by_hand) {
    ring_.feed_tolerance = feed_tolerance / unit;
    ring_.turn_tolerance = std::min(feed_tolerance, turn_tolerance) / unit;
    cleared_ = feeler_load(&ring_.cleared);
    ended_ = feeler_load(&ring_.ended);
    is_latched_ = feeler_load(&ring_.latched) != 0;
    waits_refused_ = feeler_load(&ring_.refused) > feeler_load(&ring_.dropped);
    if (is_latched_ || waits_refused_) check_.refuse_until_drop();
    check_.after_motion = [this](const LiveMotion& motion) {
        if (after_motion) after_motion(motion);
    };
    // What an earlier guard has read and not permitted is checked again.
    session_ = ring_.session;
    last_permit_ = feeler_load(&ring_.permitted);
    uint64_t permitted = feeler_permitted_number(last_permit_);
    if (last_permit_ != feeler_permit(session_, permitted)
        || permitted > feeler_load(&ring_.written)) {
        permitted = 0;
        last_permit_ = feeler_permit(session_, permitted);
        feeler_store(&ring_.permitted, last_permit_);
    }
    feeler_store(&ring_.read, permitted);
}

/// Takes note of a violation that the operator has cleared, and of programs that feeler_tp ended.
void Guard::follow_operator() {
    const uint64_t ended = feeler_load(&ring_.ended);
    if (ended != std::exchange(ended_, ended) && tell)
        tell(
            "Feeler has ended the program: LinuxCNC's kinematics, their pins or an external offset "
            "changed while motions were queued.");
    const uint64_t cleared = feeler_load(&ring_.cleared);
    if (cleared == cleared_) return;
    cleared_ = cleared;
    if (!is_latched_) return;
    is_latched_ = false;
    feeler_store(&ring_.latched, 0);
    const bool has_motions = feeler_load(&ring_.dropped) < feeler_load(&ring_.written);
    if (tell)
        tell(check_.is_refused() && has_motions
                 ? "Feeler: the violation is cleared. Abort the program or command to go on."
                 : "Feeler: the violation is cleared.");
}

bool Guard::may_permit(const feeler_segment& motion) {
    std::string why = objection ? objection(motion) : std::string();
    if (why.empty() && feeler_load(&ring_.external) != 0)
        why = "An external offset is in use. Set it back to 0.";
    const int64_t now = core::platform::steady_milliseconds();
    if (why != reason_) {
        reason_ = why;
        since_ = now;
    }
    // What passes at once is no news for the operator. What was aborted and is tried again is.
    const uint64_t dropped = feeler_load(&ring_.dropped);
    const bool is_news = reason_ != told_ || (!reason_.empty() && dropped != told_at_drop_);
    if (!is_news || (!reason_.empty() && now - since_ < news_after)) return reason_.empty();
    told_ = reason_;
    told_at_drop_ = dropped;
    if (tell)
        tell(told_.empty() ? "Feeler: motions are permitted again." : "Feeler holds: " + told_);
    return reason_.empty();
}

/// Whether the first motion can be checked: those that an earlier guard has permitted are complete,
/// since this one does not know how they end.
bool Guard::can_begin() const {
    const uint64_t permitted = feeler_permitted_number(last_permit_);
    const bool has_all =
        feeler_load(&ring_.released) >= permitted || feeler_load(&ring_.dropped) >= permitted;
    return has_all && feeler_load(&ring_.busy) == 0;
}

void Guard::permit(uint64_t number) {
    is_disturbed_ = is_disturbed_ || feeler_load(&ring_.permitted) != last_permit_;
    if (is_disturbed_) return;
    ++permitted_;
    last_permit_ = feeler_permit(session_, number);
    feeler_store(&ring_.permitted, last_permit_);
}

bool Guard::step() {
    constexpr size_t cuts_at_a_time = 16;
    feeler_store(&ring_.alive, ring_.alive + 1);
    if (!std::exchange(has_said_latch_, true) && tell) {
        if (is_latched_)
            tell("Feeler: an earlier violation is not cleared yet, so only motions that lose no "
                 "clearance are permitted.");
        else if (waits_refused_)
            tell("Feeler: what waits was refused before. Abort the program or command to go on.");
    }
    follow_operator();
    const uint64_t next = ring_.read + 1;
    if (feeler_load(&ring_.written) < next) {
        check_.catch_up(feeler_load(&ring_.made) + 1, cuts_at_a_time);
        return false;
    }
    const LiveMotion motion = check_.read(ring_.segment[next % FEELER_RING_SEGMENTS]);
    const bool is_dropped =
        next <= feeler_load(&ring_.dropped) && next > feeler_load(&ring_.released);
    is_disturbed_ =
        is_disturbed_ || motion.number != next || feeler_load(&ring_.permitted) != last_permit_;
    if (is_disturbed_) return false;
    has_begun_ = has_begun_ || can_begin();
    if (!is_dropped && (!has_begun_ || !may_permit(motion))) return false;
    if (!is_dropped) judge(motion);
    feeler_store(&ring_.read, next);
    return true;
}

void Guard::judge(const LiveMotion& motion) {
    const bool follows_refusal = check_.is_refused() && !is_after_drop(motion);
    const double begin = core::platform::thread_cpu_seconds();
    const LiveAnswer answer = is_latched_ ? check_.judge_retreat(motion) : check_.judge(motion);
    times_.add(core::platform::thread_cpu_seconds() - begin);
    if (answer.may_move) {
        permit(motion.number);
    } else if (!follows_refusal) {
        ++refused_;
        is_latched_ = true;
        feeler_store(&ring_.latched, 1);
        feeler_store(&ring_.refused, motion.number);
        if (tell) tell(refusal_text(motion, answer, is_mdi && is_mdi()));
        if (after_refusal) after_refusal(motion, answer);
    }
}

} // namespace app
