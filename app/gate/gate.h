#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "app/gate/grbl_protocol.h"
#include "app/gate/line_check.h"

namespace app {

/// Stands between a sender and a controller that speak Grbl's protocol, and lets a line pass when
/// it is proven clear. The sender talks to it as to Grbl itself: replies come in the order of its
/// lines, and bytes that act at once pass at once.
///
/// A line that may not be sent is answered with a message and error:9. Then nothing passes that
/// could move the machine, until $X or a soft reset. What the sender had sent before is finished.
class Gate {
public:
    /// How the gate reaches the others.
    struct Links {
        std::function<void(std::string_view)> to_sender, to_controller;
        std::function<void(const std::string&)> note; // for whoever watches the gate itself
        /// Does the work in another thread, in order, and then calls `done` in the gate's own.
        std::function<void(std::function<void(LineCheck&)> work, std::function<void()> done)> run;
    };

    explicit Gate(Links links) : links_(std::move(links)) {}

    void sender_came();
    void sender_left();
    void from_sender(std::string_view bytes);
    void from_controller(std::string_view bytes);
    /// To be called about ten times a second. `now`: milliseconds of a steady clock.
    void tick(int64_t now);

    uint64_t passed() const { return passed_; }
    uint64_t refused() const { return refused_; }

private:
    enum class Stage : uint8_t { waiting, checking, ready, sent, answered };
    struct Line {
        std::string text; // as Grbl reads it
        GrblLine kind = GrblLine::empty;
        Stage stage = Stage::waiting;
        uint64_t number = 0; // of those that were checked
        LineVerdict verdict{};
        std::string reply{}; // once it is answered, without its line end
    };
    using LinePointer = std::shared_ptr<Line>;
    /// What the controller has not answered yet.
    struct Sent {
        LinePointer line; // null: a request of the gate itself
        size_t bytes = 0;
    };
    enum class Asking : uint8_t { nothing, status, facts, check };

    void act_at_once(char byte);
    void cancel_jogs();
    void take_line();
    void take_reply(const std::string& text);
    void take_answer(const std::string& text);
    void take_status(const GrblStatus& status);
    void compare_place(const GrblStatus& status);
    core::Vec3 place_of(const core::Vec3& wpos) const;
    void take_reset();
    void take_alarm(const std::string& text);

    void go_on();
    bool handle_next();
    bool handle_motion(const LinePointer& line);
    bool handle_own_command(const LinePointer& line);
    void answer(const LinePointer& line, std::string reply);
    void refuse(const LinePointer& line, const LineVerdict& verdict);
    void take_verdict(const LinePointer& line, LineVerdict verdict);
    void flush_replies();
    void send_ready();
    void send_line(const LinePointer& line);
    static bool is_plain(const Line& line);
    static bool takes_its_time(const Line& line);

    bool needs_asking() const { return changes_ != changes_known_; }
    void ask_control();
    void ask_next_fact();
    void lock_waiting();
    void take_facts();
    void drop_unsent();
    void note_made(const LinePointer& line);
    void note_waited();
    void note_lost_homing();
    void follow();
    void say(const std::string& text);

    Links links_;
    std::string from_sender_, from_controller_; // lines that are not whole yet
    std::deque<LinePointer> lines_;             // of the sender, until their replies are given
    std::deque<Sent> outstanding_;
    bool awaits_reset_ = false; // the sender has reset the controller
    bool is_latched_ = false;   // a line was refused
    bool is_alarmed_ = false;   // Grbl refuses lines by itself
    bool is_derailed_ = false;  // lines after one that Grbl refused are on their way

    // What is known of the control.
    // What makes it necessary to ask it before the next line that may move: counted; known of since
    // it was asked last; and since it is being asked.
    uint64_t changes_ = 1, changes_known_ = 0, changes_asked_for_ = 0;
    bool has_jogged_ = false; // Grbl takes no G-code until the jogs have ended
    bool knows_settings_ = false, was_reset_ = false;
    bool may_be_lost_ = false;            // where the machine is, by a restart
    bool is_lost_ = false;                // by a homing that was not finished
    bool may_have_slipped_ = false;       // steps may be lost, by an alarm in motion or by sleep
    bool is_status_unread_ = false;       // said once
    core::Vec3 was_at_ = core::Vec3(0.0); // when it was asked last, mm
    bool was_asked_ = false;
    bool is_set_up_ = false;                    // as the check says
    bool is_homed_ = false, was_homed_ = false; // since it was started; since it was asked
    bool has_moved_ = false;                    // since then
    bool was_dry_ = false;                      // it was in check mode
    std::string asked_word_;                    // of the operator, to be said again with a number
    int word_number_ = 0;
    std::optional<OperatorWord> word_; // takes effect when the control has been asked
    bool cancels_again_ = false;       // when a jog that is on its way is answered
    bool greets_ = false;              // a new sender
    bool said_no_answer_ = false;
    std::string latch_; // why nothing passes
    size_t jogs_ = 0;   // that may still be in the planner
    Asking asking_ = Asking::nothing;
    size_t next_fact_ = 0;
    bool was_refused_ = false; // one of these requests
    GrblFacts facts_, asked_;
    core::Vec3 position_ = core::Vec3(0.0); // as reported
    // Where the machine stands behind the last line that it has taken, if that is known, mm.
    std::optional<core::Vec3> expected_;
    bool has_changed_offset_ = false; // since it was asked
    bool position_is_of_work_ = false;
    std::string banner_, said_;
    bool is_checking_only_ = false; // Grbl's check mode: nothing moves

    uint64_t epoch_ = 0; // counts what makes answers of the check obsolete
    bool is_judging_ = false, is_following_ = false;
    // Numbers of lines: the last one; of those that were made, are followed in the check, were
    // taken in without jogs.
    uint64_t last_number_ = 0, made_through_ = 0, followed_ = 0, answered_through_ = 0;
    std::deque<uint64_t> in_planner_; // lines that may still be in the planner
    // A dwell or a probing was answered: it has ended, unless the controller was reset meanwhile,
    // which its next word shows. Then all before it was made.
    uint64_t waited_for_ = 0;
    int64_t now_ = 0, last_answer_ = 0, last_heard_ = 0, last_sent_ = 0, asked_status_ = 0,
            last_refusal_ = 0,
            reset_at_ = 0; // ms
    uint64_t passed_ = 0, refused_ = 0;
};

} // namespace app
