#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/base/math.h"
#include "core/base/units.h"
#include "gcode/exec/execution.h"
#include "gcode/exec/following.h"
#include "gcode/exec/readings.h"
#include "gcode/language/error_rules.h"

namespace gcode {
namespace {

using core::ErrorCode;

constexpr std::string_view letters_that_need_a_code = "DEHIJKLPQR";
constexpr uint32_t bits_that_need_a_code = letter_bits(letters_that_need_a_code);
constexpr std::string_view letters_of_lengths = "XYZIJKF"; // Q and R often have other meanings

/// The code of the active motion or cycle.
const Code* going_on(const Execution& execution) {
    const ModalState& modal = execution.modal();
    if (modal.cycle) return find_code(modal.cycle->code, execution.dialect.id);
    if (!modal.motion) return nullptr;
    const std::optional<CodeNumber> number = number_of(*modal.motion);
    return number ? find_code(*number, execution.dialect.id) : nullptr;
}

/// Whether the block has G30 with the P of a reference position that is known: P2, which is the
/// same as G30, or one that the set-up states.
bool names_known_home(const Execution& execution) {
    const CodeWord* action = execution.statement.of(ModalGroup::action);
    const Word* p_word = execution.statement.word('P');
    if (!execution.dialect.p_selects_more_offsets || !action || action->code->number != g_code(30)
        || !p_word)
        return false;
    const auto& further = execution.environment.further_homes;
    return p_word->value == 2.0 || (p_word->value == 3.0 && further[0])
           || (p_word->value == 4.0 && further[1]);
}

/// Reports a P that selects a reference position of G30 that is not supported.
core::Result<void> refuse_unknown_home(const Execution& execution) {
    const Statement& statement = execution.statement;
    const Word* p_word = statement.word('P');
    if (!p_word || !execution.dialect.p_selects_more_offsets) return {};
    const CodeWord* action = statement.of(ModalGroup::action);
    if (action && action->code->number == g_code(30) && !names_known_home(execution))
        return core::fail(
            ErrorCode::unsupported,
            fmt::format("{}: this reference position is not known: state it under [control] in the "
                        "set-up (Fanuc: \"1242\" for P3, \"1243\" for P4), or go there with G53",
                        written(*p_word)),
            p_word->span);
    return {};
}

/// Whether a P selects an extended offset: G54 P3 is G54.1 P3. P may belong to another code of the
/// block instead.
bool names_extended_offset(const Execution& execution) {
    const CodeWord* offset = execution.statement.of(ModalGroup::work_offset);
    return execution.dialect.has_extended_offsets && offset && offset->code->number == g_code(54);
}

bool is_used(const Execution& execution, char letter) {
    const Statement& statement = execution.statement;
    if (!statement.unknown_m_codes.empty()) return true;
    if (letter == 'H' && changes_length_alone(execution)) return true;
    if (letter == 'P' && names_extended_offset(execution)) return true;
    if (execution.modal().transforms.follows_vectors && letter >= 'I' && letter <= 'K') return true;
    if (letter == 'P' && names_known_home(execution)) return true;
    const auto uses = [&](const CodeWord& entry) { return entry.code->uses(letter); };
    if (std::any_of(statement.codes().begin(), statement.codes().end(), uses)) return true;
    if (statement.of(ModalGroup::motion) || statement.of(ModalGroup::cycle)) return false;
    const Code* modal = going_on(execution);
    return modal && modal->uses(letter);
}

core::Result<void> check_word(Execution& execution, const Word& word) {
    if (is_used(execution, word.letter)) return {};
    const bool exponent = word.letter == 'E'; // of a number, most likely
    const std::string message = fmt::format(
        "{}: no code in this block uses this word{}", written(word),
        exponent ? "; write an exponent such as 1E3 as a plain number; the extruder axis of a 3D "
                   "printer is not supported"
        : execution.dialect.has_axis_commands ? "; Grbl does not run this line (error 36)"
                                              : "");
    if (exponent || execution.dialect.unused_words_are_errors)
        return core::fail(ErrorCode::syntax, message, word.span);
    execution.warn(word.span, message);
    return {};
}

} // namespace

double length_of(const Execution& execution, const Word& word) {
    return to_mm(word.value, execution.modal().unit);
}

std::optional<double> length_word(const Execution& execution, char letter) {
    const Word* word = execution.statement.word(letter);
    return word ? std::optional(length_of(execution, *word)) : std::nullopt;
}

void warn_of_unknown_m_codes(Execution& execution) {
    for (const Word* word : execution.statement.unknown_m_codes) {
        if (is_switch_of_samples(execution, *word)) continue;
        execution.warn(
            word->span,
            fmt::format(
                "{}: unknown M code, probably of the machine builder: what it does is not checked",
                written(*word)));
    }
}

namespace {

/// Warns of G codes that have no effect because a later one of their group counts.
///
/// Source: Fanuc 30i user's manual B-63944EN, "Preparatory function (G function)".
void warn_of_overruled_codes(Execution& execution) {
    for (const Word* word : execution.statement.overruled)
        execution.warn(word->span,
                       fmt::format("{} has no effect in this block: of several codes of a modal "
                                   "group, the control uses only the last one; write them in "
                                   "separate blocks",
                                   written(*word)));
}

} // namespace

core::Result<void> check_words(Execution& execution) {
    if (auto checked = refuse_unknown_home(execution); !checked) return checked;
    warn_of_unknown_m_codes(execution);
    warn_of_overruled_codes(execution);
    if (!(execution.statement.letters & bits_that_need_a_code)) return {};
    for (const char letter : letters_that_need_a_code)
        if (const Word* word = execution.statement.word(letter))
            if (auto checked = check_word(execution, *word); !checked) return checked;
    return {};
}

core::Result<void> note_assumed_units(Execution& execution) {
    if (execution.modal().unit_said || execution.state.said_unit
        || execution.statement.of(ModalGroup::units) || execution.statement.of(ModalGroup::macro))
        return {};
    for (const Word& word : execution.block.words) {
        if (letters_of_lengths.find(word.letter) == std::string_view::npos) continue;
        execution.modal().unit =
            first_unit(execution.state, execution.environment, execution.block.line);
        const bool inch = execution.modal().unit == LengthUnit::inch;
        execution.state.said_unit = true;
        execution.warn(word.span,
                       fmt::format("no units (G20 or G21) programmed before {}; {} assumed",
                                   written(word), inch ? "inches" : "millimetres"),
                       Severity::note);
        return {};
    }
    return {};
}

namespace {

core::Error refusal(const Word& word, core::ErrorCode code, std::string_view why) {
    return {code, word.span, fmt::format("{}: {}", written(word), why)};
}

} // namespace

core::Result<void> place_by_angle(const Execution& execution, Position& target) {
    const Word* angle = execution.statement.angle;
    if (!angle) return {};
    using core::ErrorCode;
    const ModalState& modal = execution.modal();
    if (modal.cycle || !is_straight(modal.motion))
        return tl::unexpected(
            refusal(*angle, ErrorCode::syntax, "an angle can only be used with G0 or G1"));
    const PlaneAxes axes = axes_of(modal.plane);
    const bool first = execution.statement.word(axis_letters[axes.first]) != nullptr;
    const bool second = execution.statement.word(axis_letters[axes.second]) != nullptr;
    const std::string both =
        fmt::format("{} or {}", axis_letters[axes.first], axis_letters[axes.second]);
    if (first && second)
        return tl::unexpected(
            refusal(*angle, ErrorCode::syntax, fmt::format("an angle needs {}, not both", both)));
    if (!first && !second)
        return tl::unexpected(refusal(
            *angle, ErrorCode::unsupported,
            fmt::format(
                "a line that ends where it crosses the next one is not supported yet: add {}",
                both)));
    const size_t given = first ? axes.first : axes.second;
    const size_t other = first ? axes.second : axes.first;
    if (!modal.position[given] || !modal.position[other])
        return tl::unexpected(
            refusal(*angle, ErrorCode::missing_value,
                    "the start position of the line is unknown: move there first"));
    const double radians = core::radians_of(angle->value);
    const double along = first ? core::cos(radians) : core::sin(radians);
    const double across = first ? core::sin(radians) : core::cos(radians);
    const double way = *target[given] - *modal.position[given];
    if (std::abs(along) < 1e-9)
        return tl::unexpected(refusal(*angle, ErrorCode::invalid_value,
                                      fmt::format("{} does not change in this direction: use {}",
                                                  axis_letters[given], axis_letters[other])));
    target[other] = *modal.position[other] + way * across / along;
    return {};
}

namespace {

/// The spindle speed, rev/min. With G96 it depends on the distance from the spindle axis; the
/// distance at the start of the motion is used for all of it.
double turns_a_minute(const ModalState& modal) {
    if (!modal.surface_speed) return modal.speed;
    const double speed = modal.speed * (modal.unit == LengthUnit::inch ? 304.8 : 1000.0); // mm/min
    constexpr double least_radius = 0.01; // mm; at the axis itself the speed would be infinite
    const double radius = std::max(std::abs(modal.position[0].value_or(0.0)), least_radius);
    const double turns = speed / (2.0 * std::numbers::pi * radius);
    return modal.fastest_speed > 0.0 ? std::min(turns, modal.fastest_speed) : turns;
}

} // namespace

std::optional<double> distance_between(const Position& from, const Position& to) {
    // The feed applies to X, Y, Z; if these do not move, to U, V, W; else to the rotary axes.
    for (const size_t first : {size_t{0}, size_t{6}, size_t{3}}) {
        double squared = 0.0;
        for (size_t axis = first; axis < first + 3; ++axis) {
            if (from[axis] == to[axis]) continue;
            if (!from[axis] || !to[axis]) return std::nullopt;
            squared += (*to[axis] - *from[axis]) * (*to[axis] - *from[axis]);
        }
        if (squared > 0.0) return std::sqrt(squared);
    }
    return 0.0;
}

core::Result<double> feed_rate(const Execution& execution, std::optional<double> path_length) {
    const ModalState& modal = execution.modal();
    const auto refuse = [&](std::string_view why) {
        const Word& mover = moving_word(execution);
        return core::fail(no_feed, fmt::format("{}: {}", written(mover), why), mover.span);
    };
    const bool inverse = modal.feed_mode == FeedMode::inverse_time;
    if (inverse && !execution.statement.word('F'))
        return refuse("with G93 each feed move needs its own F word");
    if (!modal.feed) return refuse(no_feed_yet);
    if (*modal.feed == 0.0) return refuse("the feed rate is F0");
    if (modal.feed_mode == FeedMode::per_minute) return *modal.feed;
    if (inverse && !path_length)
        return refuse("G93 gives no feed rate here: the start position is unknown");
    const bool has_slowest = execution.dialect.system_parameters == SystemParameters::rs274;
    const double slowest = has_slowest ? to_mm(0.1, modal.unit) : 0.0; // a minute
    if (inverse) return std::max(slowest, *modal.feed * *path_length);
    if (modal.spindle == core::SpindleDirection::stopped || modal.speed == 0.0)
        return refuse("G95 gives no feed rate here: the spindle is stopped");
    return *modal.feed * turns_a_minute(modal);
}

double rate_to(const ModalState& modal, const Position& end, double rate) {
    if (modal.feed_mode != FeedMode::per_minute || modal.feed_unit == LengthUnit::mm) return rate;
    bool turns = false;
    for (size_t axis = 0; axis < axis_count; ++axis) {
        if (modal.position[axis] == end[axis]) continue;
        if (!is_rotary(axis)) return rate;
        turns = true;
    }
    return turns ? from_mm(rate, modal.feed_unit) : rate;
}

} // namespace gcode
