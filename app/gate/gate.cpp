#include "app/gate/gate.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>

namespace app {
namespace {

constexpr int64_t rest = 250;            // ms without an answer until Idle counts as standing still
constexpr int64_t asking_interval = 200; // ms between two requests for the status
constexpr size_t longest_line = 1024;    // bytes
constexpr size_t usual_buffer = 128;     // bytes, of Grbl on an Arduino Uno
constexpr size_t largest_buffer = 1024;  // bytes that are used of a larger one
constexpr size_t behind_planner = 8;     // blocks that have left the planner and are still made
constexpr size_t followed_at_once = 16;  // lines whose cuts are followed before the next check
constexpr int locked_error = 9;          // G-code is locked out
constexpr std::string_view locked = "error:9";
constexpr std::string_view how_to_go_on =
    "To go on, unlock ($X) or reset Grbl, when the machine stands still.";
constexpr std::string_view own_command = "$FEELER";

std::string error_reply(int number) { return fmt::format("error:{}", number); }

} // namespace

void Gate::say(const std::string& text) {
    links_.note("Feeler: " + text);
    links_.to_sender(grbl_message("Feeler: " + text) + "\r\n");
}

// --- the sender -------------------------------------------------------------------------------

void Gate::sender_came() {
    sender_left();
    needs_asking_ = true;
    // As a controller that was reset when its port was opened.
    const bool stands = outstanding_.empty() && made_through_ >= answered_through_;
    if (!banner_.empty() && stands) links_.to_sender(banner_ + "\r\n");
}

void Gate::sender_left() {
    from_sender_.clear();
    drop_unsent();
    lines_.clear(); // what was sent is run, and nobody hears of it
}

void Gate::from_sender(std::string_view bytes) {
    for (const char byte : bytes) {
        if (acts_at_once(byte)) {
            act_at_once(byte);
        } else if (byte == '\n' || byte == '\r') {
            take_line();
        } else if (!is_dropped(byte) && from_sender_.size() <= longest_line) {
            from_sender_ += byte;
        }
    }
    go_on();
}

/// Grbl takes these out of what it receives before anything else.
void Gate::act_at_once(char byte) {
    links_.to_controller(std::string_view(&byte, 1));
    if (byte == soft_reset) {
        awaits_reset_ = true;
        from_sender_.clear();
        drop_unsent();
        lines_.clear();
    }
    if (byte == jog_cancel) {
        drop_unsent();
        if (has_jogged_) answered_through_ = made_through_;
        // Grbl drops the jogs that it has, and these belong to the same movement.
        for (const LinePointer& line : lines_)
            if (line->stage == Stage::waiting && line->kind == GrblLine::jog) answer(line, "ok");
    }
}

void Gate::take_line() {
    auto line = std::make_shared<Line>();
    const bool is_too_long = from_sender_.size() > longest_line;
    line->text = as_grbl_reads(from_sender_);
    line->kind = kind_of(line->text);
    from_sender_.clear();
    if (awaits_reset_) return; // Grbl loses it
    lines_.push_back(line);
    if (is_too_long) answer(line, error_reply(11));
}

void Gate::answer(const LinePointer& line, std::string reply) {
    line->reply = std::move(reply);
    line->stage = Stage::answered;
}

void Gate::flush_replies() {
    for (; !lines_.empty() && lines_.front()->stage == Stage::answered; lines_.pop_front())
        links_.to_sender(lines_.front()->reply + "\r\n");
}

/// What was not sent to the controller yet will not be, or is checked anew.
void Gate::drop_unsent() {
    ++epoch_;
    is_judging_ = false;
    if (asking_ == Asking::check) asking_ = Asking::nothing;
    needs_asking_ = true;
    for (const LinePointer& line : lines_)
        if (line->stage == Stage::checking || line->stage == Stage::ready)
            line->stage = Stage::waiting;
}

// --- lines in their order ---------------------------------------------------------------------

void Gate::go_on() {
    do {
        flush_replies();
        send_ready();
    } while (handle_next());
    flush_replies();
    follow();
}

/// Deals with the next line, if it can be dealt with now. Whether there may be more to do.
bool Gate::handle_next() {
    if (awaits_reset_ || is_judging_) return false;
    const auto found = std::find_if(lines_.begin(), lines_.end(), [](const LinePointer& line) {
        return line->stage == Stage::waiting;
    });
    if (found == lines_.end()) return false;
    const LinePointer line = *found;
    switch (line->kind) {
    case GrblLine::empty:
        answer(line, "ok");
        return true;
    case GrblLine::request:
        if (line->text == "$C") return handle_check_mode(line);
        line->stage = Stage::ready;
        return true;
    case GrblLine::home:
    case GrblLine::unlock:
        needs_asking_ = true;
        if (line->kind == GrblLine::unlock) is_latched_ = false;
        line->stage = Stage::ready;
        return true;
    case GrblLine::other:
        handle_own_command(line);
        return true;
    case GrblLine::code:
    case GrblLine::jog:
        return handle_motion(line);
    }
    return false;
}

/// Grbl answers no questions in this mode, so all must be known before.
bool Gate::handle_check_mode(const LinePointer& line) {
    if (needs_asking_ && !is_checking_only_ && !is_alarmed_) {
        ask_control();
        return false;
    }
    is_checking_only_ = true;
    line->stage = Stage::ready;
    return true;
}

bool Gate::handle_motion(const LinePointer& line) {
    if (is_latched_) {
        answer(line, std::string(locked));
        return true;
    }
    const bool is_jog = line->kind == GrblLine::jog;
    needs_asking_ = needs_asking_ || (has_jogged_ && !is_jog);
    const bool has_unsent = std::any_of(lines_.begin(), lines_.end(), [](const LinePointer& other) {
        return other->stage == Stage::ready;
    });
    // A jog may fail, and what comes after it would then start elsewhere.
    if (is_jog && (!outstanding_.empty() || has_unsent)) return false;
    if (needs_asking_) {
        if (!has_unsent) ask_control();
        return false;
    }
    line->stage = Stage::checking;
    line->number = ++last_number_;
    is_judging_ = true;
    const auto verdict = std::make_shared<LineVerdict>();
    links_.run([verdict, number = line->number, text = line->text,
                is_jog](LineCheck& check) { *verdict = check.judge(number, text, is_jog); },
               [this, line, verdict, epoch = epoch_] {
                   if (epoch != epoch_) return;
                   is_judging_ = false;
                   take_verdict(line, std::move(*verdict));
                   go_on();
               });
    return false;
}

void Gate::take_verdict(const LinePointer& line, LineVerdict verdict) {
    if (verdict.answer.may_move) {
        line->verdict = std::move(verdict);
        line->stage = Stage::ready;
        needs_asking_ =
            needs_asking_ || line->verdict.stops_at_contact || line->verdict.changes_offsets;
        has_jogged_ = has_jogged_ || line->kind == GrblLine::jog;
        return;
    }
    refuse(line, verdict);
}

void Gate::refuse(const LinePointer& line, const LineVerdict& verdict) {
    ++refused_;
    const bool is_jog = line->kind == GrblLine::jog;
    const bool is_understood = verdict.error == locked_error;
    std::string text =
        fmt::format("{} {}: {}", is_jog || !is_understood ? "does not pass" : "stops before",
                    line->text, verdict.answer.reason);
    if (!verdict.answer.cure.empty()) text += " " + verdict.answer.cure;
    const bool latches = is_understood && !is_jog;
    if (latches) text += fmt::format(" {}", how_to_go_on);
    links_.note("Feeler " + text);
    answer(line, grbl_message("Feeler " + text) + "\r\n" + error_reply(verdict.error));
    is_latched_ = is_latched_ || latches;
}

void Gate::handle_own_command(const LinePointer& line) {
    const std::string_view text = line->text;
    if (!text.starts_with(own_command)) {
        answer(line, grbl_message("Feeler: " + line->text
                                  + " does not pass: it could change what is checked. Change "
                                    "settings without the gate.")
                         + "\r\nerror:3");
        return;
    }
    const std::string_view what = text.substr(own_command.size());
    const auto tell = [this](std::string said) { say(said); };
    int tool = 0;
    if (what.starts_with("=T")
        && std::from_chars(what.data() + 2, what.data() + what.size(), tool).ptr
               == what.data() + what.size()) {
        line->stage = Stage::checking;
        needs_asking_ = true;
        const auto problem = std::make_shared<std::string>();
        links_.run(
            [problem, tool](LineCheck& check) {
                if (auto done = check.change_tool(tool); !done) *problem = done.error().message;
            },
            [this, line, problem, tool, tell] {
                if (line->stage != Stage::checking) return;
                if (problem->empty()) tell(fmt::format("tool {} is in the spindle", tool));
                answer(line, problem->empty()
                                 ? "ok"
                                 : grbl_message("Feeler: the set-up " + *problem) + "\r\nerror:3");
                go_on();
            });
        return;
    }
    if (what == "=NEW") {
        needs_asking_ = true;
        links_.run([](LineCheck& check) { check.renew_stock(); }, [] {});
        tell("the stock counts as uncut");
        answer(line, "ok");
        return;
    }
    if (what.empty()) {
        tell(fmt::format("{} lines passed, {} refused{}", passed_, refused_,
                         is_latched_ ? fmt::format(". {}", how_to_go_on) : ""));
        answer(line, "ok");
        return;
    }
    answer(line, grbl_message("Feeler: its commands are $FEELER, $FEELER=T2 (tool 2 is in the "
                              "spindle) and $FEELER=NEW (a new workpiece)")
                     + "\r\nerror:3");
}

/// Sends what may be sent, in order, as far as the controller has room.
void Gate::send_ready() {
    if (awaits_reset_) return;
    size_t used = 0;
    for (const Sent& sent : outstanding_) used += sent.bytes;
    const size_t buffer = std::min(facts_.buffer.value_or(usual_buffer), largest_buffer) - 1;
    for (const LinePointer& line : lines_) {
        if (line->stage == Stage::answered || line->stage == Stage::sent) continue;
        if (line->stage != Stage::ready) return;
        const bool waits = !outstanding_.empty();
        const bool is_alone = !is_plain(*line);
        const bool is_behind_one =
            waits && (!outstanding_.back().line || !is_plain(*outstanding_.back().line));
        if (waits && (is_alone || is_behind_one || used + line->text.size() + 1 > buffer)) return;
        used += line->text.size() + 1;
        send_line(line);
    }
}

/// Whether a line may be sent while others are not answered.
bool Gate::is_plain(const Line& line) {
    return line.kind == GrblLine::request || (line.kind == GrblLine::code && line.verdict.is_plain);
}

void Gate::send_line(const LinePointer& line) {
    line->stage = Stage::sent;
    outstanding_.push_back({line, line->text.size() + 1});
    links_.to_controller(line->text + "\n");
}

// --- the controller ---------------------------------------------------------------------------

void Gate::from_controller(std::string_view bytes) {
    for (const char byte : bytes) {
        if (byte != '\n' && byte != '\r') {
            if (from_controller_.size() < longest_line) from_controller_ += byte;
            continue;
        }
        const std::string text = std::exchange(from_controller_, {});
        if (!text.empty()) take_reply(text);
    }
    go_on();
}

void Gate::take_reply(const std::string& text) {
    if (text == "ok" || text.starts_with("error:")) return take_answer(text);
    if (text.starts_with("Grbl")) { // Grbl 1.1h ['$' for help]; GrblHAL 1.1f ...
        banner_ = text;
        take_reset();
    } else if (text.starts_with("ALARM:")) {
        take_alarm();
    } else if (const auto status = read_status(text)) {
        links_.to_sender(text + "\r\n");
        return take_status(*status);
    } else if (!outstanding_.empty() && !outstanding_.front().line && !text.starts_with("[MSG:")) {
        return asked_.take(text); // an answer to the gate
    }
    links_.to_sender(text + "\r\n");
}

void Gate::take_answer(const std::string& text) {
    last_answer_ = now_;
    if (outstanding_.empty()) {
        links_.note("Feeler: the controller answers where nothing was asked: " + text);
        needs_asking_ = true;
        return;
    }
    const Sent sent = outstanding_.front();
    outstanding_.pop_front();
    if (!sent.line) {
        was_refused_ = was_refused_ || text != "ok";
        return ask_next_fact();
    }
    const LinePointer& line = sent.line;
    const bool was_checked = line->kind == GrblLine::code || line->kind == GrblLine::jog;
    answer(line, text);
    if (text == "ok") {
        if (line->kind == GrblLine::unlock || line->kind == GrblLine::home) is_alarmed_ = false;
        if (was_checked) {
            ++passed_;
            note_made(line);
        }
        return;
    }
    if (line->text == "$C") is_checking_only_ = false;
    if (!was_checked) return;
    // The lines after it were checked as if this one had been run.
    drop_unsent();
    if (line->kind == GrblLine::jog || is_alarmed_) return;
    const bool has_sent_more =
        std::any_of(outstanding_.begin(), outstanding_.end(),
                    [](const Sent& s) { return s.line && s.line->kind == GrblLine::code; });
    is_latched_ = true;
    if (has_sent_more) links_.to_controller(std::string_view(&feed_hold, 1));
    say(fmt::format("Grbl does not run {} ({}), and the gate had expected that it does. {}{}",
                    line->text, text, has_sent_more ? "The feed is held. " : "", how_to_go_on));
}

/// A line was taken in. Lines before it that have left the planner have been made.
void Gate::note_made(const LinePointer& line) {
    if (is_checking_only_ || is_alarmed_ || awaits_reset_) return;
    // Grbl takes jogs when all other motions have ended.
    if (line->kind == GrblLine::jog) made_through_ = std::max(made_through_, last_code_);
    answered_through_ = line->number;
    if (line->kind == GrblLine::code) last_code_ = line->number;
    if (line->verdict.stops_at_contact || line->text.starts_with("G4P")) {
        made_through_ = line->number; // Grbl waits until all motions have ended
        in_planner_.clear();
        return;
    }
    if (!line->verdict.fills_planner || !facts_.planner) return;
    in_planner_.push_back(line->number);
    for (; in_planner_.size() > *facts_.planner + behind_planner; in_planner_.pop_front())
        made_through_ = in_planner_.front();
}

void Gate::take_status(const GrblStatus& status) {
    const bool is_idle = status.state == "Idle";
    const bool stands = outstanding_.empty() && now_ - last_answer_ >= rest;
    if (is_idle && stands && !is_checking_only_) {
        made_through_ = std::max(made_through_, answered_through_);
        in_planner_.clear();
    }
    if (asking_ != Asking::status || !stands) return;
    if (status.state == "Alarm" || status.state == "Sleep") {
        asking_ = Asking::nothing;
        return lock_waiting(); // as Grbl does
    }
    if (status.state == "Check") {
        // Nothing moves, and Grbl answers no questions.
        asking_ = Asking::nothing;
        if (knows_settings_) needs_asking_ = has_jogged_ = false;
        return knows_settings_ ? void() : lock_waiting();
    }
    if (!is_idle) return; // asked again
    if (!status.mpos && !status.wpos) return;
    position_is_of_work_ = !status.mpos;
    position_ = status.mpos ? *status.mpos : *status.wpos;
    asking_ = Asking::facts;
    was_refused_ = false;
    asked_ = {};
    if (knows_settings_) {
        asked_ = facts_;
        asked_.seen = 0;
        asked_.modes.clear();
    }
    next_fact_ = knows_settings_ ? 3 : 0;
    ask_next_fact();
}

void Gate::take_reset() {
    drop_unsent();
    lines_.clear();
    outstanding_.clear();
    in_planner_.clear();
    from_sender_.clear();
    answered_through_ = made_through_; // motions may have been cut off
    asking_ = Asking::nothing;
    awaits_reset_ = is_latched_ = is_alarmed_ = is_checking_only_ = has_jogged_ = false;
    knows_settings_ = false;
    was_reset_ = true;
    said_.clear();
}

void Gate::take_alarm() {
    drop_unsent();
    is_alarmed_ = true;
    in_planner_.clear();
    answered_through_ = made_through_; // motions were cut off
    asking_ = Asking::nothing;
}

// --- asking the controller --------------------------------------------------------------------

/// Asks for the status, and then for all else, once it has answered everything.
void Gate::ask_control() {
    if (asking_ != Asking::nothing || awaits_reset_ || !outstanding_.empty()) return;
    asking_ = Asking::status;
    asked_status_ = now_;
    links_.to_controller(std::string_view(&status_request, 1));
}

/// Refuses what may move and waits until more is known of the control.
void Gate::lock_waiting() {
    for (const LinePointer& line : lines_)
        if (line->stage == Stage::waiting
            && (line->kind == GrblLine::code || line->kind == GrblLine::jog))
            answer(line, std::string(locked));
}

void Gate::ask_next_fact() {
    constexpr std::string_view requests[] = {"$I", "$$", "$N", "$#", "$G"};
    if (asking_ != Asking::facts) return;
    if (next_fact_ == std::size(requests)) return take_facts();
    const std::string_view request = requests[next_fact_++];
    outstanding_.push_back({nullptr, request.size() + 1});
    links_.to_controller(std::string(request) + "\n");
}

void Gate::take_facts() {
    if (was_refused_ || !asked_.has_offsets()) {
        asking_ = Asking::nothing;
        constexpr const char* problem =
            "the controller does not answer $I, $$, $N, $# and $G, so nothing can be checked";
        if (std::exchange(said_, problem) != problem) say(problem);
        return lock_waiting();
    }
    facts_ = asked_;
    facts_.is_reset = std::exchange(was_reset_, false);
    knows_settings_ = true;
    core::Vec3 position = facts_.scaled(position_);
    if (position_is_of_work_)
        position += facts_.zero() + core::Vec3(0.0, 0.0, facts_.length_offset);
    asking_ = Asking::check;
    const auto problem = std::make_shared<std::string>();
    links_.run(
        [problem, facts = facts_, position, made = made_through_](LineCheck& check) {
            const auto done = check.synchronise(facts, position, made);
            *problem = done ? check.objection() : done.error().message;
        },
        [this, problem, epoch = epoch_] {
            if (epoch != epoch_) return;
            asking_ = Asking::nothing;
            needs_asking_ = has_jogged_ = false;
            answered_through_ = made_through_ = followed_ = last_number_;
            if (!problem->empty() && said_ != *problem) say(*problem);
            said_ = *problem;
            go_on();
        });
}

/// Lets the check follow the cuts that were made, a few at a time.
void Gate::follow() {
    if (is_following_ || asking_ == Asking::check || made_through_ <= followed_) return;
    is_following_ = true;
    const auto is_more = std::make_shared<bool>(false);
    links_.run([is_more, made = made_through_](
                   LineCheck& check) { *is_more = check.follow(made, followed_at_once); },
               [this, is_more, made = made_through_] {
                   is_following_ = false;
                   if (!*is_more) followed_ = std::max(followed_, made);
                   follow();
               });
}

void Gate::tick(int64_t now) {
    now_ = now;
    if (asking_ == Asking::status && now_ - asked_status_ >= asking_interval) {
        asked_status_ = now_;
        links_.to_controller(std::string_view(&status_request, 1));
    }
    // Says early what is wrong.
    constexpr int64_t patience = 1000;
    if (!knows_settings_ && now_ - asked_status_ >= patience) ask_control();
    go_on();
}

} // namespace app
