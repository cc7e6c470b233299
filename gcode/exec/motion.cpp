#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/base/math.h"
#include "core/base/units.h"
#include "core/motion/machine.h"
#include "gcode/exec/execution.h"
#include "gcode/exec/frame_codes.h"
#include "gcode/exec/readings.h"
#include "gcode/language/control.h"

namespace gcode {
namespace {

using core::ErrorCode;

/// Whether the words of the plane are a radius and an angle (G16).
bool moves_by_radius_and_angle(const Execution& execution) {
    const ModalState& modal = execution.modal();
    if (!modal.transforms.polar || execution.statement.axis_word_owner()) return false;
    const PlaneAxes axes = axes_of(modal.plane);
    return !in_machine_coordinates(execution)
           && (execution.statement.word(axis_letters[axes.first])
               || execution.statement.word(axis_letters[axes.second]));
}

/// Whether a move turns the tool in the plane of its directions.
bool turns_in_plane(const ModalState& modal, const Position& end) {
    return modal.turns_in_plane && modal.offsets.follows_tip && turns_between(modal.position, end);
}

} // namespace

void Execution::traverse(const Position& end, std::optional<core::RapidStyle> style) {
    const bool in_plane = turns_in_plane(modal(), end);
    modal().position = end;
    modal().leaves_contour = false;
    emit(StraightTraverse{end, style, in_plane});
}

void Execution::feed(const Position& end, double rate) {
    const bool in_plane = turns_in_plane(modal(), end);
    modal().position = end;
    modal().leaves_contour = false;
    emit(StraightFeed{end, rate, in_plane});
}

bool in_machine_coordinates(const Execution& execution) {
    const CodeWord* action = execution.statement.of(ModalGroup::action);
    return action && is_machine_move(action->code->number);
}

const Word& moving_word(const Execution& execution) {
    const Statement& statement = execution.statement;
    for (const ModalGroup group : {ModalGroup::cycle, ModalGroup::motion})
        if (const CodeWord* entry = statement.of(group)) return *entry->word;
    for (const Word& word : execution.block.words)
        if (std::string_view("XYZABCUVWIJK@^").find(word.letter) != std::string_view::npos)
            return word;
    if (!execution.block.words.empty()) return execution.block.words.front();
    static thread_local Word none; // Klartext has statements without words
    none.span = {.line = execution.block.line, .column = execution.column};
    return none;
}

namespace {

constexpr double full_turn = 360.0; // degrees

/// The next angle from `now` on in a direction that is `angle` up to full turns.
double next_angle(double now, double angle, bool backwards) {
    const double way = std::fmod(angle - now, full_turn);
    if (backwards) return now + (way > 0.0 ? way - full_turn : way);
    return now + (way < 0.0 ? way + full_turn : way);
}

/// The angle to which a rotary axis turns for an absolute word, which depends on two parameters.
/// They are asked only where they make a difference.
///
/// Source: Fanuc B-63944EN, rotary axis roll-over.
double rolled_over(const Execution& execution, size_t axis, double value,
                   const std::optional<double>& now) {
    constexpr double slack = 1e-9;
    const core::Machine* machine = execution.modal().offsets.machine;
    constexpr ControlQuestion rolls = ControlQuestion::rotary_rolls_over;
    if (!is_rotary(axis) || !now || !machine || !machine->axes[axis].present
        || machine->axes[axis].shortest_way
        || !find_parameter(rolls, execution.environment.dialect))
        return value;
    const auto asks = [&](ControlQuestion question) {
        return answer_to(execution.state, execution.environment, question, execution.block.line);
    };
    const double way = std::remainder(value - *now, full_turn);
    const bool is_half = std::abs(std::abs(way) - full_turn / 2.0) < slack;
    const double by_sign = next_angle(*now, std::abs(value), std::signbit(value));
    const auto is_value = [&](double angle) { return std::abs(angle - value) < slack; };
    if (is_value(*now + way) && is_value(by_sign) && !is_half) return value;
    if (!asks(rolls)) return value;
    if (asks(ControlQuestion::rotary_follows_sign)) return by_sign;
    if (!is_half) return *now + way;
    return *now + (asks(ControlQuestion::half_turn_is_negative) ? -0.5 : 0.5) * full_turn;
}

} // namespace

double axis_value(const Execution& execution, size_t axis, const Word& word) {
    if (is_rotary(axis)) return word.value;
    const double length = length_of(execution, word);
    return axis == 0 && execution.modal().diameter_mode ? length / 2.0 : length;
}

namespace {

/// Reports @ or ^ with G53 as an error: they are relative to the program origin.
core::Result<void> refuse_polar_words(const Execution& execution) {
    const Statement& statement = execution.statement;
    const Word* word = statement.polar_radius ? statement.polar_radius : statement.polar_angle;
    if (!word) return {};
    return core::fail(ErrorCode::syntax,
                      fmt::format("{}: @ and ^ are relative to the program origin and cannot be "
                                  "used with G53: use X and Y",
                                  written(*word)),
                      word->span);
}

/// @ and ^: X and Y from the distance to the origin and the angle, in every plane. A missing one
/// keeps the value of the current position.
core::Result<void> place_polar(const Execution& execution, Position& target) {
    const Statement& statement = execution.statement;
    const Word& first = statement.polar_radius ? *statement.polar_radius : *statement.polar_angle;
    for (const char letter : {'X', 'Y'})
        if (const Word* word = statement.word(letter))
            return core::fail(
                ErrorCode::syntax,
                fmt::format("{}: use either @ and ^ or X and Y, not both", written(*word)),
                word->span);
    const bool incremental = execution.modal().distance == DistanceMode::incremental;
    const bool needs_position = incremental || !statement.polar_radius || !statement.polar_angle;
    if (needs_position && !(target[0] && target[1]))
        return core::fail(
            ErrorCode::missing_value,
            fmt::format(
                "{}: this is relative to the current position, which is unknown; give both @ and ^",
                written(first)),
            first.span);
    double radius = needs_position ? core::hypot(*target[0], *target[1]) : 0.0;
    double angle =
        needs_position ? core::atan2(*target[1], *target[0]) / core::radians_per_degree : 0.0;
    if (!statement.polar_angle && radius < 1e-9)
        return core::fail(
            ErrorCode::missing_value,
            fmt::format("{}: the tool is at the origin, which has no angle: add ^", written(first)),
            first.span);
    if (statement.polar_radius)
        radius = length_of(execution, *statement.polar_radius) + (incremental ? radius : 0.0);
    if (statement.polar_angle) angle = statement.polar_angle->value + (incremental ? angle : 0.0);
    target[0] = radius * core::cos(angle * core::radians_per_degree);
    target[1] = radius * core::sin(angle * core::radians_per_degree);
    return {};
}

/// The angle to which a wrapped rotary axis turns for an absolute position: the next one in the
/// direction of its sign, also that of -0.
///
/// Errors: invalid_value for a turn or more.
core::Result<double> unwrapped(const Execution& execution, size_t axis, const Word& word) {
    constexpr double turn = 360.0;
    if (std::abs(word.value) >= turn)
        return core::fail(
            ErrorCode::invalid_value,
            fmt::format("{}: a wrapped rotary axis takes absolute positions below 360 "
                        "degrees",
                        written(word)),
            word.span);
    const double now = execution.modal().position[axis].value_or(0.0);
    const double angle = std::abs(word.value) + std::floor(now / turn) * turn;
    const bool backwards = std::signbit(word.value);
    if (!backwards && angle < now) return angle + turn;
    return backwards && angle > now ? angle - turn : angle;
}

} // namespace

namespace {

/// mm or degrees; no machine reaches it.
constexpr double farthest = 1e9;

/// Refuses a position that is out of reach of every machine, so that no later number overflows.
core::Result<Position> within_reach(const Execution& execution, const Position& target) {
    for (size_t axis = 0; axis < axis_count; ++axis) {
        if (!target[axis] || std::abs(*target[axis]) <= farthest) continue;
        const Word* word = execution.statement.word(axis_letters[axis]);
        if (!word && !execution.block.words.empty()) word = &moving_word(execution);
        return core::fail(
            ErrorCode::invalid_value,
            fmt::format("{}{} would go to {:.6g} mm, further than any machine reaches",
                        word ? written(*word) + ": " : "", axis_letters[axis], *target[axis]),
            word ? word->span : moving_word(execution).span);
    }
    return target;
}

} // namespace

bool is_incremental(const Execution& execution, const Word& word) {
    return word.addressing == Addressing::modal
               ? execution.modal().distance == DistanceMode::incremental
               : word.addressing == Addressing::incremental;
}

namespace {

/// How much further than its word an incremental move goes because offsets have changed.
double travel_of_offsets(const Execution& execution, size_t axis) {
    constexpr double slack = 1e-9;
    const ModalState& modal = execution.modal();
    const auto travels = [&](double change, ControlQuestion question) {
        return std::abs(change) > slack
               && answer_to(execution.state, execution.environment, question, execution.block.line);
    };
    const double offset = modal.offset_travel[axis], length = modal.length_travel[axis];
    return (travels(offset, ControlQuestion::increment_has_offset) ? offset : 0.0)
           + (travels(length, ControlQuestion::increment_has_length) ? length : 0.0);
}

/// The machine coordinate of the gauge line to which a word of G53, G153, SUPA or M91 moves.
core::Result<std::optional<double>> machine_target(const Execution& execution, size_t axis,
                                                   const Word& word,
                                                   const std::optional<double>& from) {
    const double value = axis_value(execution, axis, word);
    const Language language = execution.dialect.language;
    if (language != Language::words && is_incremental(execution, word)) {
        if (language == Language::klartext)
            return core::fail(ErrorCode::unsupported,
                              fmt::format("I{}: incremental words with M91 and M92 are not "
                                          "supported: program the machine coordinate",
                                          written(word)),
                              word.span);
        return from ? std::optional(*from + value) : std::nullopt;
    }
    const double length = execution.modal().offsets.tool[axis];
    const bool is_tips = length != 0.0
                         && answer_to(execution.state, execution.environment,
                                      ControlQuestion::machine_moves_tip, execution.block.line);
    return rolled_over(execution, axis, value, from) + (is_tips ? length : 0.0);
}

/// In a tilted plane without tool centre point control, X, Y and Z stay where they are on the
/// machine when a rotary axis turns: their program coordinates change.
void leave_linear_axes(const Execution& execution, Position& target) {
    const ModalState& modal = execution.modal();
    const Offsets& offsets = modal.offsets;
    if (!offsets.machine || !offsets.tilted_plane || offsets.follows_tip) return;
    if (!turns_between(modal.position, target)) return;
    const Position kept =
        turned_in_place(offsets, modal.position, machine_from_program(offsets, target));
    for (size_t axis = 0; axis < 3; ++axis) {
        const Word* word = execution.statement.word(axis_letters[axis]);
        if (!word)
            target[axis] = kept[axis];
        else if (is_incremental(execution, *word) && target[axis] && kept[axis])
            *target[axis] += *kept[axis] - modal.position[axis].value_or(0.0);
    }
}

} // namespace

core::Result<Position> target_of(const Execution& execution) {
    const ModalState& modal = execution.modal();
    Position target = modal.position;
    if (in_machine_coordinates(execution)) {
        if (auto checked = refuse_polar_words(execution); !checked)
            return tl::unexpected(std::move(checked).error());
        const Offsets offsets = counted_offsets(modal.offsets);
        Position machine = machine_from_program(offsets, modal.position);
        for (size_t axis = 0; axis < axis_count; ++axis)
            if (const Word* word = execution.statement.word(axis_letters[axis])) {
                FEELER_TRY(machine[axis], machine_target(execution, axis, *word, machine[axis]));
            }
        const Position position = program_from_machine(without_rotary_tool(offsets), machine);
        const bool turned = mixes_axes(offsets);
        for (size_t axis = 0; axis < axis_count; ++axis)
            if (execution.statement.word(axis_letters[axis]) || (turned && axis < 3))
                target[axis] = position[axis];
        return within_reach(execution, target);
    }
    if (execution.statement.polar_radius || execution.statement.polar_angle)
        if (auto placed = place_polar(execution, target); !placed)
            return tl::unexpected(std::move(placed).error());
    const bool polar = moves_by_radius_and_angle(execution);
    if (polar) place_by_radius_and_angle(execution, target);
    const PlaneAxes plane = axes_of(modal.plane);
    for (size_t axis = 0; axis < axis_count; ++axis) {
        if (!(execution.statement.letters & letter_bit(axis_letters[axis]))) continue;
        const Word* word = execution.statement.word(axis_letters[axis]);
        if (polar && (axis == plane.first || axis == plane.second)) continue;
        if (execution.tool_by_angles && is_rotary(axis)) continue;
        const double value = axis_value(execution, axis, *word);
        const bool absolute = !is_incremental(execution, *word);
        if (word->is_unknown)
            target[axis].reset();
        else if (absolute
                 && execution.environment.wrapped_axes.find(axis_letters[axis])
                        != std::string::npos) {
            FEELER_TRY(target[axis], unwrapped(execution, axis, *word));
        } else if (absolute)
            target[axis] = rolled_over(execution, axis, value, target[axis]);
        else if (target[axis])
            *target[axis] += value + travel_of_offsets(execution, axis);
    }
    if (auto pointed = point_by_vector(execution, target); !pointed)
        return tl::unexpected(std::move(pointed).error());
    leave_linear_axes(execution, target);
    if (auto placed = place_by_angle(execution, target); !placed)
        return tl::unexpected(std::move(placed).error());
    if (const auto axis = axis_left_out_of_rotation(execution))
        target[*axis] = (*modal.transforms.before_rotation)[*axis];
    return within_reach(execution, target);
}

namespace {

tl::unexpected<core::Error> unknown_position(const Execution& execution, size_t axis) {
    const Word& mover = moving_word(execution);
    return core::fail(
        ErrorCode::missing_value,
        fmt::format("{}: with G16 this is relative to the current position, which is unknown in {}",
                    written(mover), axis_letters[axis]),
        mover.span);
}

} // namespace

core::Result<void> read_polar_words(Execution& execution) {
    ModalState& modal = execution.modal();
    if (!modal.transforms.polar) return {};
    PolarPositions& polar = *modal.transforms.polar;
    const PlaneAxes axes = axes_of(modal.plane);
    const bool incremental = modal.distance == DistanceMode::incremental;
    if (const Word* word = execution.statement.word(axis_letters[axes.first])) {
        polar.origin = {};
        for (const size_t i : {size_t{0}, size_t{1}}) {
            const size_t axis = i == 0 ? axes.first : axes.second;
            if (!incremental) continue;
            if (!modal.position[axis]) return unknown_position(execution, axis);
            polar.origin[i] = *modal.position[axis];
        }
        polar.radius = length_of(execution, *word);
    }
    if (const Word* word = execution.statement.word(axis_letters[axes.second]))
        polar.angle_deg = word->value + (incremental ? polar.angle_deg.value_or(0.0) : 0.0);
    return {};
}

void place_by_radius_and_angle(const Execution& execution, Position& target) {
    const ModalState& modal = execution.modal();
    const PolarPositions& polar = *modal.transforms.polar;
    const PlaneAxes axes = axes_of(modal.plane);
    const core::Mat3 turn = turned_about(2, polar.angle_deg.value_or(0.0));
    const double radius = polar.radius.value_or(0.0);
    target[axes.first] = polar.origin[0] + radius * turn[0][0];
    target[axes.second] = polar.origin[1] + radius * turn[0][1];
}

std::optional<size_t> axis_left_out_of_rotation(const Execution& execution) {
    const ModalState& modal = execution.modal();
    const auto& before = modal.transforms.before_rotation;
    if (!before || !modal.transforms.rotation || in_machine_coordinates(execution)
        || modal.distance == DistanceMode::incremental || modal.transforms.polar)
        return std::nullopt;
    const auto normal = static_cast<size_t>(modal.transforms.rotation->normal);
    const size_t first = (normal + 1) % 3, second = (normal + 2) % 3;
    const bool has_first = execution.statement.word(axis_letters[first]);
    const bool has_second = execution.statement.word(axis_letters[second]);
    if (has_first == has_second) return std::nullopt;
    const size_t left_out = has_first ? second : first;
    const auto &old = (*before)[left_out], &now = modal.position[left_out];
    if (old == now || (old && now && std::abs(*old - *now) < 1e-9)) return std::nullopt;
    return left_out;
}

void warn_of_axis_left_out(Execution& execution) {
    if (const auto axis = axis_left_out_of_rotation(execution))
        execution.warn(moving_word(execution).span,
                       fmt::format("the first move after G68 has no {} word, and where that axis "
                                   "goes depends on a parameter of the control: program both axes",
                                   axis_letters[*axis]));
}

void forget_position_before_rotation(Execution& execution) {
    ProgramTransforms& transforms = execution.modal().transforms;
    if (!transforms.before_rotation || !transforms.rotation) return;
    const auto normal = static_cast<size_t>(transforms.rotation->normal);
    for (const size_t axis : {(normal + 1) % 3, (normal + 2) % 3})
        if (execution.statement.word(axis_letters[axis])) {
            transforms.before_rotation.reset();
            return;
        }
}

} // namespace gcode
