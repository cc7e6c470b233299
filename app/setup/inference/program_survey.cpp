#include "app/setup/inference/program_survey.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>

#include "app/setup/tools/program_tools.h"
#include "core/base/math.h"
#include "core/motion/kinematics.h"
#include "core/sim/tool_assembly.h"
#include "gcode/exec/following.h"
#include "gcode/exec/interpreter.h"
#include "gcode/language/dialect.h"
#include "gcode/language/environment.h"
#include "gcode/language/lexer.h"
#include "gcode/lower/lowering.h"
#include "gcode/text/source.h"

namespace app {
namespace {

using core::Motion;
using core::MotionKind;
using core::Vec3;

/// The highest plane, to 0.1 mm, with much rapid travel: at least a fifth of that in the busiest
/// plane.
std::optional<double> plane_of(const std::map<int64_t, double>& travel) {
    constexpr double much = 0.2;
    double most = 0.0;
    for (const auto& [height, way] : travel) most = std::max(most, way);
    for (auto plane = travel.rbegin(); plane != travel.rend(); ++plane)
        if (plane->second >= much * most) return 0.1 * static_cast<double>(plane->first);
    return std::nullopt;
}

/// Sideways travel by height, in tenths of a millimetre.
struct Travel {
    std::map<int64_t, double> of_rapids, of_feeds;
    bool has_rapids = false;

    void note(bool rapid, const TipTrack& path) {
        has_rapids = has_rapids || rapid;
        const core::Vec3 &from = path.positions[0], &to = path.positions.back();
        if (!path.sideways || from.z != to.z) return;
        (rapid ? of_rapids : of_feeds)[core::round_to_integer(10.0 * path.lowest())] +=
            glm::distance(from, to);
    }

    /// The plane of rapid travel; without rapids, the highest plane above zero with feeds.
    std::optional<double> plane(double zero) const {
        if (has_rapids) return plane_of(of_rapids);
        if (of_feeds.empty()) return std::nullopt;
        const double height = 0.1 * static_cast<double>(of_feeds.rbegin()->first);
        return height > zero ? std::optional(height) : std::nullopt;
    }
};

/// Records everything but motions.
struct Notes {
    ProgramSurvey& result;
    double length = 0.0; // currently used by the control

