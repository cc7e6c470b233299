#include "app/coproc/device_check.h"

#include <algorithm>
#include <utility>

#include "core/dbm/covered_path.h"
#include "core/motion/path.h"
#include "core/sim/run/corner_plan.h"
#include "hwsim/body_cover.h"
#include "hwsim/tool_model.h"

namespace app {
namespace {

using core::Result;
using hwsim::SlotNumber;

constexpr double cylinder_tolerance = 0.02; // mm

/// Whether the model of a body fits this orientation: a body of revolution only needs an upright
/// axis, others must not be rotated.
bool is_upright_on(const core::MovingBody& body, const core::Mat3& orientation) {
    return body.profile ? orientation[2] == core::Vec3(0.0, 0.0, 1.0)
                        : orientation == core::Mat3(1.0);
}

/// Spacing of the model of a body: the mesh size of the set-up, or coarser for a large body.
double spacing_for(const core::Aabb& box, double mesh_size, double most_cells = 200.0) {
    const core::Vec3 size = box.size();
    return std::max({mesh_size, size.x / most_cells, size.y / most_cells, size.z / most_cells});
}

/// Spacing for tilted bodies, which are modelled again for each orientation.
double tilted_spacing(const core::RevolvedProfile& part, double mesh_size) {
    return spacing_for(bounds(part), mesh_size, 64.0);
}
double cube_side(const core::ExactBody& body, double mesh_size) {
    return spacing_for(bounds(body), mesh_size, 40.0);
}

} // namespace

double DeviceModels::excess(const core::MovingBody& body, const core::Mat3& orientation) const {
    const bool is_upright = is_upright_on(body, orientation);
    // The diagonal of a cell; half of it by which a part is enlarged, plus the excess of the
    // cylinder around a post; the diagonal of a cube.
    if (body.profile)
        return is_upright ? cylinder_tolerance
                          : 1.7 * tilted_spacing(*body.profile, setup_->mesh_size);
    return is_upright ? 1.7 * spacing_for(bounds(*body.body), setup_->mesh_size)
                      : 1.8 * cube_side(*body.body, setup_->mesh_size);
}

Result<std::vector<hwsim::Record>> DeviceModels::records_of(const core::MovingBody& body,
                                                            double shrink,
                                                            const core::Mat3& orientation) {
    const bool is_upright = is_upright_on(body, orientation);
    std::vector<hwsim::Record> posts;
    if (body.profile) {
        const core::RevolvedProfile part =
            shrink > 0.0 ? shrunk_around(*body.profile, shrink) : *body.profile;
        if (part.empty()) return posts;
        if (is_upright) return hwsim::cylinders_round(part, cylinder_tolerance);
        FEELER_TRY(posts, hwsim::posts_round(part, tilted_spacing(*body.profile, setup_->mesh_size),
                                             orientation));
        return hwsim::cylinders_round(posts);
    }
    if (is_upright) {
        FEELER_TRY(posts, hwsim::posts_round(*body.body,
                                             spacing_for(bounds(*body.body), setup_->mesh_size)));
        return hwsim::cylinders_round(posts);
    }
    hwsim::CubeCover& cubes = cubes_[body.carried];
    if (cubes.centres.empty())
        cubes = hwsim::cubes_round(*body.body, cube_side(*body.body, setup_->mesh_size));
    return hwsim::cylinders_round(cubes, orientation);
}

Result<SlotNumber> DeviceModels::of_body(hwsim::Driver& driver, const core::MovingBody& body,
                                         double shrink, const core::Mat3& orientation) {
    const Key key{body.kind, body.carried, shrink};
    const auto known = bodies_.find(key);
    if (known != bodies_.end()) {
        const bool is_same =
            known->second.orientation == orientation
            || (is_upright_on(body, orientation) && is_upright_on(body, known->second.orientation));
        if (is_same) return known->second.slot;
        hwsim::unload(driver, known->second.slot);
        bodies_.erase(known);
    }
    FEELER_TRY(std::vector<hwsim::Record> records, records_of(body, shrink, orientation));
    FEELER_TRY(const SlotNumber slot,
               hwsim::load_records(driver, hwsim::Side::tool, std::move(records)));
    bodies_[key] = {slot, orientation};
    return slot;
}

Result<SlotNumber> DeviceModels::of_fixture(hwsim::Driver& driver, size_t fixture) {
    if (fixtures_[fixture]) return *fixtures_[fixture];
    const core::ExactBody& body = setup_->fixtures[fixture].body;
    FEELER_TRY(std::vector<hwsim::Record> posts,
               hwsim::posts_round(body, spacing_for(bounds(body), setup_->mesh_size)));
    FEELER_TRY(fixtures_[fixture],
               hwsim::load_records(driver, hwsim::Side::work, std::move(posts)));
    return *fixtures_[fixture];
}

void DeviceModels::use_tool(hwsim::Driver& driver, const core::ToolAssembly* tool) {
    if (tool == tool_) return;
    tool_ = tool;
    for (auto known = bodies_.begin(); known != bodies_.end();) {
        const core::PartKind kind = std::get<core::PartKind>(known->first);
        const bool is_of_tool = kind == core::PartKind::flutes || kind == core::PartKind::shank
                                || kind == core::PartKind::holder;
        if (is_of_tool) hwsim::unload(driver, known->second.slot);
        known = is_of_tool ? bodies_.erase(known) : std::next(known);
    }
}

namespace {

/// Who reports why a motion cannot be asked about: the finding of the permit, or the run itself.
enum class Teller : uint8_t { permit, run };

void deny(BlockPermit& permit, std::string why, Teller teller = Teller::permit) {
    permit.is_reported =
        teller == Teller::run && (permit.not_queried.empty() || permit.is_reported);
    permit.not_queried = std::move(why);
}

hwsim::PathSegment segment_of(const core::RelativeLeg& way, SlotNumber tool, SlotNumber work,
                              double distance) {
    return {.from = way.positions.front(),
            .to = way.positions.back(),
            .pairs = {{tool, work, distance}}};
}

/// The entry of a pair in a block's permit; added if it is missing.
QueriedPair& entry_of(BlockPermit& permit, const core::Pair& pair, const core::Setup& setup) {
    for (QueriedPair& known : permit.pairs)
        if (known.pair == pair) return known;
    return permit.pairs.emplace_back(QueriedPair{pair, allowance_of(setup, pair)});
}

/// Records a stop. Only the first of several stops is reported.
void note_stop(PushedBlock& block, const hwsim::DeviceReport& report, const core::Setup& setup) {
    BlockPermit& permit = block.permit;
    const bool is_first = permit.stop == hwsim::Stop::none;
    if (is_first) permit.stop = report.stop;
    if (is_first) permit.report = report;
    if (report.stop_sequence - block.first >= block.asked.size()) return;
    const core::Pair& refused = block.asked[report.stop_sequence - block.first];
    if (!permit.pair) permit.pair = refused;
    entry_of(permit, refused, setup).refused = true;
}

} // namespace

BlockPermit answered(PushedBlock block, const hwsim::DeviceReport& report,
                     const core::Setup& setup) {
    if (report.stop != hwsim::Stop::none) note_stop(block, report, setup);
    BlockPermit& permit = block.permit;
    if (permit.stop == hwsim::Stop::none) permit.report = report;
    const uint32_t last = block.first + static_cast<uint32_t>(block.asked.size()) - 1;
    if (permit.stop == hwsim::Stop::none && !block.asked.empty()
        && static_cast<int32_t>(report.permitted - last) < 0)
        deny(permit, "the device has not permitted all of it");
    permit.permitted = permit.is_checked() && permit.stop == hwsim::Stop::none;
    return std::move(permit);
}

Result<CoprocessorCheck> CoprocessorCheck::with(hwsim::DevicePort port, const core::Setup& setup,
                                                const core::CutModel& stock, QueryScope asking) {
    FEELER_TRY(hwsim::Driver driver, hwsim::open_device(std::move(port)));
    CoprocessorCheck check(std::move(driver), setup, asking);
    FEELER_TRY(check.stock_, hwsim::load_stock(check.driver_, stock));
    return check;
}

Result<PushedBlock> CoprocessorCheck::push(std::span<const core::Event> block,
                                           const core::SimulatorState& before,
                                           const std::string& doubt) {
    PushedBlock pushed{.permit = {.doubt = doubt}, .first = driver_.next_sequence};
    if (auto updated = hwsim::update_stock(driver_, stock_, before.stock); !updated)
        return tl::unexpected(std::move(updated).error());
    At at{.stock = before.stock,
          .spindle = before.spindle,
          .corners = before.corners,
          .position = before.position,
          .mounted_fixtures = before.mounted_fixtures,
          .centre = before.centre};
    at.is_cycle = std::count_if(block.begin(), block.end(),
                                [](const core::Event& event) {
                                    return std::holds_alternative<core::Motion>(event);
                                })
                  > 1;
    hold(before.tool, at);
    at.tool_known = before.tool_known;
    at.is_assumed = before.is_assumed;
    for (size_t i = 0; i < core::axis_count; ++i)
        if (before.spread.below[i] != 0.0 || before.spread.above[i] != 0.0)
            at.uncertain |= static_cast<core::AxisSet>(1U << i);
    for (const core::Event& event : block)
        if (auto asked = query_event(event, at, pushed); !asked)
            return tl::unexpected(std::move(asked).error());
    return pushed;
}

Result<BlockPermit> CoprocessorCheck::ask(std::span<const core::Event> block,
                                          const core::SimulatorState& before,
                                          const std::string& doubt) {
    FEELER_TRY(PushedBlock pushed, push(block, before, doubt));
    const hwsim::DeviceReport now = hwsim::wait_for_all(driver_);
    if (now.stop != hwsim::Stop::none) hwsim::recover(driver_);
    return answered(std::move(pushed), now, *setup_);
}

hwsim::Stop CoprocessorCheck::collect_answers(PushedBlock& block) {
    const hwsim::DeviceReport now = hwsim::wait_for_all(driver_);
    if (now.stop != hwsim::Stop::none) {
        note_stop(block, now, *setup_);
        hwsim::recover(driver_);
    }
    block.asked.clear();
    block.first = driver_.next_sequence;
    return now.stop;
}

Result<void> CoprocessorCheck::query_event(const core::Event& event, At& at, PushedBlock& block) {
    if (const auto* motion = std::get_if<core::Motion>(&event)) {
        const core::ToolAssembly* held = at.tool;
        // A cycle has stopped the spindle of a boring bar, to move its edge off the wall.
        const bool is_oriented = held && held->oriented && at.is_cycle
                                 && at.spindle.direction == core::SpindleDirection::stopped;
        if (is_oriented) at.tool = held->oriented.get();
        auto queried = query_motion(*motion, at, block);
        at.tool = held;
        return queried;
    }
    if (const auto* spindle = std::get_if<core::SpindleChange>(&event)) at.spindle = *spindle;
    if (const auto* change = std::get_if<core::PathModeChange>(&event))
        change_mode(at.corners, *change, setup_->machine);
    if (std::holds_alternative<core::Dwell>(event)) at.corners.last = {};
    if (const auto* change = std::get_if<core::ToolChange>(&event)) {
        at.corners.last = {};
        hold(change->tool, at);
        return query_standstill(at, block);
    }
    if (const auto* change = std::get_if<core::FixtureChange>(&event)) {
        at.mounted_fixtures[change->fixture] = change->is_there;
        if (change->is_there) return query_standstill(at, block);
    }
    return {};
}

void CoprocessorCheck::hold(const std::optional<core::ToolNumber>& tool, At& at) const {
    const auto found = tool ? setup_->tools.find(*tool) : setup_->tools.end();
    at.tool = found == setup_->tools.end() ? nullptr : &found->second;
    at.called = tool;
    at.tool_known = true;
}

Result<void> CoprocessorCheck::query_standstill(At& at, PushedBlock& block) {
    const core::Path path = path_of({.from = at.position, .to = at.position}, setup_->machine, 0.0);
    if (path.legs.empty() || !path.legs[0].start_known) return {};
    at.off_motion = std::max(at.off_motion, core::axis_tolerance_error(*setup_, at.tool, path));
    return query_leg({.positions = {path.legs[0].positions[0]}}, false, at, block);
}

Result<void> CoprocessorCheck::query_motion(const core::Motion& motion, At& at,
                                            PushedBlock& block) {
    const core::Path path = path_of(motion, setup_->machine, core::chord_error(setup_->mesh_size));
    if (motion.from != at.position) at.corners.last = {};
    at.position = motion.to;
    const core::AxisSet uncertain =
        std::exchange(at.uncertain, uncertain_after(motion, at.uncertain));
    if (uncertain != 0 || at.uncertain != 0) {
        deny(block.permit, "a probing move may end anywhere on its way", Teller::run);
        return {};
    }
    const bool rapid = motion.kind == core::MotionKind::rapid;
    // A permit is needed before the next motion is known, so whole rapids count as rounded by a
    // tolerance. Where they keep their speed, the corner is asked about with the second one.
    const auto of_rapids = [](const core::CornerLimit& limit) {
        return limit.keeps_speed() ? 0.0 : limit.deviation;
    };
    at.off_motion = rapid ? std::max(of_rapids(at.corners.rapids), of_rapids(at.corners.mixed))
                          : at.corners.of_feed(motion.arc.has_value());
    // A spindle of unknown content counts as empty until the program feeds.
    if (!at.tool && !(!at.called && (at.tool_known || rapid))) {
        deny(block.permit, "the tool is unknown", Teller::run);
        return {};
    }
    for (size_t i = 0; i < at.is_assumed.size(); ++i)
        at.is_assumed[i] = at.is_assumed[i] && motion.from[i] == motion.to[i];
    const bool may_hold_any =
        !at.tool && !at.called && !at.tool_known && at.is_assumed == std::array<bool, 3>{};
    if (!at.tool && !may_hold_any && setup_->machine.bodies.empty()) return {};
    if (path.legs.empty() || !path.legs[0].start_known) {
        if (!at.tool && setup_->machine.bodies.empty()) return {};
        deny(block.permit, "the start position of the motion is unknown", Teller::run);
        return {};
    }
    if (may_hold_any)
        if (auto asked = query_each_tool(path.legs, at, block); !asked) return asked;
    const bool cutting =
        !rapid && at.tool && turns_to_cut(at.spindle, *at.tool) && cuts_along(*at.tool, motion);
    const double off_by_axes = core::axis_tolerance_error(*setup_, at.tool, path);
    if (auto done = update_models(at); !done) return done;
    if (cutting) {
        at.corners.note_cut(at.called, motion.arc.has_value(), at.stock.log.size());
        at.corners.by_axes_of_cuts = std::max(at.corners.by_axes_of_cuts, off_by_axes);
    }
    const core::CornerPlan corner =
        plan_corner({.setup = *setup_,
                     .tool = at.tool,
                     .motion = motion,
                     .path = path,
                     .cuts = cutting,
                     .may_cut = cutting || (rapid && at.tool && turns_to_cut(at.spindle, *at.tool)),
                     .off_path = rapid ? 0.0 : at.off_motion,
                     .stock = at.stock.outer_box},
                    at.corners);
    const bool between_feeds = !rapid && at.corners.last.kind != core::MotionKind::rapid;
    const bool rises = std::all_of(path.legs.begin(), path.legs.end(), core::rises);
    // A rapid that rises leaves its cut sideways at a rounded corner before it.
    const bool is_rounded =
        rapid && at.off_motion > 0.0 && at.corners.last.kind == core::MotionKind::rapid;
    at.off_motion += off_by_axes;
    if (auto asked = query_corner(corner, between_feeds, at, block); !asked) return asked;
    at.corners.note_corner_of_cuts(corner.of_cuts);
    at.follows = {};
    if (off_by_axes + at.corners.by_axes_of_cuts == 0.0) {
        const bool leaves = rises && !is_rounded, is_single = rapid && !at.is_cycle;
        const bool may_cut = leaves || (at.tool && turns_to_cut(at.spindle, *at.tool));
        at.follows = {may_cut && follows_cuts(at.corners, at.called, leaves, is_single),
                      first_own_cut(at.corners, at.called, leaves, is_single)};
    }
    note_corner(at.corners, motion, path);
    for (const core::Leg& leg : path.legs) {
        if (auto done = update_models(at); !done) return done;
        if (pushes_centre(leg, cutting, at))
            deny(block.permit, "the tool's centre, which does not cut, is pushed into the stock",
                 Teller::run);
        if (auto walked = walk(leg, cutting, at, block); !walked) return walked;
    }
    return {};
}

Result<void> CoprocessorCheck::query_each_tool(const std::vector<core::Leg>& legs, At& at,
                                               PushedBlock& block) {
    at.follows = {};
    for (const auto& [number, held] : setup_->tools) {
        if (held.reach_is_assumed) continue;
        at.tool = &held;
        for (const core::Leg& leg : legs)
            if (auto walked = walk(leg, false, at, block); !walked) return walked;
    }
    at.tool = nullptr;
    return {};
}

namespace {

/// Straight legs near which the bodies stay at a corner between two straight legs, wherever they
/// are in the triangle of the corner and the ends of these.
std::vector<core::Leg> strips_of(const core::Leg& before, const core::Leg& after) {
    constexpr double wanted = 1.0; // mm
    constexpr int most = 24;
    const double longest = std::max(core::length_of({&before, 1}), core::length_of({&after, 1}));
    const int count = std::clamp(static_cast<int>(longest / (2.0 * wanted)) + 1, 1, most);
    std::vector<core::Leg> strips;
    for (int i = 0; i < count; ++i) {
        const double to_corner = (i + 0.5) / count;
        core::Leg strip = after;
        strip.positions = {stretch(before, to_corner, 1.0).positions.front(),
                           stretch(after, 0.0, 1.0 - to_corner).positions.back()};
        const double off = longest / (2.0 * count);
        strip.path_error = std::max(before.path_error, after.path_error) + off;
        strip.lasting_error = std::max(before.lasting_error, after.lasting_error) + off;
        strips.push_back(std::move(strip));
    }
    return strips;
}

bool is_plain(const core::Leg& leg) {
    return leg.straight && leg.positions.size() == 2 && leg.arc.motion == nullptr;
}

/// The legs beside all parts of the rest of a motion, in parts small enough.
std::vector<core::Leg> beside_rest(const std::vector<core::Leg>& rest,
                                   const std::vector<core::Leg>& legs) {
    constexpr size_t most_parts = 12;
    constexpr double small = 25.0; // size of a part
    std::vector<core::RestPart> parts;
    for (const core::Leg& leg : rest) parts.push_back({.rest = &leg});
    std::vector<core::Leg> all;
    for (size_t i = 0; i < parts.size(); ++i) {
        const core::RestPart part = parts[i];
        if (part.size() > small && parts.size() < most_parts) {
            for (const core::RestPart& half : part.halves()) parts.push_back(half);
            continue;
        }
        for (core::Leg& leg : part.beside(legs, rest.back().positions.back()))
            all.push_back(std::move(leg));
    }
    return all;
}

} // namespace

Result<void> CoprocessorCheck::query_corner(const core::CornerPlan& plan, bool between_feeds,
                                            At& at, PushedBlock& block) {
    if (plan.kind == core::CornerPlan::Kind::nothing) return {};
    const bool is_region = plan.kind == core::CornerPlan::Kind::region;
    const std::vector<core::Leg>& along = plan.along;
    const bool has_strips = is_region && !between_feeds && along.size() == 2
                            && std::all_of(along.begin(), along.end(), is_plain);
    const bool is_on_path = is_region && !along.empty() && !has_strips;
    const std::vector<core::Leg> legs = has_strips   ? strips_of(along[0], along[1])
                                        : is_on_path ? along
                                        : is_region
                                            ? plan.anywhere
                                            : beside_rest(at.corners.last.rest, plan.anywhere);
    if (auto done = update_models(at); !done) return done;
    const double off_motion =
        std::exchange(at.off_motion, core::axis_tolerance_error(*setup_, at.tool, {.legs = legs})
                                         + (is_on_path ? plan.deviation : 0.0));
    at.follows = {};
    at.at_corner = true;
    for (const core::Leg& leg : legs)
        if (auto walked = walk(leg, plan.may_cut, at, block); !walked) return walked;
    at.at_corner = false;
    at.off_motion = off_motion;
    return {};
}

bool CoprocessorCheck::pushes_centre(const core::Leg& leg, bool cutting, At& at) const {
    if (!at.tool || at.tool->description.cuts_at_centre) return false;
    if (!cutting || !leg.straight) {
        at.centre = {};
        return false;
    }
    const core::Mount tip{setup_->machine.spindle, core::translation({0.0, 0.0, -at.tool->length})};
    const core::RelativeLeg way =
        relative_leg(setup_->machine, setup_->stock_mount, {.mount = tip}, leg);
    return follow(at.centre, at.tool->description, way, at.stock).has_value();
}

Result<void> CoprocessorCheck::walk(const core::Leg& leg, bool cutting, At& at, PushedBlock& block,
                                    int depth) {
    constexpr int most_halvings = 8;
    if (depth < most_halvings && is_too_vague(leg, at)) {
        for (const core::Leg& half : {stretch(leg, 0.0, 0.5), stretch(leg, 0.5, 1.0)})
            if (auto walked = walk(half, cutting, at, block, depth + 1); !walked) return walked;
        return {};
    }
    if (auto asked = query_leg(leg, cutting, at, block); !asked) return asked;
    if (cutting && !at.at_corner) note_cut(leg, at);
    return {};
}

bool CoprocessorCheck::is_too_vague(const core::Leg& leg, const At& at) const {
    if (!leg.straight || leg.positions.size() != 2
        || turn_of(setup_->machine, leg.positions[0], leg.positions[1]) == 0.0)
        return false;
    const double fine = std::max(0.25, setup_->mesh_size); // mm
    static const core::ToolAssembly nothing;
    const core::ExactBody stock = core::convex(at.stock.outer_box);
    for (const core::MovingBody& body : moving_bodies(*setup_, at.tool ? *at.tool : nothing)) {
        const auto is_vague = [&](std::optional<size_t> fixture, const core::ExactBody& other) {
            const Question q = question(body, fixture, leg, at);
            if (!q.way.turns || q.way.reducible_error() <= fine) return false;
            const double keep = q.allowance.distance + q.off_path + 2.0 * setup_->mesh_size
                                + models_.excess(body, q.way.orientation) + q.way.error;
            size_t tests = 0;
            return !std::isfinite(keep)
                   || distance_over(q.way, body, other, keep, tests).lower < keep;
        };
        if (is_vague({}, stock)) return true;
        for (size_t i = 0; i < setup_->fixtures.size(); ++i)
            if (at.mounted_fixtures[i] && !is_exempt(setup_->machine, body, setup_->fixtures[i])
                && is_vague(i, setup_->fixtures[i].body))
                return true;
    }
    return false;
}

Result<void> CoprocessorCheck::query_leg(const core::Leg& leg, bool cutting, At& at,
                                         PushedBlock& block) {
    if (!leg.straight) {
        deny(block.permit, "the path of the motion is unknown");
        return {};
    }
    static const core::ToolAssembly nothing;
    models_.use_tool(driver_, at.tool);
    if (auto done = update_models(at); !done) return done;
    for (const core::MovingBody& body : moving_bodies(*setup_, at.tool ? *at.tool : nothing)) {
        const bool cuts = cutting && body.kind == core::PartKind::flutes;
        const Question stock = question(body, {}, leg, at);
        if (!cuts && !is_clear_at_corner(stock, at.stock.outer_box, at)
            && !is_far(stock, core::convex(at.stock.outer_box), block)) {
            const auto ask = is_in_own_cut(stock, at) ? &CoprocessorCheck::measure_pair
                                                      : &CoprocessorCheck::query_pair;
            if (auto asked = (this->*ask)(stock, stock_, block); !asked) return asked;
        }
        for (size_t i = 0; i < setup_->fixtures.size(); ++i) {
            const core::Fixture& fixture = setup_->fixtures[i];
            if (!at.mounted_fixtures[i] || is_exempt(setup_->machine, body, fixture)
                || (cuts && fixture.expendable))
                continue;
            const Question q = question(body, i, leg, at);
            if (is_clear_at_corner(q, bounds(fixture.body), at)) continue;
            if (is_far(q, fixture.body, block)) continue;
            FEELER_TRY(const SlotNumber work, models_.of_fixture(driver_, i));
            if (auto asked = query_pair(q, work, block); !asked) return asked;
        }
    }
    return {};
}

bool CoprocessorCheck::is_clear_at_corner(const Question& q, const core::Aabb& other,
                                          const At& at) {
    const double keep = q.allowance.distance + q.way.error + q.off_path;
    return at.at_corner && distance(bounds(q.body, q.way), other) > keep;
}

bool CoprocessorCheck::is_far(const Question& q, const core::ExactBody& other,
                              PushedBlock& block) const {
    const double limit = setup_->search_limit + q.way.error + q.off_path;
    if (!q.body.body || !std::isfinite(limit)) return false;
    size_t tests = 0;
    if (distance(bounds(q.body, q.way), bounds(other)) < setup_->search_limit + q.off_path
        && distance_over(q.way, q.body, other, limit, tests).lower < limit)
        return false;
    QueriedPair& asked = entry_of(block.permit, q.pair, *setup_);
    asked.lower = std::min(asked.lower, setup_->search_limit);
    return true;
}

CoprocessorCheck::Question CoprocessorCheck::question(const core::MovingBody& body,
                                                      std::optional<size_t> fixture,
                                                      const core::Leg& leg, const At& at) const {
    const core::Pair pair{body.kind, fixture, body.carried};
    const core::Allowance allowance = allowance_of(*setup_, pair);
    const double off = path_deviation(pair, at.off_motion, at.corners);
    // Bodies may touch if they can deviate from the path by no more than the contact tolerance.
    const auto follows = [&] {
        if (fixture || !at.tool || !fits_own_cut(*at.tool, body.kind)) return false;
        if (body.kind == core::PartKind::flutes) return at.follows.flutes;
        return at.follows.first_cut
               && follows_flutes(
                   *setup_, *at.tool, body, leg, at.stock,
                   {.first = *at.follows.first_cut,
                    .before_block = at.stock.log.size(),
                    .sideways = std::max(at.corners.own.by, 0.5 * contact_depth(allowance))});
    };
    const bool may_touch =
        allowance.distance <= core::resolution && (off <= contact_depth(allowance) || follows());
    const core::RelativeLeg way = leg_against(*setup_, fixture, body, leg);
    return {body, pair, way, allowance, off, may_touch};
}

Result<void> CoprocessorCheck::update_models(At& at) {
    if (at.to_cut.empty()) return {};
    const size_t logged = at.stock.log.size();
    for (const core::CutterSweep& sweep : at.to_cut) cut(at.stock, sweep);
    at.corners.has_cut = at.corners.has_cut || at.stock.log.size() > logged;
    at.to_cut.clear();
    if (auto updated = hwsim::update_stock(driver_, stock_, at.stock); !updated)
        return tl::unexpected(std::move(updated).error());
    return {};
}

void CoprocessorCheck::note_cut(const core::Leg& leg, At& at) const {
    if (!at.tool || at.tool->parts.empty()) return;
    const core::MovingBody flutes = moving_bodies(*setup_, *at.tool)[0];
    const core::RelativeLeg way =
        relative_leg(setup_->machine, setup_->stock_mount, flutes.mover, leg);
    if (!std::isfinite(way.error))
        return; // omits the cut: the stock is then too large, which is safe
    at.to_cut.push_back({.cutter = std::make_shared<const core::Cutter>(
                             make_cutter(at.tool->parts[0].profile, way.error)),
                         .from = way.positions.front(),
                         .to = way.positions.back(),
                         .orientation = way.orientation});
}

Result<void> CoprocessorCheck::query_pair(const Question& q, SlotNumber work, PushedBlock& block) {
    if (auto measured = measure_pair(q, work, block); !measured) return measured;
    // For bodies that may touch, the tool-side body is shrunk by the contact tolerance.
    const double shrink =
        q.may_touch && q.body.profile ? contact_shrink(q.allowance, *q.body.profile) : 0.0;
    FEELER_TRY(const SlotNumber tool, models_.of_body(driver_, q.body, shrink, q.way.orientation));
    const double off = q.way.error + (q.may_touch ? 0.0 : q.off_path);
    if (const auto pushed =
            hwsim::push(driver_, segment_of(q.way, tool, work, q.allowance.distance + off));
        !pushed) {
        deny(block.permit, pushed.error().message);
        return {};
    }
    block.asked.push_back(q.pair);
    ++block.permit.segments;
    if (asking_ == QueryScope::everything) collect_answers(block);
    return {};
}

Result<void> CoprocessorCheck::measure_pair(const Question& q, SlotNumber work,
                                            PushedBlock& block) {
    if (asking_ != QueryScope::everything) return {};
    QueriedPair& asked = entry_of(block.permit, q.pair, *setup_);
    FEELER_TRY(const SlotNumber tool, models_.of_body(driver_, q.body, 0.0, q.way.orientation));
    const double off = q.way.error + q.off_path;
    const double limit = setup_->search_limit + off;
    const auto found = hwsim::measure(driver_, segment_of(q.way, tool, work, limit));
    if (!found) deny(block.permit, found.error().message);
    if (!found || collect_answers(block) != hwsim::Stop::none) {
        asked.lower = 0.0;
        return {};
    }
    const double apart = *found ? hwsim::least_clearance(**found) : limit;
    asked.lower = std::min(asked.lower, std::max(0.0, apart - off));
    asked.may_overlap = asked.may_overlap || (*found && (*found)->squared == 0);
    return {};
}

bool CoprocessorCheck::is_in_own_cut(const Question& q, const At& at) const {
    if (q.body.kind != core::PartKind::flutes || q.way.turns || !q.may_touch) return false;
    return runs_in_own_cut(at.stock, {.flutes = *q.body.profile,
                                      .from = q.way.positions.front(),
                                      .to = q.way.positions.back(),
                                      .sideways = 0.5 * contact_depth(q.allowance) - q.way.error,
                                      .orientation = q.way.orientation});
}

} // namespace app
