#include "core/sim/leg/leg_context.h"

#include <algorithm>
#include <cassert>

#include "core/motion/path.h"
#include "core/sim/setup.h"

namespace core {

Pair pair_of(const MovingBody& body, std::optional<size_t> fixture) {
    return {body.kind, fixture, body.carried};
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

RelativeLeg LegContext::against_stock(const Mover& mover, const Leg& leg) const {
    RelativeLeg relative = relative_leg(setup.machine, setup.stock_mount, mover, leg);
    if (leg.path_error < infinity) relative.lasting_error += leg.path_error - leg.lasting_error;
    return relative;
}

const RelativeLeg& LegContext::against_stock(const MovingBody& body, const Leg& leg) const {
    last_legs.resize(bodies.size() + 1);
    // Bodies that are not in the list, such as a shrunk part, share the last place.
    size_t place = 0;
    while (place < bodies.size() && &bodies[place] != &body) ++place;
    auto& [known, relative] = last_legs[place];
    const bool same = place < bodies.size() && known.positions == leg.positions
                      && known.path_error == leg.path_error && known.turn_error == leg.turn_error
                      && known.lasting_error == leg.lasting_error && known.straight == leg.straight;
    if (same) return relative;
    relative = against_stock(body.mover, leg);
    known.positions = leg.positions;
    known.path_error = leg.path_error;
    known.turn_error = leg.turn_error;
    known.lasting_error = leg.lasting_error;
    known.straight = leg.straight;
    return relative;
}

double LegContext::finest_error(const MovingBody& body, const RelativeLeg& relative) const {
    const double cut = std::clamp(setup.mesh_size / 50.0, 0.002, 0.01);
    const double own = body.kind == PartKind::flutes  ? cut
                       : body.kind == PartKind::shank ? 2.0 * cut
                                                      : 10.0 * cut;
    // Much less than what stays makes no difference.
    return std::max(own, 0.2 * relative.lasting_error);
}

bool LegContext::is_sharp(const MovingBody& body, const RelativeLeg& relative, double lower) const {
    return relative.reducible_error()
           <= std::max(finest_error(body, relative), sharp_fraction * lower);
}

bool LegContext::is_too_vague(const RelativeLeg& relative) const {
    return relative.turns && relative.reducible_error() > sharp_fraction * setup.search_limit;
}

namespace {

/// Whether a part of the tool of which `is_asked` turns too far on a leg.
template <typename Asked>
bool turns_too_far(const LegContext& context, const Leg& leg, const Asked& is_asked) {
    if (!context.setup.machine.has_rotary() || leg.positions.size() != 2) return false;
    return std::any_of(context.bodies.begin(), context.bodies.end(), [&](const MovingBody& body) {
        if (body.body || !is_asked(body)) return false;
        const RelativeLeg& relative = context.against_stock(body, leg);
        return relative.turns && relative.reducible_error() > context.finest_error(body, relative);
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
