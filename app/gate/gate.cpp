#include "app/gate/gate.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <iterator>
#include <random>
#include <utility>

#include <fmt/format.h>

namespace app {
namespace {

constexpr int64_t rest = 250;            // ms without an answer until Idle counts as standing still
constexpr int64_t asking_interval = 200; // ms between two requests for the status
constexpr int64_t patience = 2000;       // ms
constexpr double least_travel = 0.01;    // mm
constexpr size_t longest_line = 1024;    // bytes
constexpr size_t usual_planner = 15;     // blocks
constexpr size_t usual_buffer = 128;     // bytes, of Grbl on an Arduino Uno
constexpr size_t largest_buffer = 1024;  // bytes that are used of a larger one
constexpr size_t behind_planner = 8;     // blocks that have left the planner and are still made
constexpr size_t followed_at_once = 16;  // lines whose cuts are followed before the next check
constexpr int locked_error = 9;          // G-code is locked out
constexpr std::string_view locked = "error:9";
constexpr std::string_view how_to_go_on =
    "To go on, unlock ($X) or reset Grbl, when the machine stands still.";
constexpr std::string_view own_command = "$FEELER";

std::string leave_check_mode() {
    return grbl_message("Feeler: leave check mode ($C) before you go on.") + "\r\n"
           + std::string(locked);
}

std::string error_reply(int number) { return fmt::format("error:{}", number); }

} // namespace

void Gate::say(const std::string& text) {
    links_.note("Feeler: " + text);
    links_.to_sender(grbl_message("Feeler: " + text) + "\r\n");
}

// --- the sender -------------------------------------------------------------------------------

void Gate::sender_came() {
    sender_left();
    ++changes_;
    greets_ = true; // as a controller that was reset when its port was opened, when it stands still
}

void Gate::sender_left() {
    greets_ = false;
    if (has_jogged_) act_at_once(jog_cancel);
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
    if (byte == stop) { // of grblHAL: it drops lines, and answers none
        links_.to_controller(std::string_view(&feed_hold, 1));
        return say(
            "the gate passes a stop (0x19) as a feed hold. Reset the controller to drop what "
            "waits; a cycle start (~) goes on with it.");
    }
    if (byte == cycle_start && is_derailed_)
        return say("lines would run from the wrong place. Reset Grbl to go on.");
    links_.to_controller(std::string_view(&byte, 1));
    if (byte == soft_reset) {
        awaits_reset_ = true;
        reset_at_ = now_;
        said_no_answer_ = false;
        from_sender_.clear();
        drop_unsent();
        lines_.clear();
    }
    // A hold and an open door cancel jogs, too.
    if (byte == jog_cancel || byte == feed_hold || byte == other_hold || byte == safety_door)
        cancel_jogs();
}

void Gate::cancel_jogs() {
    const auto is_waiting = [](const LinePointer& line) {
        return line->kind == GrblLine::jog && line->stage != Stage::answered;
    };
    if (!has_jogged_ && std::none_of(lines_.begin(), lines_.end(), is_waiting)) return;
    drop_unsent();
    // Grbl may still read one that is on its way, and then run it from another place.
    cancels_again_ = std::any_of(outstanding_.begin(), outstanding_.end(), [](const Sent& sent) {
        return sent.line && sent.line->kind == GrblLine::jog;
    });
    // Grbl drops the jogs that it has, and these belong to the same movement.
    for (const LinePointer& line : lines_)
        if (line->stage == Stage::waiting && line->kind == GrblLine::jog) answer(line, "ok");
}

void Gate::take_line() {
    auto line = std::make_shared<Line>();
    const bool is_too_long = from_sender_.size() > longest_line;
    line->text = as_grbl_reads(from_sender_);
    line->kind = kind_of(line->text);
    from_sender_.clear();
    greets_ = false;           // it does not wait for a greeting
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
    word_.reset();
    if (asking_ == Asking::check) asking_ = Asking::nothing;
    ++changes_;
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
        if (line->text == "$C" && needs_asking() && !is_checking_only_ && !is_alarmed_) {
            ask_control(); // in check mode, Grbl answers no questions
            return false;
        }
        line->stage = Stage::ready;
        return true;
    case GrblLine::home:
    case GrblLine::unlock:
        if (!is_checking_only_) ++changes_;
        if (line->kind == GrblLine::unlock && !is_derailed_) is_latched_ = false;
        line->stage = Stage::ready;
        return true;
    case GrblLine::other:
        return handle_own_command(line);
    case GrblLine::code:
    case GrblLine::jog:
        return handle_motion(line);
    }
    return false;
}