    void operator()(const core::ToolChange& change) {
        auto& tools = result.tools;
        result.calls_tools = true;
        result.empties_spindle = result.empties_spindle || !change.tool;
        if (change.tool && std::find(tools.begin(), tools.end(), *change.tool) == tools.end())
            tools.push_back(*change.tool);
    }
    void operator()(const core::SpindleChange& spindle) {
        const bool turns = spindle.direction != core::SpindleDirection::stopped;
        result.turns_spindle = result.turns_spindle || turns;
        result.states_speed = result.states_speed || (turns && spindle.speed > 0.0);
    }
    void operator()(const core::LengthOffsetChange& change) {
        length = change.length;
        result.offsets_lengths = result.offsets_lengths || change.number.has_value();
    }
    template <typename Other>
    void operator()(const Other&) {} // irrelevant here
};

void note_cut(const TipTrack& path, double radius, ProgramSurvey& result) {
    if (!result.feeds) result.lowest = core::infinity;
    result.feeds = true;
    result.lowest = std::min(result.lowest, path.lowest());
    for (const Vec3& p : path.positions)
        result.cutting.extend(
            core::Aabb{p - Vec3(radius, radius, 0.0), p + Vec3(radius, radius, 0.0)});
    if (!path.sideways) return;
    if (!result.cuts_sideways) result.highest_cut = -core::infinity;
    result.cuts_sideways = true;
    result.highest_cut = std::max(result.highest_cut, path.lowest());
}

/// Program zero, machine frame, including G52 and G92.
Vec3 zero_of(const gcode::Offsets& offsets) {
    Vec3 zero(0.0);
    for (int axis = 0; axis < 3; ++axis)
        zero[axis] =
            offsets.work.origin[axis] + offsets.local[axis] + offsets.axis[axis].value_or(0.0);
    return zero;
}

/// Whether the program has set the active work offset itself.
bool sets_active_offset(const ProgramEvent& event, const gcode::Environment& environment) {
    const size_t active = event.offsets.active;
    return active < gcode::no_work_offset
           && event.offsets.work.origin != environment.work_offset(active);
}

/// Whether a motion is a feed that may cut. A probing move does not.
bool is_cut(const Motion& motion) {
    return motion.kind != MotionKind::rapid && !motion.stops_at_contact;
}

/// Tells taps by a spindle that turns back at the bottom of the hole.
class Tapping {
public:
    void operator()(const ProgramEvent& event, ProgramSurvey& result) {
        if (const auto* spindle = std::get_if<core::SpindleChange>(&event.event)) {
            const bool turns_back = event.is_cycle && line_ == event.line && fed_left_
                                    && spindle->direction == core::SpindleDirection::clockwise;
            if (turns_back && event.tool) result.left_taps.insert(*event.tool);
            direction_ = spindle->direction;
        }
        const auto* motion = std::get_if<Motion>(&event.event);
        if (!motion || !is_cut(*motion) || line_ == event.line) return;
        line_ = event.line;
        fed_left_ = direction_ == core::SpindleDirection::counterclockwise;
    }

private:
    core::SpindleDirection direction_ = core::SpindleDirection::stopped;
    uint32_t line_ = 0;     // of the last feed
    bool fed_left_ = false; // the first feed there was with the spindle counterclockwise
};

void add_work_area(const ProgramEvent& event, const TipTrack& path,
                   const gcode::Environment& environment, ProgramSurvey& result) {
    const size_t active = event.offsets.active;
    const auto [area, is_new] = result.work_areas.try_emplace(active);
    if (is_new) {
        area->second.zero = zero_of(event.offsets);
        area->second.first = event.offsets.work;
    }
    area->second.is_moved = area->second.is_moved || area->second.first != event.offsets.work;
    for (const Vec3& p : path.positions) area->second.reach.extend(p);
    area->second.way += path.length();
    if (active >= gcode::no_work_offset) return;
    const bool is_set = sets_active_offset(event, environment);
    area->second.is_set = area->second.is_set || is_set;
    result.sets_offsets = result.sets_offsets || is_set;
}

/// The axes besides X, Y and Z that no machine describes and that move or are away from 0: X, Y and
/// Z then say nothing about the work.
std::set<size_t> displaced_axes(const Motion& motion, const gcode::Offsets& offsets) {
    std::set<size_t> axes;
    for (size_t axis = 3; !offsets.machine && axis < core::axis_count; ++axis)
        if (motion.from[axis] != motion.to[axis]
            || gcode::is_away_from_zero(axis, motion.to[axis].value_or(0.0)))
            axes.insert(axis);
    return axes;
}

/// The zero of work offset `offset`, else of the first one with feeds.
Vec3 zero_of_offset(const gcode::Environment& environment, const std::optional<size_t>& offset,
                    const ProgramSurvey& seen) {
    auto found = seen.work_areas.begin();
    if (offset) found = seen.work_areas.find(*offset);
    if (found != seen.work_areas.end()) return found->second.zero;
    const gcode::AxisValues& origin = environment.work_offsets[0];
    return {origin[0], origin[1], origin[2]};
}

} // namespace

double size_of(const std::map<core::ToolNumber, double>& sizes,
               const std::optional<core::ToolNumber>& tool) {
    const auto found = sizes.find(tool.value_or(core::ToolNumber{0}));
    return found == sizes.end() ? 0.0 : found->second;
}

ProgramSurvey survey(const gcode::Program& program, const gcode::Environment& environment,
                     const SurveyTools& tools, const std::optional<size_t>& offset) {
    ProgramSurvey result;
    Notes notes{result};
    Travel travel;
    Tapping tapping;
    result.tool_names = visit_events(program, environment, [&](const ProgramEvent& event) {
        std::visit(notes, event.event);
        tapping(event, result);
        const auto* motion = std::get_if<Motion>(&event.event);
        if (!motion) return;
        const auto path =
            tip_track(*motion, size_of(tools.lengths, event.tool), event.offsets.machine);
        const std::set<size_t> displaced = displaced_axes(*motion, event.offsets);
        result.other_axes.insert(displaced.begin(), displaced.end());
        if (event.is_in_work && motion->from != motion->to) {
            bool& is_set = result.offsets[event.offsets.active];
            is_set = is_set || sets_active_offset(event, environment);
        }
        if (!path) return;
        if (displaced.empty()) travel.note(motion->kind == MotionKind::rapid, *path);
        if (!is_cut(*motion)) return;
        const core::ToolNumber tool = event.tool.value_or(core::ToolNumber{0});
        bool& mills = result.mills[tool];
        mills = mills || path->sideways;
        result.control_lengths.try_emplace(tool, notes.length);
        result.feeds_before_call = result.feeds_before_call || !result.calls_tools;
        add_work_area(event, *path, environment, result);
    });
    result.zero = zero_of_offset(environment, offset, result);
    result.retract = travel.plane(result.zero.z);
    const auto survey_cuts = [&] {
        visit_events(program, environment, [&](const ProgramEvent& event) {
            const auto* motion = std::get_if<Motion>(&event.event);
            if (!motion || !is_cut(*motion)) return;
            if (offset && event.offsets.active != *offset) return;
            if (!displaced_axes(*motion, event.offsets).empty()) return;
            const auto path =
                tip_track(*motion, size_of(tools.lengths, event.tool), event.offsets.machine);
            if (!path || (result.retract && path->lowest() >= *result.retract - 0.06)) return;
            note_cut(*path, size_of(tools.radii, event.tool), result);
        });
    };
    survey_cuts();
    if (!result.feeds && result.retract) { // rapids are at the depth of the cuts
        result.retract.reset();
        survey_cuts();
    }
    return result;
}

std::map<core::ToolNumber, std::string>
visit_events(const gcode::Program& program, const gcode::Environment& environment,
             const std::function<void(const ProgramEvent&)>& visit) {
    gcode::ProgramLibrary library(program, gcode::dialect(environment.dialect),
                                  environment.search_path);
    gcode::Interpreter interpreter(library, environment);
    gcode::InterpreterState state = gcode::initial_state(environment);
    gcode::Lowering lowering = gcode::initial_lowering(environment);
    std::optional<core::ToolNumber> tool;
    while (true) {
        const auto block = interpreter.next(state);
        if (!block || !*block) break;
        for (const core::Event& event : gcode::lower(**block, lowering)) {
            if (const auto* change = std::get_if<core::ToolChange>(&event)) tool = change->tool;
            visit({event, tool, lowering.offsets, (*block)->line, (*block)->is_cycle,
                   !(*block)->in_machine && !(*block)->goes_home});
        }
    }
    std::map<core::ToolNumber, std::string> names;
    for (const gcode::NamedTool& named : state.named_tools) names.emplace(named.number, named.name);
    return names;
}

namespace {

constexpr double sideways_from = 0.01; // mm

std::optional<Vec3> known(const core::AxisPosition& position) {
    if (!position[0] || !position[1] || !position[2]) return std::nullopt;
    return Vec3(*position[0], *position[1], *position[2]);
}

/// Adds points along an arc, enough that their box is accurate to a thousandth of the radius.
void add_arc(const core::ArcPath& arc, const Vec3& from, const Vec3& to,
             std::vector<Vec3>& positions) {
    constexpr int steps_per_turn = 72;
    const int u = (arc.normal + 1) % 3, v = (arc.normal + 2) % 3, w = arc.normal;
    const double du = from[u] - arc.centre[u], dv = from[v] - arc.centre[v];
    const int count =
        1
        + static_cast<int>(std::min(20.0, std::abs(arc.angle) / (2.0 * std::numbers::pi))
                           * steps_per_turn);
    for (int i = 1; i < count; ++i) {
        const double fraction = static_cast<double>(i) / count, angle = fraction * arc.angle;
        Vec3 p(0.0);
        p[u] = arc.centre[u] + du * core::cos(angle) - dv * core::sin(angle);
        p[v] = arc.centre[v] + du * core::sin(angle) + dv * core::cos(angle);
        p[w] = from[w] + fraction * (to[w] - from[w]);
        positions.push_back(p);
    }
}

bool turns(const core::Motion& motion) {
    for (size_t axis = 3; axis < 6; ++axis)
        if (motion.from[axis] != motion.to[axis]) return true;
    return false;
}

/// Replaces positions of the linear axes along a motion by those of the tip, as seen from the work
/// with all rotary axes at 0.
void put_in_work(const core::Motion& motion, double tool_length, const core::Machine* machine,
                 std::vector<Vec3>& positions) {
    constexpr int steps = 16; // of a motion that turns
    if (machine && motion.from != motion.to && positions.size() == 2 && turns(motion)) {
        const Vec3 first = positions[0], way = positions[1] - first;
        positions.clear();
        for (int i = 0; i <= steps; ++i) positions.push_back(first + way * (i / double{steps}));
    }
    for (size_t i = 0; i < positions.size(); ++i) {
        Vec3& p = positions[i];
        if (!machine) {
            p.z -= tool_length;
            continue;
        }
        const double fraction =
            positions.size() > 1 ? double(i) / static_cast<double>(positions.size() - 1) : 1.0;
        core::AxisValues values{};
        for (size_t axis = 0; axis < core::axis_count; ++axis) {
            const double start = motion.from[axis].value_or(0.0);
            values[axis] = axis < 3 ? p[static_cast<int>(axis)]
                                    : start + fraction * (motion.to[axis].value_or(0.0) - start);
        }
        p = core::tip_position(*machine, values, tool_length);
    }
}

} // namespace

double TipTrack::lowest() const {
    double z = core::infinity;
    for (const Vec3& p : positions) z = std::min(z, p.z);
    return z;
}

double TipTrack::length() const {
    double way = 0.0;
    for (size_t i = 1; i < positions.size(); ++i)
        way += glm::distance(positions[i - 1], positions[i]);
    return way;
}

std::optional<TipTrack> tip_track(const core::Motion& motion, double tool_length,
                                  const core::Machine* machine) {
    const auto from = known(motion.from), to = known(motion.to);
    if (!from || !to) return std::nullopt;
    TipTrack track;
    if (motion.tip) {
        const Vec3 longer(0.0, 0.0, motion.tip->tool_length - tool_length);
        track.positions = {motion.tip->from + longer, motion.tip->to + longer};
    } else {
        track.positions.push_back(*from);
        if (motion.arc) add_arc(*motion.arc, *from, *to, track.positions);
        track.positions.push_back(*to);
        put_in_work(motion, tool_length, machine, track.positions);
    }
    for (Vec3& p : track.positions) {
        track.sideways =
            track.sideways
            || core::hypot(p.x - track.positions[0].x, p.y - track.positions[0].y) > sideways_from;
    }
    return track;
}

namespace {

bool is_number_part(char c) { return (c >= '0' && c <= '9') || c == '.' || c == ']'; }

/// A code used only in turning: diameters or radii along X, constant surface speed, or roughing and
/// threading cycles, recognised by their words.
std::optional<std::string> turning_code(const std::string& code) {
    const auto has = [&](const char* letters) {
        return code.find_first_of(letters) != std::string::npos;
    };
    for (size_t at = code.find('G'); at != std::string::npos; at = code.find('G', at + 1)) {
        if (at > 0 && !is_number_part(code[at - 1])) continue;
        double value = 0.0;
        const char* end = code.data() + code.size();
        const auto [rest, failure] = std::from_chars(code.data() + at + 1, end, value);
        if (failure != std::errc()) continue;
        const bool diameters = value == 7.0 || value == 8.0;
        const bool limits_speed = value == 50.0 && has("S");
        const bool roughs = value >= 70.0 && value < 74.0 && has("QUW") && has("PUDR");
        const bool threads = value == 76.0 && has("K") && has("I");
        if (diameters || limits_speed || roughs || threads || value == 96.0)
            return code.substr(at, static_cast<size_t>(rest - code.data()) - at);
    }
    return std::nullopt;
}

/// T0101: tool and offset in one word, as on turret lathes.
std::optional<std::string> turret_word(const std::string& code) {
    for (size_t at = code.find('T'); at != std::string::npos; at = code.find('T', at + 1)) {
        const size_t end = std::min(code.size(), code.find_first_not_of("0123456789", at + 1));
        if (at > 0 && !is_number_part(code[at - 1])) continue;
        if (end - at == 5) return code.substr(at, 5);
    }
    return std::nullopt;
}

/// Whether a block moves an axis.
bool moves_axis(const std::string& code, char axis) {
    for (size_t at = code.find(axis); at != std::string::npos; at = code.find(axis, at + 1)) {
        const bool in_a_word = at > 0 && std::isalpha(static_cast<unsigned char>(code[at - 1]));
        if (at + 1 >= code.size() || (in_a_word && code[at - 1] != 'I')) continue;
        if (gcode::is_digit(code[at + 1])
            || std::string("+-.=[#").find(code[at + 1]) != std::string::npos)
            return true;
    }
    return false;
}

bool changes_tool(const std::string& code) {
    for (const char* word : {"M6", "M06"}) {
        const size_t at = code.find(word), end = at + std::string(word).size();
        if (at != std::string::npos && (end >= code.size() || !gcode::is_digit(code[end])))
            return true;
    }
    return false;
}

} // namespace

std::optional<std::string> turning_reason(const gcode::Program& program) {
    std::optional<std::string> code_reason, turret_reason, plane_reason;
    bool changes = false, moves_x = false;
    const auto say = [](std::optional<std::string>& reason, size_t line, const std::string& what) {
        if (!reason) reason = fmt::format("it never moves Y, and line {} has {}", line, what);
    };
    for (size_t line = 1; line <= program.line_count(); ++line) {
        const std::string code = parts_of_line(program.line(line)).code;
        if (moves_axis(code, 'Y')) return std::nullopt;
        moves_x = moves_x || moves_axis(code, 'X');
        changes = changes || changes_tool(code);
        if (const auto said = turning_code(code)) say(code_reason, line, *said);
        if (const auto turret = turret_word(code)) say(turret_reason, line, *turret);
        if (code.find("G18") != std::string::npos) say(plane_reason, line, "G18");
    }
    if (!moves_x) return std::nullopt;
    if (code_reason) return code_reason;
    return turret_reason && !changes ? turret_reason : plane_reason;
}

std::optional<size_t> line_that_asks_for_positions(const gcode::Program& program) {
    for (size_t line = 1; line <= program.line_count(); ++line) {
        const std::string code = parts_of_line(program.line(line)).code;
        const bool asks = code.find("SYSREAD") != std::string::npos;
        if (asks
            && (code.find("ID270") != std::string::npos || code.find("ID240") != std::string::npos))
            return line;
    }
    return std::nullopt;
}

} // namespace app
