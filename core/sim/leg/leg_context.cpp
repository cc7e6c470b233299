#include "core/sim/leg/leg_context.h"

#include <algorithm>
#include <cassert>

#include "core/dbm/cut_model.h"
#include "core/distance/stock_distance.h"
#include "core/sim/leg/turning_parts.h"
#include "core/sim/setup.h"

namespace core {

Pair pair_of(const MovingBody& body, std::optional<size_t> fixture) {
    return {body.kind, fixture, body.carried};
}

CheckMemory::ToolState LegContext::tool_state() const {
    // Of a tool with two assemblies, only one knows the other.
    return {tool.description.number, tool.oriented != nullptr};
}

const MovingBody& LegContext::body_of(const Pair& pair) const {
    for (const MovingBody& body : bodies)
        if (body.kind == pair.part && body.carried == pair.carried) return body;
    assert(false);
    return bodies.front();
}

std::vector<const MovingBody*> LegContext::likely_first(std::optional<size_t> fixture) const {
    std::vector<const MovingBody*> order;
    for (const MovingBody& body : bodies) order.push_back(&body);
    std::stable_partition(order.begin(), order.end(), [&](const MovingBody* body) {
        return memory.deciding == pair_of(*body, fixture);
    });
    return order;
}

RelativeLeg LegContext::against_fixture(const MovingBody& body, size_t fixture,
                                        const Leg& leg) const {
    const Fixture& target = setup.fixtures[fixture];
    RelativeLeg relative = leg_against(setup, fixture, body, leg);
    if (target.play.none()) return relative;
    // As seen from the fixture, the body is displaced the other way.
    const Play play = rotated(-glm::transpose(target.mount.link_from_body.rotation), target.play);
    const bool is_mesh = body.body && !std::holds_alternative<ConvexShape>(*body.body);
    (is_mesh ? add_play_as_error : add_play)(relative, play);
    return relative;
}

namespace {

/// Whether all that a relative leg depends on is the same.
bool is_same(const Leg& a, const Leg& b) {
    return a.positions == b.positions && a.path_error == b.path_error
           && a.turn_error == b.turn_error && a.lasting_error == b.lasting_error
           && a.straight == b.straight;
}

void keep(Leg& known, const Leg& leg) {
    known.positions = leg.positions;
    known.path_error = leg.path_error;
    known.turn_error = leg.turn_error;
    known.lasting_error = leg.lasting_error;
    known.straight = leg.straight;
}

} // namespace

double LegContext::travel_against_fixture(const MovingBody& body, size_t fixture,
                                          const Leg& leg) const {
    constexpr size_t links = axis_count + 1;
    auto& [known, travels] = last_travels;
    if (travels.empty() || !is_same(known, leg)) {
        travels.assign(bodies.size() * links, -1.0);
        keep(known, leg);
    }
    const LinkId link = setup.fixtures[fixture].mount.link;
    const size_t place = link == LinkId::base ? axis_count : static_cast<size_t>(link);
    double& travel = travels[static_cast<size_t>(&body - bodies.data()) * links + place];
    if (travel < 0.0) travel = relative_leg(setup.machine, {link, {}}, body.mover, leg).travel;
    return travel;
}

RelativeLeg LegContext::against_stock(const Mover& mover, const Leg& leg) const {
    RelativeLeg relative = relative_leg(setup.machine, setup.stock_mount, mover, leg);
    if (leg.path_error < infinity) relative.lasting_error += leg.path_error - leg.lasting_error;
    return relative;
}

const std::vector<TurningPart>& LegContext::parts_of(const MovingBody& body, double shrink) const {
    auto& parts = memory.turning_parts[{tool_state(), body.kind, shrink}];
    if (!parts)
        parts = std::make_shared<const std::vector<TurningPart>>(
            shrink > 0.0 ? slender_parts(shrunk_around(*body.profile, shrink), body.mover)
                         : slender_parts(*body.profile, body.mover));
    return *parts;
}

const BodyLeg& LegContext::against_stock(const MovingBody& body, const Leg& leg) const {
    last_legs.resize(bodies.size() + 1);
    // Bodies that are not in the list, such as a shrunk part, share the last place.
    size_t place = 0;
    while (place < bodies.size() && &bodies[place] != &body) ++place;
    auto& [known, relative] = last_legs[place];
    if (place < bodies.size() && is_same(known, leg)) return relative;
    relative = {against_stock(body.mover, leg)};
    keep(known, leg);
    const bool is_divided = place < bodies.size() && relative.turns && relative.error < infinity
                            && body.profile && body.kind != PartKind::flutes
                            && relative.reducible_error() > finest_error(body, relative);
    if (!is_divided) return relative;
    const auto add = [&](std::vector<BodyLeg::Part>& legs, double shrink) {
        for (const TurningPart& part : parts_of(body, shrink)) {
            legs.push_back({&part.profile, against_stock(part.mover, leg)});
            if (part.mover.overlap > 0.0) relative.overlap = part.mover.overlap;
        }
    };
    add(relative.parts, 0.0);
    // Contact is told from overlap by the body shrunk a little.
    const Allowance allowance = allowance_of(setup, pair_of(body));
    const double shrink = contact_shrink(allowance, *body.profile);
    if (allowance.distance <= resolution && !relative.can_shrink(*body.profile, shrink)) {
        relative.shrink = shrink;
        add(relative.shrunk_parts, shrink);
    }
    if (relative.shape_error() >= relative.error) {
        relative.parts.clear();
        relative.shrunk_parts.clear();
    }
    return relative;
}

bool LegContext::stays_apart(const RevolvedProfile& profile, const RelativeLeg& leg,
                             const CutModel& stock, double by) const {
    const double needed = by + leg.error;
    const bool has_columns = stock.columns.u_count() > 0;
    if (!has_columns || !(needed < setup.search_limit)) return false;
    const StockGoal goal{.limit = needed, .bound = StockBound::lower, .coarse_below = needed};
    const StockSeparation found = separation(shapes_of(profile, leg), stock, goal);
    statistics.box_tests += found.box_tests;
    statistics.shape_tests += found.shape_tests;
    return found.separation.lower >= needed;
}

double LegContext::finest_error(const MovingBody& body, const RelativeLeg& relative) const {
    const double cut = std::clamp(setup.mesh_size / 50.0, 0.002, 0.01);
    // A body that may touch is decided by less than its usual clearance.
    const bool may_touch = allowance_of(setup, pair_of(body)).distance <= resolution;
    const double own = body.kind == PartKind::flutes               ? cut
                       : body.kind == PartKind::shank || may_touch ? 2.0 * cut
                                                                   : 10.0 * cut;
    // Much less than what stays makes no difference.
    return std::max(own, 0.2 * relative.lasting_error);
}

namespace {

/// Whether an error is small enough beside a lower bound.
bool is_sharp_by(double error, double finest, double lower) {
    return error <= std::max(finest, sharp_fraction * lower);
}

} // namespace

bool LegContext::is_sharp(const MovingBody& body, const RelativeLeg& relative, double lower) const {
    return is_sharp_by(relative.reducible_error(), finest_error(body, relative), lower);
}

bool LegContext::is_sharp(const MovingBody& body, const BodyLeg& relative, double lower) const {
    return is_sharp_by(relative.reducible_shape_error(), finest_error(body, relative), lower);
}

bool LegContext::is_too_vague(const RelativeLeg& relative) const {
    return relative.turns && relative.reducible_error() > sharp_fraction * setup.search_limit;
}

bool LegContext::is_too_vague(const BodyLeg& relative) const {
    return relative.turns && relative.reducible_shape_error() > sharp_fraction * setup.search_limit;
}

namespace {

/// Whether a part of the tool of which `is_asked` turns too far on a leg.
template <typename Asked>
bool turns_too_far(const LegContext& context, const Leg& leg, const Asked& is_asked) {
    if (!context.setup.machine.has_rotary() || leg.positions.size() != 2) return false;
    return std::any_of(context.bodies.begin(), context.bodies.end(), [&](const MovingBody& body) {
        if (body.body || !is_asked(body)) return false;
        const BodyLeg& relative = context.against_stock(body, leg);
        return relative.turns
               && relative.reducible_shape_error() > context.finest_error(body, relative);
    });
}

} // namespace

bool LegContext::flutes_turn_too_far(const Leg& leg) const {
    return turns_too_far(*this, leg,
                         [](const MovingBody& body) { return body.kind == PartKind::flutes; });
}

bool LegContext::others_turn_too_far(const Leg& leg) const {
    return turns_too_far(*this, leg,
                         [](const MovingBody& body) { return body.kind != PartKind::flutes; });
}

} // namespace core