bool Gate::handle_motion(const LinePointer& line) {
    if (is_latched_) {
        const bool is_news = now_ - last_refusal_ >= patience; // not with each line of a program
        last_refusal_ = now_;
        answer(line,
               (is_news ? grbl_message("Feeler: " + latch_) + "\r\n" : "") + std::string(locked));
        return true;
    }
    if (needs_asking() && is_checking_only_) {
        answer(line, leave_check_mode());
        return true;
    }
    const bool is_jog = line->kind == GrblLine::jog;
    // With a full planner, Grbl would run a waiting jog even after a cancel. Of G-code it does not
    // know before all jogs have ended.
    const size_t planner = facts_.planner.value_or(usual_planner);
    const size_t most_jogs = planner > 3 ? planner - 2 : 1;
    const bool was_jogged = is_jog ? jogs_ >= most_jogs : has_jogged_;
    if (was_jogged && !needs_asking()) ++changes_;
    const bool has_unsent = std::any_of(lines_.begin(), lines_.end(), [](const LinePointer& other) {
        return other->stage == Stage::ready;
    });
    // A jog may fail, and what comes after it would then start elsewhere.
    if (is_jog && (!outstanding_.empty() || has_unsent)) return false;
    if (needs_asking()) {
        if (!has_unsent) ask_control();
        return false;
    }
    line->stage = Stage::checking;
    line->number = ++last_number_;
    is_judging_ = true;
    const auto verdict = std::make_shared<LineVerdict>();
    links_.run(
        [verdict, number = line->number, text = line->text, is_jog](LineCheck& check) {
            *verdict = check.judge(number, text, is_jog);
            verdict->end = check.place_ahead();
        },
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
        if (line->verdict.asks_anew) ++changes_;
        has_jogged_ = has_jogged_ || line->kind == GrblLine::jog;
        return;
    }
    if (verdict.asks_first) {
        ++changes_;
        line->stage = Stage::waiting;
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
    if (!latches) return;
    is_latched_ = true;
    last_refusal_ = now_;
    latch_ = fmt::format("{} was refused. {}", line->text, how_to_go_on);
}

namespace {

/// A whole number that is all of a text.
std::optional<int> whole_number(std::string_view text) {
    int value = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
    if (read.ec != std::errc() || read.ptr != text.data() + text.size() || value < 0) return {};
    return value;
}

/// What an own command of the gate says, without the number behind it; empty if it is none.
std::optional<OperatorWord> word_in(std::string_view text) {
    using Kind = OperatorWord::Kind;
    if (text == "$FEELER=SETUP") return OperatorWord{Kind::sets_up, {}};
    if (text == "$FEELER=ZERO") return OperatorWord{Kind::zero_is_set, {}};
    if (text == "$FEELER=NEW") return OperatorWord{Kind::new_workpiece, {}};
    constexpr std::string_view change = "$FEELER=T";
    if (!text.starts_with(change)) return {};
    const auto tool = whole_number(text.substr(change.size()));
    if (!tool) return {};
    return OperatorWord{Kind::sets_up, tool};
}

std::string meaning_of(const OperatorWord& word) {
    using Kind = OperatorWord::Kind;
    if (word.tool)
        return fmt::format("tool {} is in the spindle, and jogs pass unchecked until $FEELER=ZERO",
                           *word.tool);
    switch (word.kind) {
    case Kind::sets_up:
        return "jogs pass unchecked until $FEELER=ZERO";
    case Kind::zero_is_set:
        return "the zero is set, and the work is where the set-up says";
    case Kind::new_workpiece:
        return "a new workpiece is in its place, and the zero is set";
    }
    return {};
}

/// A number that nobody can know before.
int drawn_number() {
    std::random_device source;
    return std::uniform_int_distribution<int>(100, 999)(source);
}

} // namespace

/// Whether there may be more to do.
bool Gate::handle_own_command(const LinePointer& line) {
    const std::string_view text = line->text;
    if (text == own_command) {
        const std::string state = is_latched_      ? latch_
                                  : !said_.empty() ? said_
                                  : knows_settings_ && is_set_up_ && !needs_asking()
                                      ? "Motions are checked."
                                      : "The controller will be asked before the next motion.";
        say(fmt::format("{} lines passed, {} refused. {}", passed_, refused_, state));
        answer(line, "ok");
        return true;
    }
    const size_t dash = text.find('-');
    const auto word = word_in(text.substr(0, dash));
    const auto refuse_it = [&](const std::string& why) {
        answer(line, grbl_message("Feeler: " + why) + "\r\nerror:3");
        return true;
    };
    const bool is_command = text.starts_with('$') || text.starts_with('[');
    if (!is_command) return refuse_it("Grbl does not understand " + line->text + ".");
    if (!text.starts_with(own_command))
        return refuse_it(
            line->text
            + " does not pass. Change settings, and run files of the controller, without "
              "the gate.");
    if (!word)
        return refuse_it("its commands are $FEELER, $FEELER=SETUP, $FEELER=T2 (and other tools), "
                         "$FEELER=ZERO and $FEELER=NEW.");
    if (is_checking_only_) {
        answer(line, leave_check_mode());
        return true;
    }
    // A program must not be able to say it.
    if (dash == std::string_view::npos) {
        asked_word_ = line->text;
        word_number_ = drawn_number();
        say(fmt::format("send {}-{} if {}.", line->text, word_number_, meaning_of(*word)));
        answer(line, "ok");
        return true;
    }
    if (word_ && !needs_asking()) { // it has taken effect
        const bool is_done = is_set_up_ || word_->kind == OperatorWord::Kind::sets_up;
        word_.reset();
        if (said_.empty()) say("the zero is set, and motions are checked.");
        answer(line, is_done ? "ok" : "error:3");
        return true;
    }
    if (word_) { // it takes effect when the control has been asked
        ask_control();
        return false;
    }
    const bool is_right = text.substr(0, dash) == std::exchange(asked_word_, {})
                          && whole_number(text.substr(dash + 1)) == word_number_;
    if (!is_right)
        return refuse_it(
            fmt::format("send {} first, and then the number that it shows.", text.substr(0, dash)));
    is_judging_ = true;
    const auto problem = std::make_shared<std::string>();
    links_.run([problem, word = *word](LineCheck& check) { *problem = check.why_not(word); },
               [this, line, problem, word, epoch = epoch_] {
                   if (epoch != epoch_) return;
                   is_judging_ = false;
                   if (problem->empty()) {
                       word_ = word;
                       ++changes_;
                   } else {
                       answer(line, grbl_message("Feeler: " + *problem) + "\r\nerror:3");
                   }
                   go_on();
               });
    return false;
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
    return (line.kind == GrblLine::request && line.text != "$C")
           || (line.kind == GrblLine::code && line.verdict.is_plain);
}

void Gate::send_line(const LinePointer& line) {
    line->stage = Stage::sent;
    last_sent_ = now_;
    has_moved_ = has_moved_ || !is_plain(*line) || line->verdict.moves;
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
    last_heard_ = now_;
    if (text.starts_with("ALARM:") || text.starts_with("Grbl")) waited_for_ = 0;
    if (text == "ok" || text.starts_with("error:")) return take_answer(text);
    if (text.starts_with("Grbl")) { // Grbl 1.1h ['$' for help]; GrblHAL 1.1f ...
        banner_ = text;
        flush_replies();
        take_reset();
    } else if (text.starts_with("ALARM:")) {
        take_alarm(text);
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
    said_no_answer_ = false;
    note_waited();
    if (outstanding_.empty()) {
        links_.note("Feeler: the controller answers where nothing was asked: " + text);
        ++changes_;
        return;
    }
    const Sent sent = outstanding_.front();
    outstanding_.pop_front();
    if (!sent.line) {
        was_refused_ = was_refused_ || text != "ok";
        return ask_next_fact();
    }
    const LinePointer& line = sent.line;
    if (line->kind == GrblLine::jog && std::exchange(cancels_again_, false))
        links_.to_controller(std::string_view(&jog_cancel, 1));
    const bool was_checked = line->kind == GrblLine::code || line->kind == GrblLine::jog;
    answer(line, text);
    if (text == "ok") {
        const bool was_alarmed = is_alarmed_;
        if (line->kind == GrblLine::unlock || line->kind == GrblLine::home) {
            is_alarmed_ = false;
            if (!is_checking_only_) ++changes_; // it may have been asked before
        }
        if (line->kind == GrblLine::unlock && std::exchange(may_have_slipped_, false))
            say("the machine may have lost steps. Home it, or check its zero, before you go on.");
        // Grbl answers so even when an alarm has ended it.
        if (line->kind == GrblLine::home && was_alarmed) note_lost_homing();
        if (line->kind == GrblLine::home && !is_lost_) {
            may_be_lost_ = false;
            was_homed_ = was_homed_ || !std::exchange(is_homed_, true);
        }
        // Grbl resets itself when it leaves check mode.
        if (line->text == "$C") {
            (is_checking_only_ ? awaits_reset_ : is_checking_only_) = true;
            reset_at_ = now_;
        }
        if (was_checked) {
            ++passed_;
            note_made(line);
        }
        return;
    }
    if (!was_checked) return;
    // The lines after it were checked as if this one had been run.
    drop_unsent();
    if (line->kind == GrblLine::jog || is_alarmed_) return;
    const bool has_sent_more =
        std::any_of(outstanding_.begin(), outstanding_.end(),
                    [](const Sent& s) { return s.line && s.line->kind == GrblLine::code; });
    if (!has_sent_more) return;
    is_latched_ = is_derailed_ = true;
    latch_ = fmt::format("Grbl refused {}. Reset Grbl to go on.", line->text);
    links_.to_controller(std::string_view(&feed_hold, 1));
    say(fmt::format(
        "Grbl refused {} ({}), and lines after it are on their way. The feed is held. Reset Grbl "
        "to go on.",
        line->text, text));
}

/// A line was taken in. Lines before it that have left the planner have been made.
void Gate::note_made(const LinePointer& line) {
    expected_ = line->verdict.end;
    has_changed_offset_ = has_changed_offset_ || line->verdict.changes_offset;
    if (is_checking_only_ || is_alarmed_ || is_derailed_ || awaits_reset_) return;
    // Grbl takes jogs when all other motions have ended.
    // They may be cancelled at any time, also by a button on the board: what they cut stays.
    if (line->kind == GrblLine::jog) {
        made_through_ = std::max(made_through_, answered_through_);
        ++jogs_;
        return;
    }
    answered_through_ = line->number;
    // Grbl waits until all motions before have ended, but a reset ends that.
    if (line->verdict.stops_at_contact || (line->text.starts_with("G4P") && !line->verdict.moves)) {
        waited_for_ = line->number;
        return;
    }
    if (!line->verdict.fills_planner || !facts_.planner) return;
    in_planner_.push_back(line->number);
    for (; in_planner_.size() > *facts_.planner + behind_planner; in_planner_.pop_front())
        made_through_ = in_planner_.front();
}

/// The controller has gone on after a dwell or a probing.
void Gate::note_waited() {
    if (waited_for_ == 0) return;
    made_through_ = std::max(made_through_, std::exchange(waited_for_, 0));
    in_planner_.clear();
}

/// Grbl counts the steps of each phase of a homing from 0.
void Gate::note_lost_homing() {
    is_lost_ = true;
    is_homed_ = was_homed_ = false;
}

/// Whether Grbl answers a line only after a while, although nothing moves: homing, a dwell.
bool Gate::takes_its_time(const Line& line) {
    if (line.kind == GrblLine::home) return true;
    const std::string& text = line.text;
    for (size_t at = 0; (at = text.find('G', at)) != std::string::npos; ++at) {
        const size_t code = text.find_first_not_of('0', at + 1);
        if (code == std::string::npos || text[code] != '4') continue;
        const char next = code + 1 < text.size() ? text[code + 1] : ' ';
        if (next != '.' && std::isdigit(static_cast<unsigned char>(next)) == 0) return true;
    }
    return false;
}

void Gate::take_status(const GrblStatus& status) {
    const bool is_idle = status.state == "Idle";
    if (status.state.find(',') != std::string::npos) { // of Grbl 0.9
        if (!std::exchange(is_status_unread_, true))
            say("the gate does not understand the status that the controller reports. It needs "
                "Grbl 1.1.");
        asking_ = Asking::nothing;
        return lock_waiting();
    }
    may_have_slipped_ = may_have_slipped_ || status.state == "Sleep";
    const bool stands = outstanding_.empty() && now_ - last_answer_ >= rest;
    if (is_idle && stands) note_waited();
    if (is_idle && stands && !is_checking_only_) {
        made_through_ = std::max(made_through_, answered_through_);
        in_planner_.clear();
        jogs_ = 0;
    }
    if (is_idle && stands) compare_place(status);
    const bool is_at_rest = is_idle || status.state == "Alarm" || status.state == "Check";
    if (is_at_rest && stands && std::exchange(greets_, false) && !banner_.empty())
        links_.to_sender(banner_ + "\r\n");
    // It stands, and has not answered.
    const bool awaits_answer =
        !outstanding_.empty()
        && (!outstanding_.front().line || !takes_its_time(*outstanding_.front().line));
    if (is_idle && awaits_answer && now_ - last_sent_ >= patience && now_ - last_answer_ >= patience
        && !std::exchange(said_no_answer_, true))
        say("the controller does not answer. Reset Grbl to go on.");
    if (asking_ != Asking::status || !stands) return;
    if (status.state == "Alarm" || status.state == "Sleep") {
        asking_ = Asking::nothing;
        return lock_waiting(); // as Grbl does
    }
    if (status.state == "Check") {
        is_checking_only_ = true;
        // Nothing moves, and Grbl answers no questions.
        asking_ = Asking::nothing;
        if (knows_settings_) changes_known_ = changes_;
        has_jogged_ = has_jogged_ && !knows_settings_;
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

/// The place of the machine, from where it is in the work, as it was when the control was asked.
core::Vec3 Gate::place_of(const core::Vec3& wpos) const {
    return facts_.scaled(wpos) + facts_.zero() + core::Vec3(0.0, 0.0, facts_.length_offset);
}

/// The machine stands. If this is not where its last line ends, a line was lost, or somebody else
/// has moved it.
void Gate::compare_place(const GrblStatus& status) {
    constexpr double rounding = 0.05; // mm: of the report
    if (!expected_ || !(status.mpos || status.wpos) || !knows_settings_ || is_checking_only_
        || is_alarmed_ || is_derailed_ || awaits_reset_ || asking_ != Asking::nothing
        || needs_asking())
        return;
    // An offset of work changes with a line that asks anew, or with G54 to G59.
    if (!status.mpos && has_changed_offset_) return;
    const core::Vec3 away =
        (status.mpos ? facts_.scaled(*status.mpos) : place_of(*status.wpos)) - *expected_;
    const auto is_away = [&](int i) { return std::abs(away[i]) > rounding + 0.5 * facts_.step[i]; };
    if (!is_away(0) && !is_away(1) && !is_away(2)) return;
    expected_.reset();
    ++changes_;
    say("the machine does not stand where its last line ends. The next line is checked from where "
        "it stands.");
}

void Gate::take_reset() {
    const bool was_homing =
        std::any_of(outstanding_.begin(), outstanding_.end(),
                    [](const Sent& s) { return s.line && s.line->kind == GrblLine::home; });
    if (was_homing) note_lost_homing();
    greets_ = false;
    expected_.reset();
    drop_unsent();
    lines_.clear();
    outstanding_.clear();
    in_planner_.clear();
    from_sender_.clear();
    answered_through_ = made_through_; // motions may have been cut off
    asking_ = Asking::nothing;
    may_be_lost_ = may_be_lost_ || !awaits_reset_; // a reset that was asked for starts nothing anew
    was_dry_ = is_checking_only_;
    jogs_ = 0;
    cancels_again_ = false;
    awaits_reset_ = is_latched_ = is_derailed_ = is_alarmed_ = is_checking_only_ = has_jogged_ =
        false;
    knows_settings_ = false;
    was_reset_ = true;
    said_.clear();
}

void Gate::take_alarm(const std::string& text) {
    may_have_slipped_ = may_have_slipped_ || text == "ALARM:1" || text == "ALARM:3";
    expected_.reset();
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
    changes_asked_for_ = changes_;
    asked_status_ = last_sent_ = now_;
    links_.to_controller(std::string_view(&status_request, 1));
}

/// Refuses what may move and waits until more is known of the control.
void Gate::lock_waiting() {
    for (const LinePointer& line : lines_) {
        if (line->stage != Stage::waiting) continue;
        if (line->text == "$C") answer(line, "error:8");
        if (line->kind == GrblLine::code || line->kind == GrblLine::jog
            || line->kind == GrblLine::other)
            answer(line, std::string(locked));
    }
    word_.reset();
}

void Gate::ask_next_fact() {
    constexpr std::string_view requests[] = {"$I", "$$", "$N", "$#", "$G"};
    if (asking_ != Asking::facts) return;
    if (next_fact_ == std::size(requests)) return take_facts();
    const std::string_view request = requests[next_fact_++];
    outstanding_.push_back({nullptr, request.size() + 1});
    last_sent_ = now_;
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
    facts_.is_dry = std::exchange(was_dry_, false);
    knows_settings_ = true;
    const core::Vec3 position =
        position_is_of_work_ ? place_of(position_) : facts_.scaled(position_);
    has_changed_offset_ = false;
    // A board that starts takes its place for zero.
    facts_.is_lost = std::exchange(may_be_lost_, false) && glm::length(position) < least_travel
                     && (!was_asked_ || has_moved_ || glm::length(was_at_) >= least_travel);
    facts_.ended_homing = std::exchange(is_lost_, false);
    facts_.is_lost = facts_.is_lost || facts_.ended_homing;
    if (facts_.is_lost) is_homed_ = false;
    // If it was homed while it was asked, its answers may be from before the homing.
    const bool is_current = changes_ == changes_asked_for_;
    facts_.was_homed = is_current && std::exchange(was_homed_, false) && was_asked_;
    was_asked_ = true;
    was_at_ = position;
    has_moved_ = false;
    asking_ = Asking::check;
    struct Outcome {
        std::string objection;
        bool is_set_up = false;
    };
    const auto outcome = std::make_shared<Outcome>();
    links_.run(
        [outcome, facts = facts_, position, made = made_through_, word = word_](LineCheck& check) {
            check.synchronise(facts, position, made, word);
            *outcome = {check.objection(), check.is_set_up()};
        },
        [this, outcome, epoch = epoch_] {
            if (!outcome->objection.empty() && said_ != outcome->objection) say(outcome->objection);
            said_ = outcome->objection;
            is_set_up_ = outcome->is_set_up;
            if (epoch != epoch_) return;
            asking_ = Asking::nothing;
            changes_known_ = changes_asked_for_;
            expected_.reset();
            has_jogged_ = false;
            answered_through_ = made_through_ = followed_ = last_number_;
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
    const bool awaits_status = asking_ == Asking::status || greets_
                               || (!outstanding_.empty() && now_ - last_sent_ >= patience);
    if (awaits_status && now_ - asked_status_ >= asking_interval) {
        asked_status_ = now_;
        links_.to_controller(std::string_view(&status_request, 1));
    }
    // Grbl reports nothing while it homes.
    const bool is_homing = !outstanding_.empty() && outstanding_.front().line
                           && outstanding_.front().line->kind == GrblLine::home;
    const bool hears_nothing = !outstanding_.empty() && !is_homing
                               && now_ - std::max(last_sent_, last_heard_) >= 2 * patience;
    if (hears_nothing && !std::exchange(said_no_answer_, true))
        say("the controller does not answer, nor does it say what it does. Check the cable, or "
            "reset Grbl to go on.");
    if (awaits_reset_ && now_ - reset_at_ >= patience && !std::exchange(said_no_answer_, true))
        say("the controller does not answer after the reset.");
    // Says early what is wrong.
    if (!knows_settings_ && now_ - asked_status_ >= patience) ask_control();
    go_on();
}

} // namespace app
