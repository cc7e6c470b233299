#include "app/tolerance/enclosure.h"

#include <algorithm>
#include <set>
#include <utility>

#include "app/check/prepared_check.h"
#include "core/motion/kinematics.h"
#include "core/motion/path.h"
#include "core/sim/leg/leg_check.h"
#include "core/sim/run/simulator.h"
#include "gcode/language/environment.h"

namespace app {
namespace {

constexpr double same = 1e-6; // mm per mm

core::AxisValues plain(const core::AxisPosition& position) {
    core::AxisValues values{};
    for (size_t axis = 0; axis < core::axis_count; ++axis)
        values[axis] = position[axis].value_or(0.0);
    return values;
}

bool is_known(const core::AxisPosition& position, const core::Machine& machine) {
    for (size_t axis = 0; axis < core::axis_count; ++axis)
        if (machine.axes[axis].present && !position[axis]) return false;
    return true;
}

core::Play play_along(const core::Vec3& way, const DeviationRange& range) {
    return {range.least * way, range.most * way};
}

core::Vec3 unit(int axis) {
    core::Vec3 v(0.0);
    v[axis] = 1.0;
    return v;
}

core::Play sum(const core::Play& a, const core::Play& b) {
    if (a.none()) return b;
    return {a.from + b.from, a.to + b.to};
}

/// The cuts of earlier programs, of which only what is `by` inside them is certain to be gone.
std::shared_ptr<const std::vector<core::CutterSweep>>
less_certain(const std::vector<core::CutterSweep>& sweeps, double by) {
    std::map<const core::Cutter*, std::shared_ptr<const core::Cutter>> cutters;
    auto less = std::make_shared<std::vector<core::CutterSweep>>(sweeps);
    for (core::CutterSweep& sweep : *less) {
        auto& cutter = cutters[sweep.cutter.get()];
        if (!cutter)
            cutter = std::make_shared<const core::Cutter>(
                core::make_cutter(sweep.cutter->flutes, sweep.cutter->path_error + by));
        sweep.cutter = cutter;
    }
    return less;
}

/// How far a control may leave the path at a corner with this limit, mm. Next to an arc, that is as
/// far as the rounding reaches.
double deviation_at(const core::CornerLimit& limit, const std::vector<core::Leg>& legs) {
    const bool is_along = limit.rounds() && limit.distance < core::infinity;
    return is_along ? std::max(limit.deviation, limit.distance) : core::deviation_of(limit, legs);
}

/// How far a motion may leave its path at its two corners, mm; that of feeds with each other is not
/// included.
double corner_deviation(const core::RoundedCorners& corners, const core::Motion& motion,
                        const std::vector<core::Leg>& legs) {
    const double mixed =
        std::max(deviation_at(corners.mixed, legs), deviation_at(corners.last.mixed, legs));
    if (motion.kind != core::MotionKind::rapid) return mixed;
    return std::max({mixed, core::deviation_of(corners.rapids, legs),
                     core::deviation_of(corners.last.rapids, legs)});
}

/// The part of a path in which a control may round the corner at its end, or at its start: at most
/// half, unless a distance is stated, or at the start after a blend.
std::vector<core::Leg> near_corner(const std::vector<core::Leg>& legs,
                                   const core::CornerLimit& limit, bool at_end) {
    const bool is_line = legs.size() == 1 && legs[0].straight && legs[0].positions.size() == 2;
    if (!is_line || limit.distance < core::infinity || (limit.blends() && !at_end)) return legs;
    return {at_end ? core::stretch(legs[0], 0.5, 1.0) : core::stretch(legs[0], 0.0, 0.5)};
}

const char* const turning_head =
    "the tool turns with the machine's head, so the bodies of the machine move apart differently";

} // namespace

struct Enclosure::Run {
    uint16_t frame = 0;
    const DeviationRange& range;
    core::Setup exact;
    core::SimulatorState state;
    std::map<double, core::Setup> doubtful = {}; // by the doubt
    bool was_exact = false;
    bool last_is_exact = false; // the motion before, at which a corner begins
    bool last_moves_others = false;
};

Enclosure::Enclosure(const PreparedCheck& check, const core::Setup& base,
                     const RecordedMotions& motions, const Shifts& shifts,
                     const Deviation& deviation, std::function<bool(size_t)> may_go_on)
    : check_(check),
      base_(base),
      motions_(motions),
      shifts_(shifts),
      deviation_(deviation),
      may_go_on_(std::move(may_go_on)) {
    find_frames();
}

Enclosure::Displacement Enclosure::displacement(const core::AxisValues& values,
                                                const core::AxisValues& by) const {
    const core::Machine& machine = base_.machine;
    core::AxisValues moved = values;
    for (size_t axis = 0; axis < core::axis_count; ++axis) moved[axis] += by[axis];
    const auto pose = [&](core::LinkId link, const core::AxisValues& at) {
        return core::machine_from_link(machine, link, at);
    };
    const auto spindle_in = [&](core::LinkId link) {
        return (pose(link, moved).inverse() * pose(machine.spindle, moved)).translation
               - (pose(link, values).inverse() * pose(machine.spindle, values)).translation;
    };
    Displacement found{.axes = by};
    found.targets.push_back(spindle_in(base_.stock_mount.link));
    for (const core::Fixture& fixture : base_.fixtures)
        found.targets.push_back(spindle_in(fixture.mount.link));
    for (const core::MachineBody& body : machine.bodies)
        found.bodies.push_back(-spindle_in(body.link));
    for (size_t axis = 0; axis < core::axis_count; ++axis)
        if (!core::is_rotary(axis)) found.reach += std::abs(by[axis]);
    return found;
}

uint16_t Enclosure::frame_of(const core::AxisPosition& position, uint16_t kind) {
    if (kind == 0) return 0;
    const Displacement here = displacement(plain(position), shifts_.kinds[kind]);
    const auto equal = [](const std::vector<core::Vec3>& a, const std::vector<core::Vec3>& b) {
        for (size_t i = 0; i < a.size(); ++i)
            if (glm::length(a[i] - b[i]) > same) return false;
        return true;
    };
    for (size_t i = 0; i < frames_.size(); ++i) {
        const Displacement& known = frames_[i];
        if (equal(known.targets, here.targets) && equal(known.bodies, here.bodies)
            && known.axes == here.axes)
            return static_cast<uint16_t>(i);
    }
    frames_.push_back(here);
    return static_cast<uint16_t>(frames_.size() - 1);
}

void Enclosure::find_frames() {
    const core::Machine& machine = base_.machine;
    frames_.push_back(displacement({}, {}));
    const bool heads_turn = core::is_turned_by_axes(machine, machine.spindle);
    if (heads_turn && !machine.bodies.empty() && !shifts_.none()) obstacle_ = turning_head;
    core::AxisPosition here = check_.file.environment.start;
    constexpr size_t most_frames = 12;
    for (size_t i = 0; i < motions_.events.size() && obstacle_.empty(); ++i) {
        const Shifts::Ends kinds = shifts_.of[i];
        const auto* motion = std::get_if<core::Motion>(&motions_.events[i]);
        bool turns = false;
        if (motion) {
            for (size_t axis = 3; axis < 6; ++axis)
                turns = turns || motion->from[axis] != motion->to[axis];
            frame_of_.push_back(
                {frame_of(motion->from, kinds.from), frame_of(motion->to, kinds.to)});
            here = motion->to;
        } else {
            const uint16_t frame = frame_of(here, kinds.from);
            frame_of_.push_back({frame, frame});
        }
        turns_.push_back(turns);
        if (frames_.size() > most_frames)
            obstacle_ = "the deviation displaces the motions in too many different ways";
    }
    if (!obstacle_.empty()) return;
    // Frames in which a tool cuts; a spindle that turns and feeds is enough here.
    std::vector<size_t> feeds(frames_.size()), all(frames_.size());
    for (size_t i = 0; i < motions_.events.size(); ++i) {
        const auto* motion = std::get_if<core::Motion>(&motions_.events[i]);
        if (!motion || frame_of_[i].from != frame_of_[i].to) continue;
        ++all[frame_of_[i].to];
        if (motion->kind != core::MotionKind::rapid) ++feeds[frame_of_[i].to];
    }
    for (size_t frame = 0; frame < frames_.size(); ++frame)
        if (feeds[frame] > 0) simulated_.push_back(static_cast<uint16_t>(frame));
    if (simulated_.empty())
        simulated_.push_back(
            static_cast<uint16_t>(std::max_element(all.begin(), all.end()) - all.begin()));
}

bool Enclosure::is_exact(size_t event, uint16_t frame) const {
    const Shifts::Ends ends = frame_of_[event];
    if (ends.from != frame || ends.to != frame) return false;
    return !turns_[event] || frames_[frame].reach == 0.0;
}

bool Enclosure::is_judged_in(size_t event, uint16_t frame, bool first) const {
    const Shifts::Ends ends = frame_of_[event];
    const auto is_one = [&](uint16_t f) {
        return std::find(simulated_.begin(), simulated_.end(), f) != simulated_.end();
    };
    if (is_one(ends.to)) return ends.to == frame;
    if (is_one(ends.from)) return ends.from == frame;
    return first;
}

core::Setup Enclosure::in_frame(uint16_t frame, const DeviationRange& range) const {
    core::Setup setup = base_;
    const Displacement& by = frames_[frame];
    const auto in_stock = [&](const core::Vec3& way) {
        return glm::transpose(setup.stock_mount.link_from_body.rotation) * way;
    };
    if (by.reach > 0.0) {
        setup.stock.play = play_along(in_stock(-by.targets[0]), range);
        for (size_t i = 0; i < setup.fixtures.size(); ++i)
            setup.fixtures[i].play = play_along(-by.targets[i + 1], range);
        for (const core::Vec3& way : by.bodies) setup.body_play.push_back(play_along(way, range));
    }
    switch (deviation_.quantity) {
    case Quantity::stock:
        setup.stock.play = play_along(in_stock(unit(deviation_.axis)), range);
        break;
    case Quantity::fixture:
        for (core::Fixture& fixture : setup.fixtures)
            if (fixture.name == deviation_.fixture && !fixture.is_machine)
                fixture.play = play_along(unit(deviation_.axis), range);
        break;
    case Quantity::stick_out: {
        const core::Play play = play_along(unit(2), range);
        setup.tools.at(deviation_.tool).holder_play = play;
        // The frames are those of the tip. Bodies that do not follow Z move against it as `by`
        // says, all others also with the holder.
        core::AxisValues up{};
        up[2] = 1.0;
        const std::vector<core::Vec3> against_z = displacement({}, up).bodies;
        for (size_t i = 0; i < setup.body_play.size(); ++i)
            if (glm::length(against_z[i]) < same)
                setup.body_play[i] = sum(setup.body_play[i], play);
        break;
    }
    case Quantity::tool_diameter: {
        core::ToolAssembly& tool = setup.tools.at(deviation_.tool);
        const auto least = with_diameter(tool, range.least), most = with_diameter(tool, range.most);
        if (!least || !most) break; // first_limit refuses this range
        tool.parts[0] = most->parts[0];
        tool.certain_flutes = least->parts[0].profile;
        break;
    }
    default:
        break;
    }
    if (!setup.stock.play.none() && setup.earlier_cuts)
        setup.earlier_cuts =
            less_certain(*setup.earlier_cuts, std::max(glm::length(setup.stock.play.from),
                                                       glm::length(setup.stock.play.to)));
    return setup;
}

core::Setup Enclosure::with_doubt(const core::Setup& setup, double doubt) const {
    core::Setup doubtful = setup;
    doubtful.cut_error = doubt;
    // Every minimum clearance is larger by the doubt, also those of pairs that may touch.
    doubtful.allowances.clear();
    core::Setup unruled;
    unruled.allowance = setup.allowance;
    const auto add = [&](core::PartKind part, const char* body, std::optional<size_t> fixture) {
        const core::Allowance usual = core::allowance_of(unruled, {part, fixture});
        doubtful.allowances.push_back({{core::name_of(part), body}, usual.distance + doubt, 0.0});
    };
    for (const core::PartKind part :
         {core::PartKind::flutes, core::PartKind::shank, core::PartKind::holder,
          core::PartKind::nose, core::PartKind::machine}) {
        add(part, "stock", std::nullopt);
        add(part, "fixture", 0);
        add(part, "machine", 0);
    }
    for (core::AllowanceRule rule : setup.allowances) {
        rule.distance += doubt;
        rule.contact = 0.0;
        doubtful.allowances.push_back(rule);
    }
    doubtful.search_limit = core::search_limit_of(doubtful);
    return doubtful;
}

double Enclosure::doubt_of(size_t event, uint16_t frame, const DeviationRange& range) const {
    const Displacement& own = frames_[frame];
    double doubt = 0.0;
    for (const uint16_t end : {frame_of_[event].from, frame_of_[event].to}) {
        const Displacement& other = frames_[end];
        for (size_t i = 0; i < own.targets.size(); ++i)
            doubt = std::max(doubt, glm::length(other.targets[i] - own.targets[i]));
        for (size_t i = 0; i < own.bodies.size(); ++i)
            for (size_t j = 0; j < own.targets.size(); ++j)
                doubt = std::max(doubt, glm::length(other.bodies[i] - own.bodies[i])
                                            + glm::length(other.targets[j] - own.targets[j]));
        if (turns_[event]) doubt = std::max(doubt, 2.0 * own.reach + 2.0 * other.reach);
    }
    return doubt * range.reach() + 1e-6;
}

namespace {

/// The positions that a motion may pass in a frame: the hull of the displaced ends. Empty if that
/// has too many corners.
std::optional<core::Leg> hull_of(const core::Motion& motion, const core::Machine& machine,
                                 const std::vector<core::AxisValues>& from,
                                 const std::vector<core::AxisValues>& to) {
    core::Leg leg{.straight = false};
    leg.positions = from;
    leg.positions.insert(leg.positions.end(), to.begin(), to.end());
    const bool dog_leg = core::is_dogleg(motion, machine);
    std::vector<size_t> moving;
    core::AxisValues least = from[0], most = from[0];
    for (const core::AxisValues& at : leg.positions)
        for (size_t axis = 0; axis < core::axis_count; ++axis) {
            least[axis] = std::min(least[axis], at[axis]);
            most[axis] = std::max(most[axis], at[axis]);
        }
    for (size_t axis = 0; axis < core::axis_count; ++axis)
        if (most[axis] > least[axis]) moving.push_back(axis);
    if (moving.size() <= 1) {
        // All positions are on one line along an axis: a straight leg passes all of them. It begins
        // where the motion begins.
        const bool falls = !moving.empty() && to[0][moving[0]] < from[0][moving[0]];
        leg.positions = falls ? std::vector{most, least} : std::vector{least, most};
        leg.straight = true;
        return leg;
    }
    if (!dog_leg) return leg;
    if (moving.size() > 3) return std::nullopt;
    leg.positions.clear();
    for (size_t corner = 0; corner < (size_t{1} << moving.size()); ++corner) {
        core::AxisValues at = least;
        for (size_t i = 0; i < moving.size(); ++i)
            if (corner >> i & 1) at[moving[i]] = most[moving[i]];
        leg.positions.push_back(at);
    }
    return leg;
}

LimitingPair limit_of(const core::Setup& setup, size_t event,
                      const std::optional<core::ToolNumber>& tool,
                      const std::vector<core::PairClearance>& pairs) {
    LimitingPair limit{.event = event, .tool = tool};
    const core::PairClearance* worst = nullptr;
    for (const core::PairClearance& pair : pairs)
        if (pair.verdict != core::Verdict::clear && (!worst || pair.verdict > worst->verdict))
            worst = &pair;
    if (!worst) return limit;
    limit.pair = {core::part_name(setup, worst->pair), core::body_name(setup, worst->pair)};
    if (worst->lower > 0.0) limit.missing = worst->allowance.distance - worst->lower;
    return limit;
}

} // namespace

bool Enclosure::is_cutting(const core::Motion& motion, const Run& run) const {
    if (motion.kind == core::MotionKind::rapid || !run.state.tool) return false;
    const auto tool = run.exact.tools.find(*run.state.tool);
    return tool != run.exact.tools.end() && core::turns_to_cut(run.state.spindle, tool->second)
           && core::cuts_along(tool->second, motion);
}

/// Whether the displacements of both ends against a frame are those of its axes there: a frame of
/// another angle of the rotary axes is displaced in another direction.
bool Enclosure::has_hull(size_t event, const core::Motion& motion, uint16_t frame) const {
    const core::Machine& machine = base_.machine;
    if (turns_[event] || motion.arc || motion.tip || !is_known(motion.from, machine)
        || !is_known(motion.to, machine))
        return false;
    const auto is_by_axes = [&](const core::AxisPosition& position, uint16_t end) {
        core::AxisValues by = frames_[end].axes;
        for (size_t axis = 0; axis < core::axis_count; ++axis)
            by[axis] -= frames_[frame].axes[axis];
        const Displacement there = displacement(plain(position), by);
        for (size_t i = 0; i < there.targets.size(); ++i) {
            const core::Vec3 real = frames_[end].targets[i] - frames_[frame].targets[i];
            if (glm::length(there.targets[i] - real) > same) return false;
        }
        return true;
    };
    return is_by_axes(motion.from, frame_of_[event].from)
           && is_by_axes(motion.to, frame_of_[event].to);
}

std::optional<LimitingPair> Enclosure::judge_hull(Run& run, size_t event,
                                                  const core::Motion& motion) const {
    const auto displaced = [&](const core::AxisPosition& position, uint16_t frame) {
        std::vector<core::AxisValues> ends;
        for (const double by : {run.range.least, run.range.most}) {
            core::AxisValues at = plain(position);
            for (size_t axis = 0; axis < core::axis_count; ++axis)
                at[axis] += by * (frames_[frame].axes[axis] - frames_[run.frame].axes[axis]);
            if (ends.empty() || ends[0] != at) ends.push_back(at);
        }
        return ends;
    };
    const Shifts::Ends ends = frame_of_[event];
    const auto leg = hull_of(motion, run.exact.machine, displaced(motion.from, ends.from),
                             displaced(motion.to, ends.to));
    const LimitingPair unknown{.event = event, .tool = run.state.tool, .pair = {}, .missing = {}};
    if (!leg) return unknown;
    core::RoundedCorners& corners = run.state.corners;
    const bool is_feed = motion.kind != core::MotionKind::rapid;
    const double off_path =
        std::max(is_feed ? corners.of_feed(false) : 0.0, corner_deviation(corners, motion, {*leg}));
    corners.end(motion.kind, false); // the whole motion counts as rounded
    return judge_legs(run, event, {*leg}, off_path, false);
}

std::optional<LimitingPair> Enclosure::judge_legs(Run& run, size_t event,
                                                  const std::vector<core::Leg>& legs,
                                                  double off_path, bool cuts) const {
    static const core::ToolAssembly nothing;
    const auto tool =
        run.state.tool ? run.exact.tools.find(*run.state.tool) : run.exact.tools.end();
    if (tool == run.exact.tools.end() && run.exact.machine.bodies.empty()) return std::nullopt;
    core::CheckMemory memory;
    const core::BlockDeviation of{
        off_path, off_path,
        core::axis_tolerance_error(
            run.exact, tool == run.exact.tools.end() ? nullptr : &tool->second, {.legs = legs})};
    memory.off_path = off_path + of.by_axes + run.state.corners.of_stock();
    core::TrackedPairs pairs;
    core::LegCheck check(run.exact, tool == run.exact.tools.end() ? nothing : tool->second,
                         core::FluteUse::not_cutting,
                         motions_.blocks[motions_.block_of[event]].block,
                         run.state.mounted_fixtures, memory, run.state.statistics);
    core::CutModel stock = run.state.stock; // flutes that run into it would cut it
    for (const core::Leg& leg : legs) check.run(leg, 0.0, stock, pairs);
    check.finish(pairs);
    std::vector<core::PairClearance> judged;
    for (core::TrackedPair& pair : pairs) {
        if (cuts && pair.pair == core::Pair{core::PartKind::flutes}) continue;
        if (core::widen(pair, of, run.state.corners) != core::ContactDoubt::none)
            pair.verdict = std::max(pair.verdict, core::Verdict::undecided);
        judged.push_back(pair);
    }
    for (const core::PairClearance& pair : judged)
        if (pair.verdict != core::Verdict::clear)
            return limit_of(run.exact, event, run.state.tool, judged);
    return std::nullopt;
}

std::optional<LimitingPair> Enclosure::judge_corner(Run& run, size_t event,
                                                    const core::Motion& motion) const {
    const bool exact = is_exact(event, run.frame);
    if (exact && motion.from == motion.to && !motion.arc) return std::nullopt; // it does not move
    const bool last_is_exact = std::exchange(run.last_is_exact, exact);
    const bool others =
                   !std::equal(motion.from.begin() + 3, motion.from.end(), motion.to.begin() + 3),
               last_others = std::exchange(run.last_moves_others, others);
    const core::RoundedCorners& corners = run.state.corners;
    const core::CornerStart last = corners.last;
    if (!last.kind) return std::nullopt;
    const bool rapid = motion.kind == core::MotionKind::rapid,
               was_rapid = *last.kind == core::MotionKind::rapid;
    const bool is_one_kind = exact == last_is_exact;
    if (rapid == was_rapid) {
        // The whole feed counts as rounded, but next to arcs and where other axes than X, Y and Z
        // move the simulator needs the path of the motion before, and so it does after them.
        const bool at_others = others || last_others;
        const bool is_rounded_more =
            rapid ? last.rapids.blends() && at_others
                  : (last.arcs.rounds() && (motion.arc || last.is_arc || at_others))
                        || (last.turns.rounds() && at_others);
        const bool is_simulated = is_one_kind && (exact || !has_hull(event, motion, run.frame));
        if ((is_rounded_more && !(is_simulated && !last.legs.empty()))
            || (!rapid && corners.left_after > 0.0 && !is_simulated))
            return LimitingPair{.event = event, .tool = run.state.tool, .pair = {}, .missing = {}};
    }
    if (is_one_kind) return std::nullopt;
    // The path of the motion before is not known here: the simulator is not to use it.
    if (exact) run.state.corners.last = {};
    if (!rapid && !was_rapid) return std::nullopt;
    const core::CornerLimit& limit = rapid && was_rapid ? last.rapids : last.mixed;
    if (!limit.rounds()) return std::nullopt;
    const std::vector<core::Leg> legs =
        exact
            ? core::path_of(motion, run.exact.machine, core::chord_error(run.exact.mesh_size)).legs
            : last.legs;
    // From an unknown start, the whole region is checked.
    if (legs.empty() || !legs.front().start_known) return std::nullopt;
    // At the corner between a rapid and a cut, the flutes may already, or still, cut.
    return judge_legs(run, event, near_corner(legs, limit, !exact), deviation_at(limit, legs),
                      rapid != was_rapid);
}

std::optional<LimitingPair> Enclosure::judge(Run& run, size_t event) const {
    const RecordedBlock& block = motions_.blocks[motions_.block_of[event]];
    const core::Event& what = motions_.events[event];
    const bool exact = is_exact(event, run.frame);
    const bool judged = is_judged_in(event, run.frame, run.frame == simulated_.front());
    const auto* motion = std::get_if<core::Motion>(&what);
    const LimitingPair unknown{.event = event, .tool = run.state.tool, .pair = {}, .missing = {}};
    if (motion && block.path != core::PathCertainty::known) return unknown;
    if (motion)
        if (auto limit = judge_corner(run, event, *motion)) return limit;
    if (!exact || !run.was_exact) {
        // Bounds of another kind of simulation do not hold here.
        run.state.memory.bounds.clear();
        run.state.memory.deciding.reset();
        run.state.centre = {};
    }
    run.was_exact = exact;
    run.state.rules.length_in_doubt = true; // no advice about lengths
    run.state.rules.has_fed = false;        // nor about retracts
    if (!exact && motion && judged && !is_cutting(*motion, run)
        && has_hull(event, *motion, run.frame)) {
        const auto limit = judge_hull(run, event, *motion);
        run.state.position = motion->to;
        return limit;
    }
    const core::Setup* setup = &run.exact;
    if (!exact && judged && motion && is_cutting(*motion, run)) {
        // Whether these cut depends on the direction of the motion.
        const core::ToolDescription& tool = run.exact.tools.at(*run.state.tool).description;
        if (!tool.cuts_at_centre || core::only_drills(tool.shape)) return unknown;
    }
    if (!exact) {
        double doubt = doubt_of(event, run.frame, run.range);
        if (motion)
            doubt += corner_deviation(
                run.state.corners, *motion,
                core::path_of(*motion, run.exact.machine, core::chord_error(run.exact.mesh_size))
                    .legs);
        const auto known = run.doubtful.find(doubt);
        setup = known != run.doubtful.end()
                    ? &known->second
                    : &run.doubtful.emplace(doubt, with_doubt(run.exact, doubt)).first->second;
    }
    const core::Judgement none;
    const core::BlockEvents one{.block = block.block,
                                .events = std::span(&what, 1),
                                .goes_home = block.goes_home,
                                .path = block.path,
                                .judgement = exact || judged ? nullptr : &none,
                                .is_trial = true}; // depths and cures would only take time
    const core::BlockResult result = core::run_block(*setup, one, run.state);
    // With a certain stock, it is not known what is left.
    const bool is_clear = one.judgement || result.verdict == core::Verdict::clear;
    if (is_clear && !run.state.certain_stock) return std::nullopt;
    LimitingPair limit = limit_of(*setup, event, run.state.tool, result.pairs);
    if (!exact) limit.missing.reset();
    return limit;
}

namespace {

/// The work of a simulation after some events; see most_tolerance_work.
size_t work_of(const core::Statistics& done, size_t events) {
    constexpr size_t per_square = 20, per_cut = 100, per_event = 100;
    return done.box_tests + done.shape_tests + per_square * done.refined + per_cut * done.sweeps
           + per_event * events;
}

} // namespace

std::optional<LimitingPair> Enclosure::simulate(uint16_t frame, const DeviationRange& range) const {
    if (!may_go_on_(0)) return LimitingPair{};
    core::Setup exact = in_frame(frame, range);
    exact.detail = core::Detail::verdict;
    exact.needs_only_verdict = true;
    for (const char* rule : {"loose-piece", "air-cut", "low-retract", "singular-orientation"})
        exact.rules[rule] = core::Severity::off;
    auto state = core::start_of_run(exact, check_.file.environment.start);
    if (!state) return LimitingPair{};
    Run run{.frame = frame, .range = range, .exact = std::move(exact), .state = *std::move(state)};
    run.state.spindle.direction = run.exact.spindle_at_start;
    if (run.state.spindle.direction != core::SpindleDirection::stopped)
        run.state.spindle.speed = 1.0;
    return judge_all(run);
}

std::optional<LimitingPair> Enclosure::judge_all(Run& run) const {
    constexpr size_t poll_interval = 16; // events
    size_t reported = 0;
    const auto goes_on = [&](size_t events) {
        const size_t work = work_of(run.state.statistics, events);
        return may_go_on_(work - std::exchange(reported, work));
    };
    for (size_t event = 0; event < motions_.events.size(); ++event) {
        if (event % poll_interval == 0 && !goes_on(event)) return LimitingPair{};
        if (auto limit = judge(run, event)) return goes_on(event + 1) ? limit : LimitingPair{};
    }
    if (!goes_on(motions_.events.size())) return LimitingPair{};
    return std::nullopt;
}

std::optional<LimitingPair> Enclosure::first_limit(const DeviationRange& range) const {
    if (deviation_.quantity == Quantity::tool_diameter) {
        const core::ToolAssembly& tool = base_.tools.at(deviation_.tool);
        if (!with_diameter(tool, range.least) || !with_diameter(tool, range.most))
            return LimitingPair{};
    }
    std::optional<LimitingPair> earliest;
    for (const uint16_t frame : simulated_) {
        const auto limit = simulate(frame, range);
        if (limit && (!earliest || limit->event < earliest->event)) earliest = limit;
    }
    return earliest;
}

} // namespace app
