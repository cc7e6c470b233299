#include "app/session/program_survey.h"

#include <algorithm>
#include <cmath>

#include "app/session/program_motions.h"

namespace app {
namespace {

using core::Motion;
using core::MotionKind;
using core::Vec3;

constexpr double sideways_from = 0.01; // mm

/// A motion of the tip; arcs by places on them.
struct TipPath {
    std::vector<Vec3> places;
    bool sideways = false;

    double lowest() const {
        double z = core::infinity;
        for (const Vec3& p : places) z = std::min(z, p.z);
        return z;
    }
};

std::optional<Vec3> known(const core::AxisPosition& position) {
    if (!position[0] || !position[1] || !position[2]) return std::nullopt;
    return Vec3(*position[0], *position[1], *position[2]);
}

/// Places along an arc, so many that its box is found to a thousandth of its radius.
void add_arc(const core::ArcPath& arc, const Vec3& from, const Vec3& to,
             std::vector<Vec3>& places) {
    constexpr int places_of_turn = 72;
    const int u = (arc.normal + 1) % 3, v = (arc.normal + 2) % 3, w = arc.normal;
    const double du = from[u] - arc.centre[u], dv = from[v] - arc.centre[v];
    const int count =
        1 + static_cast<int>(std::min(20.0, std::abs(arc.angle) / (2.0 * M_PI)) * places_of_turn);
    for (int i = 1; i < count; ++i) {
        const double share = static_cast<double>(i) / count, angle = share * arc.angle;
        Vec3 p(0.0);
        p[u] = arc.centre[u] + du * std::cos(angle) - dv * std::sin(angle);
        p[v] = arc.centre[v] + du * std::sin(angle) + dv * std::cos(angle);
        p[w] = from[w] + share * (to[w] - from[w]);
        places.push_back(p);
    }
}

std::optional<TipPath> path_of(const Motion& motion, double length) {
    const auto from = known(motion.from), to = known(motion.to);
    if (!from || !to) return std::nullopt;
    TipPath path;
    path.places.push_back(*from);
    if (motion.arc) add_arc(*motion.arc, *from, *to, path.places);
    path.places.push_back(*to);
    for (Vec3& p : path.places) {
        p.z -= length;
        path.sideways =
            path.sideways
            || std::hypot(p.x - path.places[0].x, p.y - path.places[0].y) > sideways_from;
    }
    return path;
}

double size_of(const std::map<core::ToolNumber, double>& sizes,
               const std::optional<core::ToolNumber>& tool) {
    const auto found = sizes.find(tool.value_or(core::ToolNumber{0}));
    return found == sizes.end() ? 0.0 : found->second;
}

/// The highest plane, to 0.1 mm, in which rapids travel much: a fifth of the way of the busiest
/// one.
std::optional<double> plane_of(const std::map<long, double>& travel) {
    constexpr double much = 0.2;
    double most = 0.0;
    for (const auto& [height, way] : travel) most = std::max(most, way);
    for (auto plane = travel.rbegin(); plane != travel.rend(); ++plane)
        if (plane->second >= much * most) return 0.1 * static_cast<double>(plane->first);
    return std::nullopt;
}

/// What a program says beside its motions.
struct Notes {
    ProgramSurvey& result;
    double length = 0.0; // that the control counts now

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
    void operator()(const core::Dwell&) {}
    void operator()(const core::PathModeChange&) {}
    void operator()(const core::FixtureChange&) {}
    void operator()(const core::Motion&) {}
};

void note_cut(const TipPath& path, double radius, ProgramSurvey& result) {
    if (!result.feeds) result.lowest = core::infinity;
    result.feeds = true;
    result.lowest = std::min(result.lowest, path.lowest());
    for (const Vec3& p : path.places)
        result.cutting.extend(
            core::Aabb{p - Vec3(radius, radius, 0.0), p + Vec3(radius, radius, 0.0)});
    if (!path.sideways) return;
    if (!result.cuts_sideways) result.highest_cut = -core::infinity;
    result.cuts_sideways = true;
    result.highest_cut = std::max(result.highest_cut, path.lowest());
}

} // namespace

ProgramSurvey survey(const gcode::Program& program, const gcode::Environment& environment,
                     const SurveyTools& tools) {
    ProgramSurvey result;
    Notes notes{result};
    std::map<long, double> travel; // of rapids sideways, by height in tenths of a millimetre
    visit_events(program, environment, [&](const ProgramEvent& event) {
        std::visit(notes, event.event);
        const auto* motion = std::get_if<Motion>(&event.event);
        if (!motion) return;
        const auto path = path_of(*motion, size_of(tools.lengths, event.tool));
        if (!path) return;
        if (motion->kind != MotionKind::rapid) {
            const core::ToolNumber tool = event.tool.value_or(core::ToolNumber{0});
            bool& mills = result.mills[tool];
            mills = mills || path->sideways;
            result.control_lengths.try_emplace(tool, notes.length);
            result.feeds_before_call = result.feeds_before_call || !result.calls_tools;
        } else if (path->sideways && path->places[0].z == path->places.back().z) {
            travel[std::lround(10.0 * path->lowest())] +=
                glm::distance(path->places[0], path->places.back());
        }
    });
    result.retract = plane_of(travel);
    const auto look_at_cuts = [&] {
        visit_events(program, environment, [&](const ProgramEvent& event) {
            const auto* motion = std::get_if<Motion>(&event.event);
            if (!motion || motion->kind == MotionKind::rapid) return;
            const auto path = path_of(*motion, size_of(tools.lengths, event.tool));
            if (!path || (result.retract && path->lowest() >= *result.retract - 0.06)) return;
            note_cut(*path, size_of(tools.radii, event.tool), result);
        });
    };
    look_at_cuts();
    if (!result.feeds && result.retract) { // rapids travel at the depth of the cuts
        result.retract.reset();
        look_at_cuts();
    }
    return result;
}

} // namespace app
