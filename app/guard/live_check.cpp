#include "app/guard/live_check.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "core/base/math.h"
#include "core/motion/corner.h"
#include "gcode/contour/flat_path.h"
#include "gcode/lower/lowering.h"

namespace app {
namespace {

constexpr double same_place = 1e-6; // mm or degrees

bool is_near(const core::AxisValues& a, const core::AxisValues& b) {
    for (size_t i = 0; i < core::axis_count; ++i)
        if (!(std::abs(a[i] - b[i]) <= same_place)) return false;
    return true;
}

/// The position of the axes that the machine has.
core::AxisPosition position_of(const core::AxisValues& values, const core::Machine& machine) {
    core::AxisPosition position;
    for (size_t i = 0; i < core::axis_count; ++i)
        if (machine.axes[i].present) position[i] = values[i];
    return position;
}

core::AxisValues known_values(const core::AxisPosition& position) {
    core::AxisValues values{};
    for (size_t i = 0; i < core::axis_count; ++i) values[i] = position[i].value_or(0.0);
    return values;
}

core::Vec3 vector_of(const double (&numbers)[3]) { return {numbers[0], numbers[1], numbers[2]}; }

core::Vec3 point_of(const core::AxisValues& values) { return {values[0], values[1], values[2]}; }

/// The main axis along which a vector points: 0 X, 1 Y, 2 Z; empty if it points between them.
std::optional<int> main_axis(const core::Vec3& normal) {
    const double length = glm::length(normal);
    for (int i = 0; i < 3; ++i)
        if (length > 0.0 && std::abs(normal[i]) >= (1.0 - 1e-12) * length) return i;
    return {};
}

double gap_in_plane(const core::Vec3& from, const core::Vec3& to, int normal) {
    core::Vec3 gap = to - from;
    gap[normal] = 0.0;
    return glm::length(gap);
}

/// The angle from one point to another about an axis through a centre, as a control counts it: more
/// than 0 and up to a full turn counterclockwise seen from the positive axis.
double turn_about(const core::Vec3& from, const core::Vec3& to, const core::Vec3& centre,
                  int normal) {
    const int u = (normal + 1) % 3, v = (normal + 2) % 3;
    const core::Vec3 a = from - centre, b = to - centre;
    const double whole = 2.0 * std::numbers::pi;
    if (gap_in_plane(from, to, normal) < gcode::same_end) return whole;
    const double angle = core::atan2(a[u] * b[v] - a[v] * b[u], a[u] * b[u] + a[v] * b[v]);
    return angle > 0.0 ? angle : angle + whole;
}

double distance_from_axis(const core::Vec3& point, const core::Vec3& centre, int normal) {
    core::Vec3 arm = point - centre;
    arm[normal] = 0.0;
    return glm::length(arm);
}

/// The path of an arc to its end or, if it was stopped, to that place. `normal`: its axis, which
/// the normal of the motion may point along or against.
core::ArcPath arc_of(const LiveMotion& motion, int normal, const core::AxisValues& to) {
    const core::Vec3 centre = vector_of(motion.centre);
    const core::Vec3 from = point_of(axis_values(motion.from)), end = point_of(to);
    const double whole = 2.0 * std::numbers::pi;
    // Counted about the motion's own normal, or clockwise about it: LinuxCNC's pmCircleInit.
    const bool is_reversed = motion.normal[normal] < 0.0, is_clockwise = motion.turns < 0;
    double angle = turn_about(from, end, centre, normal);
    if (is_reversed != is_clockwise && angle < whole) angle = whole - angle;
    angle += whole * (is_clockwise ? -1 - motion.turns : motion.turns);
    return {normal, centre, is_reversed != is_clockwise ? -angle : angle};
}

double distance_to_segment(const core::Vec3& point, const core::Vec3& a, const core::Vec3& b) {
    const core::Vec3 along = b - a;
    const double square = glm::dot(along, along);
    const double t = square > 0.0 ? std::clamp(glm::dot(point - a, along) / square, 0.0, 1.0) : 0.0;
    return glm::length(point - (a + t * along));
}

/// Whether a motion that was stopped there has made a part of itself for certain: all axes but X, Y
/// and Z are where they would be at that place of a line. On arcs that is not looked at.
bool is_on_the_way(const LiveMotion& motion, const core::AxisValues& stopped_at) {
    const core::Vec3 from = point_of(axis_values(motion.from));
    if (motion.shape == FEELER_ARC) return !moves_others(motion) && !motion.follows_tip;
    const core::Vec3 along = point_of(axis_values(motion.to)) - from;
    const double square = glm::dot(along, along);
    size_t longest = 3;
    for (size_t i = 3; i < core::axis_count; ++i)
        if (std::abs(motion.to[i] - motion.from[i])
            > std::abs(motion.to[longest] - motion.from[longest]))
            longest = i;
    const double travel = motion.to[longest] - motion.from[longest];
    const double part = square > 0.0    ? glm::dot(point_of(stopped_at) - from, along) / square
                        : travel != 0.0 ? (stopped_at[longest] - motion.from[longest]) / travel
                                        : 0.0;
    const double t = std::clamp(part, 0.0, 1.0);
    for (size_t i = 3; i < core::axis_count; ++i) {
        const double there = motion.from[i] + t * (motion.to[i] - motion.from[i]);
        const double slack = core::is_rotary(i) ? FEELER_TURN_ERROR : motion.tolerance;
        if (!(std::abs(stopped_at[i] - there) <= same_place + slack)) return false;
    }
    return true;
}

core::PathModeChange path_mode_of(const LiveMotion& motion) {
    core::PathModeChange mode;
    mode.blending = motion.blending == FEELER_EXACT_STOP   ? core::Blending::exact_stop
                    : motion.blending == FEELER_EXACT_PATH ? core::Blending::exact_path
                                                           : core::Blending::continuous;
    if (mode.blending != core::Blending::continuous) return mode;
    // The deviation at corners of others is a path error, and feeler_tp blends none of arcs.
    mode.blends = !moves_others(motion);
    // Without a tolerance, which feeds always have, as far as speeds demand.
    mode.tolerance = motion.tolerance;
    if (motion.tolerance > 0.0)
        mode.rapid_tolerance = motion.tolerance;
    else
        mode.rapids_keep_speed = true;
    return mode;
}

/// The tool in the spindle; empty if there is none.
std::optional<core::ToolNumber> tool_of(const LiveMotion& motion, const core::Setup& setup) {
    const core::ToolNumber number{motion.tool};
    if (motion.tool == 0 && !setup.tools.contains(number)) return {};
    return number;
}

/// `speed_by_hand`: a started spindle turns without a commanded speed.
core::SpindleChange spindle_of(const LiveMotion& motion, bool speed_by_hand) {
    core::SpindleChange spindle;
    spindle.direction = motion.turns_on == 1   ? core::SpindleDirection::clockwise
                        : motion.turns_on == 2 ? core::SpindleDirection::counterclockwise
                                               : core::SpindleDirection::stopped;
    if (motion.turns_on != 0) spindle.speed = std::max(motion.speed, speed_by_hand ? 1.0 : 0.0);
    return spindle;
}

/// What is wrong with LinuxCNC's limits for a straight motion that is blended: how far its corners
/// are rounded follows from those of the ini file, and pins (ini.x.max_acceleration) change them.
std::string problem_of_speeds(const LiveMotion& motion, const core::Machine& machine) {
    constexpr double slack = 0.01;
    if (motion.shape != FEELER_LINE || moves_others(motion) || motion.blending != FEELER_BLENDED)
        return {};
    double square = 0.0, speed = core::infinity, acceleration = core::infinity;
    for (size_t i = 0; i < 3; ++i)
        square += (motion.to[i] - motion.from[i]) * (motion.to[i] - motion.from[i]);
    for (size_t i = 0; i < 3; ++i) {
        const double share = std::abs(motion.to[i] - motion.from[i]) / std::sqrt(square);
        if (!(share > 0.0)) continue;
        const core::MachineAxis& axis = machine.axes[i];
        if (axis.rapid) speed = std::min(speed, *axis.rapid / 60.0 / share);
        if (axis.acceleration) acceleration = std::min(acceleration, *axis.acceleration / share);
    }
    const char* const why = ", so how far corners are rounded is not known. Set the pins "
                            "ini.*.max_velocity and ini.*.max_acceleration back to the ini file.";
    const bool is_free_rapid =
        (motion.purpose == FEELER_RAPID || motion.purpose == FEELER_TOOL_CHANGE)
        && motion.tolerance == 0.0;
    if (acceleration < core::infinity
        && std::abs(motion.acceleration - acceleration) > slack * acceleration)
        return fmt::format("LinuxCNC makes this motion with {:.4g} mm/s2, and the ini file says "
                           "{:.4g}{}",
                           motion.acceleration, acceleration, why);
    if (is_free_rapid && motion.most_speed > (1.0 + slack) * speed)
        return fmt::format("LinuxCNC makes this rapid with up to {:.4g} mm/s, and the ini file "
                           "says {:.4g}{}",
                           motion.most_speed, speed, why);
    return {};
}

} // namespace

// What LinuxCNC does at corners is in the ring.
LiveCheck::LiveCheck(const core::Setup& setup, ControlKinematics kinematics, bool speed_by_hand)
    : judge_(setup), kinematics_(std::move(kinematics)), speed_by_hand_(speed_by_hand) {}

/// A straight motion between two places of the axes.
core::Motion LiveCheck::line_of(const LiveMotion& motion, const core::AxisValues& from,
                                const core::AxisValues& to) const {
    core::Motion line;
    line.kind = motion.purpose == FEELER_RAPID || motion.purpose == FEELER_TOOL_CHANGE
                        || motion.purpose == FEELER_INDEXER
                    ? core::MotionKind::rapid
                    : core::MotionKind::feed;
    line.from = position_of(from, judge_.setup().machine);
    line.to = position_of(to, judge_.setup().machine);
    line.tip = kinematics_.tip_path(from, to, motion);
    (line.tip ? line.tip->turn_error : line.turn_error) = motion.turn_error;
    line.path_error = motion.path_error;
    line.style = core::RapidStyle::straight;
    line.stops_at_contact = is_probing(motion);
    line.leaves_contact = motion.purpose == FEELER_PROBE_AWAY;
    if (line.kind == core::MotionKind::feed) line.feed = 60.0 * motion.feed;
    return line;
}

/// An arc of the tip, as seen from the work.
void LiveCheck::add_chords(const LiveMotion& motion, const core::ArcPath& arc,
                           std::vector<core::Event>& events) const {
    constexpr double chord_error = 0.005; // mm
    const auto normal = static_cast<size_t>(arc.normal);
    const gcode::PlaneAxes axes{(normal + 1) % 3, (normal + 2) % 3, normal};
    gcode::Position from, to;
    std::copy(std::begin(motion.from), std::end(motion.from), from.begin());
    std::copy(std::begin(motion.to), std::end(motion.to), to.begin());
    const double centre[] = {motion.centre[axes.first], motion.centre[axes.second]};
    const gcode::ArcChords chords =
        gcode::chords_of_arc(from, to, axes, centre, arc.angle, chord_error);
    core::AxisValues here = motion.axes_from;
    for (const gcode::Position& end : chords.ends) {
        const core::AxisValues there = kinematics_.axes_at(known_values(end), motion);
        core::Motion chord = line_of(motion, here, there);
        chord.kind = core::MotionKind::feed;
        chord.feed = 60.0 * motion.feed;
        chord.path_error += chords.error;
        events.emplace_back(chord);
        here = there;
    }
}

/// The tool, the spindle and the path mode, where the motion has others than the state, and the
/// motion.
std::vector<core::Event> LiveCheck::events_of(const LiveMotion& motion,
                                              const core::SimulatorState& state) const {
    std::vector<core::Event> events;
    const std::optional<core::ToolNumber> tool = tool_of(motion, judge_.setup());
    if (!state.tool_known || state.tool != tool) events.emplace_back(core::ToolChange{tool});
    const core::SpindleChange spindle = spindle_of(motion, speed_by_hand_);
    if (spindle.direction != state.spindle.direction || spindle.speed != state.spindle.speed)
        events.emplace_back(spindle);
    events.emplace_back(path_mode_of(motion));

    core::Motion there = line_of(motion, motion.axes_from, motion.axes_to);
    if (motion.shape == FEELER_ARC) {
        const int normal = *main_axis(vector_of(motion.normal));
        const core::ArcPath arc = arc_of(motion, normal, axis_values(motion.to));
        if (motion.follows_tip) {
            add_chords(motion, arc, events);
            return events;
        }
        there.kind = core::MotionKind::arc;
        there.feed = 60.0 * motion.feed;
        there.arc = arc;
        // A spiral deviates from the arc about its centre by the difference of its radii.
        there.path_error +=
            std::abs(distance_from_axis(point_of(axis_values(motion.from)), arc.centre, normal)
                     - distance_from_axis(point_of(axis_values(motion.to)), arc.centre, normal));
    }
    events.emplace_back(there);
    if (motion.shape == FEELER_TAP) {
        std::swap(there.from, there.to);
        if (there.tip) std::swap(there.tip->from, there.tip->to);
        events.emplace_back(there);
    }
    return events;
}

void LiveCheck::make(const Permitted& motion) {
    judge_.follow(events_of(motion.checked, *made_), *made_);
    if (after_motion) after_motion(motion.queued);
}

/// Follows the cut of a motion that was stopped on its way.
void LiveCheck::make_part(const LiveMotion& motion, const core::AxisValues& stopped_at) {
    LiveMotion part = motion;
    std::copy(stopped_at.begin(), stopped_at.end(), std::begin(part.to));
    part.axes_to = kinematics_.axes_at(stopped_at, motion);
    if (!is_on_the_way(motion, stopped_at)) return leave(part);
    const core::Vec3 from = point_of(axis_values(motion.from)),
                     to = point_of(axis_values(motion.to));
    const core::Vec3 there = point_of(stopped_at);
    std::vector<core::Event> events = events_of(part, *made_);
    auto& path =
        std::get<core::Motion>(events[events.size() - (motion.shape == FEELER_TAP ? 2 : 1)]);
    path.stops_at_contact = false;
    // The planner may have left the path where it blends into the next motion.
    if (motion.shape == FEELER_ARC) {
        const int normal = path.arc->normal;
        const core::ArcPath whole = arc_of(motion, normal, axis_values(motion.to));
        const double turn = 2.0 * std::numbers::pi;
        double angle = turn_about(from, there, whole.centre, normal);
        if (whole.angle < 0.0) angle -= turn;
        // Where it is on its way, or on which of its turns, is not known. Near the start of a full
        // circle it may be near its end.
        const bool is_doubtful =
            std::abs(whole.angle) > turn - 0.1
            && glm::length(there - from) < std::max(1.0, 2.0 * motion.tolerance);
        const bool is_known = !is_doubtful && std::abs(angle) <= std::abs(whole.angle)
                              && motion.turns <= 0 && motion.turns >= -1;
        if (!is_known) return leave(part);
        const double height = from[normal] + angle / whole.angle * (to[normal] - from[normal]);
        path.path_error += std::abs(distance_from_axis(there, whole.centre, normal)
                                    - distance_from_axis(from, whole.centre, normal))
                           + std::abs(there[normal] - height);
        path.arc->angle = angle;
    } else {
        path.path_error += distance_to_segment(there, from, to);
    }
    judge_.follow(events, *made_);
    if (after_motion) after_motion(part);
}

/// Notes where a motion was stopped, and takes nothing for cut.
void LiveCheck::leave(const LiveMotion& part) {
    put_at(*made_, position_of(part.axes_to, judge_.setup().machine));
    if (after_motion) after_motion(part);
}

bool LiveCheck::catch_up(uint64_t begun, size_t most) {
    for (; most > 0 && !waiting_.empty() && waiting_.front().queued.number < begun; --most) {
        make(waiting_.front());
        waiting_.pop_front();
    }
    return !waiting_.empty() && waiting_.front().queued.number < begun;
}

/// Brings the state to the place where the motion begins.
core::Result<void> LiveCheck::place(const LiveMotion& motion) {
    const core::AxisPosition position = position_of(motion.axes_from, judge_.setup().machine);
    if (!ahead_) {
        FEELER_TRY(core::SimulatorState state, core::start_of_run(judge_.setup(), position));
        state.is_assumed = {};
        // The machine comes to the guard with its tool: that is no tool change.
        state.tool = tool_of(motion, judge_.setup());
        state.tool_known = true;
        made_ = state;
        ahead_ = std::move(state);
        is_refused_ = false;
        return {};
    }
    if (is_after_drop(motion)) {
        catch_up(motion.follows + (motion.follows_part != 0 ? 0 : 1), waiting_.size());
        const core::AxisValues stopped_at = axis_values(motion.stopped_at);
        if (motion.follows_part != 0 && !waiting_.empty()
            && waiting_.front().queued.number == motion.follows)
            make_part(waiting_.front().queued, stopped_at);
        // What begins behind them was not reached.
        if (!waiting_.empty()) judge_.return_to(waiting_.front().reached);
        waiting_.clear();
        ahead_ = *made_;
        is_refused_ = false;
    }
    if (is_after_drop(motion) || motion.from_rest != 0) ahead_->corners.last = {};
    if (is_near(known_values(ahead_->position), known_values(position)) && ahead_->spread.none())
        return {};
    if (!is_after_drop(motion) && motion.from_rest == 0)
        return core::fail(core::ErrorCode::unsupported,
                          "It does not begin where the motion before it ends.");
    // The machine was at rest and was then moved in another way, such as by hand.
    catch_up(motion.number, waiting_.size());
    judge_.begin_retreat();
    put_at(*ahead_, position);
    put_at(*made_, position);
    return {};
}

/// Why a motion cannot be checked; or empty.
std::string LiveCheck::objection(const LiveMotion& motion) const {
    const auto is_finite = [](double value) { return std::isfinite(value); };
    const auto are_finite = [&](const auto& values) {
        return std::all_of(std::begin(values), std::end(values), is_finite);
    };
    if (!are_finite(motion.from) || !are_finite(motion.to) || !are_finite(motion.centre)
        || !are_finite(motion.normal) || !is_finite(motion.feed) || !is_finite(motion.speed)
        || !is_finite(motion.tolerance) || !are_finite(motion.axes_from)
        || !are_finite(motion.axes_to))
        return "One of its values is not a number.";
    if (!motion.problem.empty()) return motion.problem;
    if (motion.shape < FEELER_LINE || motion.shape > FEELER_TAP || motion.purpose < FEELER_RAPID
        || motion.purpose > FEELER_PROBE_AWAY || motion.blending > FEELER_BLENDED)
        return "It is of a kind that is not known.";
    if (motion.blending == FEELER_BLENDED
        && (motion.purpose != FEELER_RAPID || moves_others(motion)) && !(motion.tolerance > 0.0))
        return "How far its corners may be rounded is not known: it was queued before the guard "
               "ran.";
    if (motion.tool < 0)
        return "The tool in the spindle is not known: feeler-tp.tool-number is not connected.";
    if (motion.tool > 0 && !judge_.setup().tools.contains(core::ToolNumber{motion.tool}))
        return fmt::format("The set-up does not describe tool {}.", motion.tool);
    if (!tool_of(motion, judge_.setup()) && motion.purpose != FEELER_RAPID
        && motion.purpose != FEELER_TOOL_CHANGE)
        return "The control says that there is no tool in the spindle (M61 Q tells it which).";
    for (size_t i = 0; i < core::axis_count; ++i)
        if (!judge_.setup().machine.axes[i].present && std::abs(motion.to[i]) > same_place)
            return fmt::format("Axis {} is not at 0, and the set-up has no such axis.",
                               core::axis_letters[i]);
    if (motion.shape == FEELER_ARC && !main_axis(vector_of(motion.normal)))
        return "Its arc lies in no main plane.";
    if (motion.shape == FEELER_ARC) {
        const double gap =
            gap_in_plane(point_of(axis_values(motion.from)), point_of(axis_values(motion.to)),
                         *main_axis(vector_of(motion.normal)));
        if (gap > gcode::same_end && gap < gcode::other_end)
            return fmt::format("Its arc ends {:.2g} mm from its start, so it may be a full circle "
                               "or none.",
                               gap);
    }
    return problem_of_speeds(motion, judge_.setup().machine);
}

LiveAnswer LiveCheck::refused(LiveAnswer answer) {
    is_refused_ = true;
    return answer;
}

LiveAnswer LiveCheck::permitted(const LiveMotion& queued, const LiveMotion& checked) {
    waiting_.push_back({queued, checked, judge_.reached()});
    follows_probe_ = is_probing(checked);
    return {.may_move = true};
}

/// Brings the state to where a motion begins. Why it may not be judged at all; or empty.
std::string LiveCheck::begin(const LiveMotion& motion) {
    // It would begin where the motion that was refused ends.
    if (is_refused_ && !is_after_drop(motion)) return "A motion before it was refused.";
    if (std::string why = objection(motion); !why.empty()) return why;
    if (auto placed = place(motion); !placed) return placed.error().message;
    return {};
}

/// The motion with how far it may be off at the corner where it begins. How that is rounded, the
/// state knows from the motion before.
LiveMotion LiveCheck::with_corner(LiveMotion motion) {
    const bool is_rapid = motion.purpose == FEELER_RAPID;
    const auto is_blended_with = [&](const LiveMotion& before) {
        return before.blending == FEELER_BLENDED && is_rapid == (before.purpose == FEELER_RAPID)
               && moves_others(before) == moves_others(motion); // else it begins at rest
    };
    if (waiting_.empty() || is_after_drop(motion) || motion.from_rest != 0
        || !is_blended_with(waiting_.back().queued)) {
        ahead_->corners.last.by = 0.0;
        if (!waiting_.empty() && moves_others(waiting_.back().queued) != moves_others(motion))
            ahead_->corners.last = {};
        return motion;
    }
    const LiveMotion& before = waiting_.back().queued;
    motion.path_error = std::max(motion.path_error, before.path_error);
    motion.turn_error = std::max(motion.turn_error, before.turn_error);
    return motion;
}

LiveAnswer LiveCheck::judge(const LiveMotion& queued) {
    judge_.begin_retreat();
    if (std::string why = begin(queued); !why.empty()) return refused({.reason = std::move(why)});
    const LiveMotion motion = with_corner(queued);
    const std::vector<core::Event> events = events_of(motion, *ahead_);
    // The control does not know its tool when it starts.
    if (!tool_of(motion, judge_.setup())) {
        LiveAnswer answer = judge_.judge_with_each_tool(events, *ahead_);
        if (!answer.may_move) return refused(std::move(answer));
    }
    if (is_probing(motion))
        if (std::string why = judge_.problem_beyond_contact(events, *ahead_); !why.empty())
            return refused({.reason = std::move(why)});
    const bool follows_probe = std::exchange(follows_probe_, false);
    const core::SimulatorState before = follows_probe ? *ahead_ : core::SimulatorState();
    LiveAnswer answer = judge_.judge(events, *ahead_);
    if (answer.may_move) return permitted(queued, motion);
    // At the contact the tip is rarely where the stock is said to begin.
    if (follows_probe && !is_probing(motion)) {
        *ahead_ = before;
        if (judge_.judge_retreat(events, 0.0, *ahead_).may_move) return permitted(queued, motion);
    }
    return refused(std::move(answer));
}

LiveAnswer LiveCheck::judge_retreat(const LiveMotion& queued) {
    if (std::string why = begin(queued); !why.empty()) return refused({.reason = std::move(why)});
    const LiveMotion motion = with_corner(queued);
    const double rounded_before = ahead_->corners.last.by;
    const std::vector<core::Event> events = events_of(motion, *ahead_);
    if (!tool_of(motion, judge_.setup())) {
        LiveAnswer answer = judge_.judge_with_each_tool(events, *ahead_);
        if (!answer.may_move) return refused(std::move(answer));
    }
    // Bounds of a motion include how far the control may round its corners; those at rest do not.
    constexpr double most_rounding = 0.1; // mm
    const double of_mode =
        motion.blending != FEELER_BLENDED ? 0.0
        : moves_others(motion)
            ? motion.tolerance
            : motion.tolerance * core::most_blend_deviation(judge_.setup().machine);
    const double rounding =
        std::min(std::max(of_mode, rounded_before), most_rounding) + motion.path_error;
    LiveAnswer answer = judge_.judge_retreat(events, rounding, *ahead_);
    if (answer.may_move) return permitted(queued, motion);
    if (answer.cure.empty())
        answer.cure = "After a violation, only motions that lose no clearance may be made until "
                      "feeler-tp.clear is set.";
    return refused(std::move(answer));
}

} // namespace app
