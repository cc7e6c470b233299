#include "core/sim/leg/flute_cut.h"

#include <cassert>

#include "core/dbm/covered_path.h"
#include "core/dbm/cut_ahead.h"
#include "core/motion/path.h"
#include "core/sim/leg/turning_parts.h"
#include "core/sim/setup.h"

namespace core {
namespace {

/// The next larger error in a geometric series with ratio 1.25, so that legs that turn share
/// cutters.
double rounded_up(double error) {
    double step = 1e-5;
    while (step < error) step *= 1.25;
    return step;
}

/// The box of a fixture in the stock's frame; empty if it moves relative to the stock.
std::optional<Aabb> box_in_stock(const Setup& setup, size_t fixture) {
    const Fixture& body = setup.fixtures[fixture];
    if (body.mount.link != setup.stock_mount.link) return std::nullopt;
    const Transform stock_from = stock_from_fixture(setup, fixture, {});
    const Play play = rotated(glm::transpose(body.mount.link_from_body.rotation), body.play);
    const Aabb own = displaced(bounds(body.body), play);
    Aabb box;
    for (int corner = 0; corner < 8; ++corner)
        box.extend(stock_from
                   * Vec3(corner & 1 ? own.max.x : own.min.x, corner & 2 ? own.max.y : own.min.y,
                          corner & 4 ? own.max.z : own.min.z));
    return box;
}

/// One move of an upright cylinder, as seen from the tool, that sweeps over everything that flutes
/// may reach within the hull of a leg.
CutterSweep around(const RevolvedProfile& flutes, const RelativeLeg& hull) {
    const Mat3 tool_from_stock = glm::transpose(hull.orientation);
    Aabb tips;
    for (const Vec3& position : hull.positions) tips.extend(tool_from_stock * position);
    const Aabb body = bounds(flutes);
    const Vec3 size = tips.size();
    const int along = size.x >= size.y ? 0 : 1, across = 1 - along;
    const double radius = body.max.x + 0.5 * size[across];
    const RevolvedProfile cylinder{{{body.min.z, radius, body.max.z + size.z, radius, 0.0}}};
    Vec3 from = tips.min;
    from[across] += 0.5 * size[across];
    Vec3 to = from;
    to[along] = tips.max[along];
    return {.cutter = std::make_shared<const Cutter>(make_cutter(cylinder, hull.error)),
            .from = hull.orientation * from,
            .to = hull.orientation * to,
            .orientation = hull.orientation};
}

} // namespace

Transform stock_from_fixture(const Setup& setup, size_t fixture, const AxisValues& values) {
    const Mount& mount = setup.fixtures[fixture].mount;
    if (mount.link == setup.stock_mount.link)
        return setup.stock_mount.link_from_body.inverse() * mount.link_from_body;
    return target_from_mover(setup.machine, setup.stock_mount, mount, values);
}

const RevolvedProfile& FluteCut::cutting_profile() const {
    const auto& certain = context_.tool.certain_flutes;
    return certain ? *certain : context_.tool.parts[0].profile;
}

std::shared_ptr<const Cutter> FluteCut::cutter_for(const RelativeLeg& leg, size_t part,
                                                   const RevolvedProfile& profile) {
    const double error = (leg.turns ? rounded_up(leg.error) : leg.error) + context_.setup.cut_error;
    auto& cutter = context_.memory.cutters[{context_.tool_state(), part, error}];
    if (cutter) return cutter;
    Cutter made = make_cutter(profile, error);
    if (part == 0) made.flutes = context_.tool.parts[0].profile;
    return cutter = std::make_shared<const Cutter>(std::move(made));
}

const std::vector<TurningPart>& FluteCut::parts() {
    auto& parts = context_.memory.turning_parts[{context_.tool_state(), PartKind::flutes, 0.0}];
    if (!parts)
        parts = std::make_shared<const std::vector<TurningPart>>(
            flute_parts(cutting_profile(), context_.bodies[0].mover, context_.setup.mesh_size));
    return *parts;
}

double FluteCut::along(const Leg& leg, CutModel& stock) {
    assert(leg.straight);
    if (context_.tool.parts.empty()) return 0.0;
    if (!context_.flutes_turn_too_far(leg)) return cut_with(sweep_on(leg), stock);
    if (is_away(context_.tool.parts[0].profile, context_.against_stock(context_.bodies[0], leg),
                stock))
        return 0.0;
    double removed = 0.0;
    for (size_t part = 0; part < parts().size(); ++part) removed += along(leg, part, stock);
    return removed;
}

double FluteCut::along(const Leg& leg, size_t part, CutModel& stock) {
    const TurningPart& flutes = parts()[part];
    const RelativeLeg way = context_.against_stock(flutes.mover, leg);
    if (!way.turns || way.reducible_error() <= context_.finest_error(context_.bodies[0], way))
        return cut_with(sweep_on(way, cutter_for(way, part + 1, flutes.profile)), stock);
    if (is_away(flutes.profile, way, stock)) return 0.0;
    const double removed = along(stretch(leg, 0.0, 0.5), part, stock);
    return removed + along(stretch(leg, 0.5, 1.0), part, stock);
}

double FluteCut::cut_with(const CutterSweep& sweep, CutModel& stock) {
    ++context_.statistics.sweeps;
    if (context_.replay) return context_.replay->cut(stock, sweep, context_.threads);
    return cut(stock, sweep, context_.threads);
}

bool FluteCut::is_away(const RevolvedProfile& profile, const RelativeLeg& way,
                       const CutModel& stock) const {
    return context_.stays_apart(profile, way, stock, context_.setup.cut_error + resolution);
}

std::unique_ptr<TrialCut> FluteCut::try_along(const Leg& leg, CutModel& stock) {
    assert(leg.straight);
    if (context_.tool.parts.empty()) return nullptr;
    ++context_.statistics.sweeps;
    return std::make_unique<TrialCut>(stock, sweep_on(leg));
}

double FluteCut::keep(TrialCut& trial, const Leg& leg, const CutModel& stock) {
    if (context_.replay) context_.replay->skip(stock, sweep_on(leg));
    return trial.keep();
}

CutterSweep FluteCut::sweep_on(const Leg& leg) {
    return sweep_on(context_.against_stock(context_.bodies[0], leg));
}

CutterSweep FluteCut::sweep_on(const RelativeLeg& way) {
    return sweep_on(way, cutter_for(way, 0, cutting_profile()));
}

CutterSweep FluteCut::sweep_on(const RelativeLeg& way, std::shared_ptr<const Cutter> cutter) const {
    return {.cutter = std::move(cutter),
            .from = way.positions.front(),
            .to = way.positions.back(),
            .orientation = way.orientation,
            .block = value_of(context_.block)};
}

void FluteCut::note_cut(const Leg& leg, size_t fixture) {
    if (!leg.straight || leg.positions.size() < 2) return;
    const auto box = box_in_stock(context_.setup, fixture);
    const RelativeLeg way = context_.against_stock(context_.bodies[0], leg);
    if (!box || way.turns || !overlaps(bounds(context_.bodies[0], way), *box)) return;
    context_.memory.cuts[fixture].push_back(sweep_on(way));
}

void FluteCut::may_cut(const Leg& leg, CutModel& certain) {
    if (context_.tool.parts.empty()) return;
    const RelativeLeg way = context_.against_stock(context_.bodies[0], leg);
    if (!leg.straight) {
        cut(certain, around(context_.tool.parts[0].profile, way));
        return;
    }
    along(leg, certain);
    if (!way.turns) context_.memory.passages.push_back(sweep_on(way));
}

bool FluteCut::is_in_own_cut(const Leg& leg, size_t fixture) const {
    const auto cuts = context_.memory.cuts.find(fixture);
    if (cuts == context_.memory.cuts.end() || !leg.straight) return false;
    const RelativeLeg way = context_.against_stock(context_.bodies[0], leg);
    if (way.turns || way.positions.size() > 2) return false;
    const auto box = box_in_stock(context_.setup, fixture);
    const Allowance contact = allowance_of(context_.setup, {PartKind::flutes});
    // Rounded corners may have left material.
    if (context_.memory.off_path > contact_depth(contact)) return false;
    return box
           && runs_in_own_cut(cuts->second, *box,
                              {.flutes = context_.tool.parts[0].profile,
                               .from = way.positions.front(),
                               .to = way.positions.back(),
                               .sideways = 0.5 * contact_depth(contact) - way.error,
                               .orientation = way.orientation});
}

} // namespace core
