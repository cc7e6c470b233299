#include "core/sim/moving_body.h"

#include "core/base/math.h"
#include "core/dbm/covered_path.h"
#include "core/distance/shape_outline.h"
#include "core/motion/machine.h"
#include "core/motion/path.h"
#include "core/sim/setup.h"

namespace core {
namespace {

/// Whether a machine body moves against the work: it is not on the table side, nor on the base if
/// that carries the work.
bool moves_against_work(const Machine& machine, const MachineBody& body) {
    return body.link != machine.table && !is_on_table_side(machine, body.link);
}

/// The play of a part against the tip. A shank that is pulled out of the holder becomes longer; one
/// that is pushed in disappears in it.
Play play_of(PartKind kind, const ToolAssembly& tool) {
    if (kind == PartKind::flutes) return {};
    if (kind == PartKind::shank) return {.to = glm::max(tool.holder_play.most(), Vec3(0.0))};
    return tool.holder_play;
}

MovingBody moving_part(const Setup& setup, const ToolAssembly& tool, const ToolPart& part) {
    const Aabb box = bounds(part.profile);
    const Vec3 centre(0.0, 0.0, box.center().z);
    const double reach = core::hypot(box.max.x, 0.5 * box.size().z);
    return {.kind = part.kind,
            .profile = &part.profile,
            .mover = {{setup.machine.spindle, translation({0.0, 0.0, -tool.length})},
                      centre,
                      reach + part.profile.deviation,
                      part.profile.form_error,
                      part.profile.deviation,
                      play_of(part.kind, tool),
                      true}};
}

MovingBody moving_machine_body(const Setup& setup, const ToolAssembly& tool, size_t index) {
    const MachineBody& body = setup.machine.bodies[index];
    const Aabb box = bounds(body.body);
    const bool nose = body.name == name_of(PartKind::nose);
    // The spindle is above the tool by its true length, whatever the control takes for it.
    const Transform place =
        body.link == setup.machine.spindle ? translation({0.0, 0.0, tool.gauge_rise}) : body.place;
    return {.kind = nose ? PartKind::nose : PartKind::machine,
            .carried = index,
            .body = &body.body,
            .mover = {{body.link, place},
                      box.center(),
                      0.5 * glm::length(box.size()) + body.deviation,
                      body.deviation,
                      body.deviation,
                      setup.body_play.empty() ? tool.holder_play : setup.body_play[index]}};
}

ConvexShape moved(const ConvexShape& shape, const RelativeLeg& leg) {
    if (leg.orientation == Mat3(1.0)) return swept(shape, leg.positions);
    return swept(posed(shape, {leg.orientation, Vec3(0.0)}), leg.positions);
}

Separation between(const std::vector<ConvexShape>& shapes, const ExactBody& fixture, double limit,
                   size_t& shape_tests) {
    Separation best;
    double lower = infinity;
    const Aabb box = bounds(fixture);
    for (const ConvexShape& shape : shapes) {
        const double nearest = std::min(limit, best.upper);
        if (const double apart = distance_bound(outline(shape), box, nearest); apart >= nearest) {
            lower = std::min(lower, apart);
            continue;
        }
        ++shape_tests;
        const Separation found = separation(shape, fixture, {.limit = nearest});
        lower = std::min(lower, found.lower);
        if (found.upper < best.upper) best = found;
    }
    best.lower = std::min(lower, best.upper);
    return best;
}

} // namespace

std::vector<MovingBody> moving_bodies(const Setup& setup, const ToolAssembly& tool) {
    std::vector<MovingBody> bodies;
    for (const ToolPart& part : tool.parts) bodies.push_back(moving_part(setup, tool, part));
    if (tool.reach_is_assumed) return bodies;
    for (size_t i = 0; i < setup.machine.bodies.size(); ++i)
        if (moves_against_work(setup.machine, setup.machine.bodies[i]))
            bodies.push_back(moving_machine_body(setup, tool, i));
    return bodies;
}

double axis_tolerance_error(const Setup& setup, const ToolAssembly* tool, const Path& path) {
    if (!setup.machine.has_axis_tolerances()) return 0.0;
    static const ToolAssembly nothing;
    std::vector<LinkId> targets = {setup.stock_mount.link};
    for (const Fixture& fixture : setup.fixtures)
        if (std::find(targets.begin(), targets.end(), fixture.mount.link) == targets.end())
            targets.push_back(fixture.mount.link);
    double most = 0.0;
    for (const MovingBody& body : moving_bodies(setup, tool ? *tool : nothing))
        for (const LinkId target : targets)
            for (const Leg& leg : path.legs)
                most = std::max(most, axis_tolerance_error(setup.machine, target, body.mover, leg));
    return most;
}

RelativeLeg leg_against(const Setup& setup, std::optional<size_t> fixture, const MovingBody& body,
                        const Leg& leg) {
    if (!fixture) return relative_leg(setup.machine, setup.stock_mount, body.mover, leg);
    const Fixture& target = setup.fixtures[*fixture];
    RelativeLeg relative = relative_leg(setup.machine, target.mount, body.mover, leg);
    for (double* error : {&relative.error, &relative.lasting_error, &relative.deviation})
        *error += target.deviation;
    return relative;
}

bool follows_flutes(const Setup& setup, const ToolAssembly& tool, const MovingBody& part,
                    const Leg& leg, const CutModel& stock, const OwnMoves& own, int depth) {
    constexpr int deepest = 10;
    if (!part.profile || !leg.straight) return false;
    const RelativeLeg way = leg_against(setup, {}, part, leg);
    if (way.positions.size() > 2) return false;
    if (way.turns && way.error > 0.25 * own.sideways) {
        if (depth == deepest) return false;
        const std::array<Leg, 2> parts = halves(leg);
        return follows_flutes(setup, tool, part, parts[0], stock, own, depth + 1)
               && follows_flutes(setup, tool, part, parts[1], stock, own, depth + 1);
    }
    const Vec3 from = way.positions.front(), by = way.positions.back() - from;
    const double up = glm::dot(by, way.orientation[2]);
    const bool rises_sideways =
        up > resolution && glm::length(by - up * way.orientation[2]) > resolution;
    return stays_in_own_cut(
        stock, {.part = *part.profile,
                .flutes = tool.parts[0].profile,
                .from = from,
                .to = from + by,
                .sideways = own.sideways - way.error,
                .orientation = way.orientation,
                .first_move = static_cast<uint32_t>(own.first),
                .moves_end = rises_sideways ? static_cast<uint32_t>(own.before_block) : UINT32_MAX,
                .gap = own.sideways});
}

bool is_exempt(const Machine& machine, const MovingBody& body, const Fixture& fixture) {
    const LinkId a = body.mover.mount.link, b = fixture.mount.link;
    if (a == b) return true;
    if (!body.body || !fixture.is_machine) return false;
    const auto carrier = [&](LinkId link) {
        return link == LinkId::base ? link : machine.axes[static_cast<size_t>(link)].carrier;
    };
    return carrier(a) == b || carrier(b) == a;
}

Aabb bounds(const MovingBody& body, const RelativeLeg& leg) {
    const Aabb box = body.profile ? bounds(*body.profile) : bounds(*body.body);
    const Vec3 centre = leg.orientation * box.center();
    Vec3 half(0.0);
    for (int axis = 0; axis < 3; ++axis)
        half += 0.5 * box.size()[axis] * glm::abs(leg.orientation[axis]);
    Aabb swept;
    for (const Vec3& position : leg.positions)
        swept.extend(Aabb{centre + position - half, centre + position + half});
    return swept.grown(leg.error);
}

std::vector<ConvexShape> shapes_of(const RevolvedProfile& profile, const RelativeLeg& leg) {
    std::vector<ConvexShape> shapes;
    for (const ProfileElement& element : profile.elements)
        shapes.push_back(moved(convex(element), leg));
    return shapes;
}

std::vector<ConvexShape> shapes_of(const ExactBody& body, const RelativeLeg& leg) {
    if (const auto* shape = std::get_if<ConvexShape>(&body)) return {moved(*shape, leg)};
    const Mesh& mesh = *std::get<SolidMesh>(body).mesh;
    std::vector<ConvexShape> shapes;
    for (size_t i = 0; i < mesh.triangles.size(); ++i)
        shapes.push_back(moved(convex(mesh.triangle(i)), leg));
    return shapes;
}

std::vector<ConvexShape> shapes_of(const MovingBody& body, const BodyLeg& leg, double shrink) {
    if (!body.profile) return shapes_of(*body.body, leg);
    const auto moved = [&](const RevolvedProfile& profile, const RelativeLeg& way) {
        return shrink > 0.0 ? shapes_of(shrunk_around(profile, shrink), way)
                            : shapes_of(profile, way);
    };
    if (leg.parts.empty()) return moved(*body.profile, leg);
    std::vector<ConvexShape> shapes;
    const auto add = [&](const std::vector<ConvexShape>& some) {
        shapes.insert(shapes.end(), some.begin(), some.end());
    };
    if (shrink > 0.0 && shrink == leg.shrink && !leg.shrunk_parts.empty())
        for (const BodyLeg::Part& part : leg.shrunk_parts) add(shapes_of(*part.profile, part.leg));
    else
        for (const BodyLeg::Part& part : leg.parts) add(moved(*part.profile, part.leg));
    return shapes;
}

Separation distance_over(const RelativeLeg& leg, const RevolvedProfile& profile,
                         const ExactBody& fixture, double limit, size_t& shape_tests) {
    return between(shapes_of(profile, leg), fixture, limit, shape_tests);
}

Separation distance_over(const RelativeLeg& leg, const MovingBody& body, const ExactBody& fixture,
                         double limit, size_t& shape_tests) {
    if (body.profile) return distance_over(leg, *body.profile, fixture, limit, shape_tests);
    if (std::holds_alternative<ConvexShape>(*body.body) || leg.positions.size() > 2)
        return between(shapes_of(*body.body, leg), fixture, limit, shape_tests);
    ++shape_tests;
    Separation found = separation(fixture, *body.body, {leg.orientation, leg.positions.front()},
                                  leg.positions.back() - leg.positions.front(), {.limit = limit});
    std::swap(found.point_a, found.point_b);
    return found;
}

} // namespace core
