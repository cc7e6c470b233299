#include "core/sim/simulator.h"

#include <numbers>
#include <thread>

#include <fmt/format.h>

#include "core/sim/finding_text.h"
#include "core/sim/leg_check.h"
#include "core/sim/low_retract.h"
#include "core/sim/pair_entry.h"
#include "core/sim/singular.h"

namespace core {
namespace {

/// One leg of the block, with when its motion began.
struct TimedLeg {
    Leg leg;
    double start; // seconds after the block's start
};

/// A block while it is carried out.
struct BlockRun {
    const Setup& setup;
    const BlockEvents& block;
    SimulatorState& state;
    BlockResult result = {};
    std::vector<TimedLeg> legs = {};
    bool turns = false;         // rotary axes move
    bool pushes_centre = false; // down into the stock, where the tool does not cut
    bool only_dog_leg = false;  // straight, a rapid of this block would be free

    const ToolAssembly* tool() const {
        if (!state.tool) return nullptr;
        const auto found = setup.tools.find(*state.tool);
        return found == setup.tools.end() ? nullptr : &found->second;
    }

    void find(const std::string& rule, std::string message, std::string cure) {
        const Severity severity = severity_of(setup, rule);
        if (severity == Severity::off) return;
        result.findings.push_back(
            {rule, severity, block.block, std::move(message), std::move(cure), {}, 0.0});
    }

    void add(Finding finding) {
        finding.block = block.block;
        if (finding.severity != Severity::off) result.findings.push_back(std::move(finding));
    }

    /// Adds a finding of a rule that knows its block, with its severity in this set-up.
    void tell(std::optional<Finding> finding) {
        if (!finding) return;
        settle_severity(setup, *finding);
        if (!finding->block) finding->block = block.block;
        if (finding->severity != Severity::off) result.findings.push_back(*std::move(finding));
    }

    /// What checks the legs of a motion, with whatever is in the spindle.
    LegCheck leg_check(FluteUse use, CheckMemory& memory) {
        static const ToolAssembly nothing;
        return {setup,           tool() ? *tool() : nothing, use,
                block.block,     state.fixtures_there,       memory,
                state.statistics};
    }
    LegCheck leg_check(FluteUse use) { return leg_check(use, state.memory); }

    FluteUse use(const Motion& motion) const {
        const bool feeds = motion.kind != MotionKind::rapid;
        const bool cuts = tool() && turns_to_cut(state.spindle, *tool());
        return feeds && cuts ? FluteUse::cutting : FluteUse::not_cutting;
    }

    void carry_out(const Motion& motion);
    void carry_out(const ToolChange& change);
    void carry_out(const SpindleChange& change) { state.spindle = change; }
    void carry_out(const Dwell& dwell) { result.duration += dwell.seconds; }
    void carry_out(const LengthOffsetChange& change) { state.length_offset = change; }
    void carry_out(const PathModeChange&) {} // moves nothing; BlockClock needs it
    void carry_out(const FixtureChange& change);

    void check_path(const Motion& motion, const Path& path);
    void look_at_rapid(const Motion& motion, const Path& path, const CutModel& before);
    void look_at_feed(const Motion& motion, const Path& path, double removed);
    void move_without_tool(const Motion& motion);
    void watch_centre(const Motion& motion, const Leg& leg);
    Finding finding_about(const PairClearance& pair) const;
    void check_tool_change();
    void forget_bounds();
    void check_limits(const Motion& motion);
    void check_from_unknown(const Motion& motion, const Path& path);
    void conclude();
};

BlockMotion label(const Motion& motion) {
    switch (motion.kind) {
    case MotionKind::rapid:
        return BlockMotion::rapid;
    case MotionKind::feed:
        return BlockMotion::feed;
    default:
        return BlockMotion::arc;
    }
}

void BlockRun::check_limits(const Motion& motion) {
    for (size_t i = 0; i < axis_count; ++i)
        if (setup.machine.axes[i].present && (!motion.from[i] || !motion.to[i])) return;
    const AxisRange range = axis_range(motion, setup.machine, chord_error(setup.mesh_size));
    for (size_t i = 0; i < axis_count; ++i) {
        const MachineAxis& axis = setup.machine.axes[i];
        if (!axis.present) continue;
        const double below = axis.min.value_or(-infinity) - range.min[i];
        const double above = range.max[i] - axis.max.value_or(infinity);
        const double beyond = std::max(below, above);
        if (beyond <= resolution) continue;
        find("over-travel",
             fmt::format("{} goes to {:.3f} in machine coordinates, {:.3f} {} beyond its limit.",
                         axis_letters[i], below > above ? range.min[i] : range.max[i], beyond,
                         is_rotary(i) ? "degrees" : "mm"),
             "Move the work, or use another tool length or work offset.");
    }
}

void BlockRun::check_from_unknown(const Motion& motion, const Path& path) {
    // Nobody knows where the machine comes from: what is not clear from everywhere is told, once.
    std::vector<PairClearance> pairs;
    for (const Leg& leg : path.legs)
        leg_check(use(motion)).run(leg, result.duration, state.stock, pairs);
    const PairClearance* worst = deciding_pair(pairs);
    if (!path.legs.empty() && (!worst || worst->verdict == Verdict::clear)) {
        for (PairClearance& pair : pairs) result.pairs.push_back(pair);
        return;
    }
    result.checked = false;
    if (std::exchange(state.told_unknown_start, true)) return;
    find("first-move",
         "The machine starts from a place nobody knows, so this motion cannot be judged.",
         "Say where the axes stand at the first block: `start` under [program] in the set-up, or "
         "the machine's home.");
}

void BlockRun::carry_out(const Motion& motion) {
    result.motion = result.motion == BlockMotion::none ? label(motion) : BlockMotion::cycle;
    const Path path = path_of(motion, setup.machine, chord_error(setup.mesh_size));
    if (path.assumed_speed)
        state.assumptions.insert("rapids run at 10,000 mm/min on axes whose "
                                 "speed is not stated");
    for (size_t i = 3; i < 6; ++i) turns = turns || motion.from[i] != motion.to[i];
    check_limits(motion);
    if (motion.from != state.position) forget_bounds();
    state.position = motion.to;
    if (!tool()) move_without_tool(motion);
    if (!tool() && setup.machine.bodies.empty()) {
        // Nothing moves that could meet anything.
    } else if (path.legs.empty() || !path.legs[0].start_known) {
        check_from_unknown(motion, path);
    } else {
        check_path(motion, path);
    }
    result.duration += path.duration;
}

void BlockRun::watch_centre(const Motion& motion, const Leg& leg) {
    if (!tool() || tool()->description.cuts_at_centre) return;
    if (use(motion) != FluteUse::cutting || !leg.straight) {
        state.centre = {};
        return;
    }
    const Mount tip{setup.machine.spindle, translation({0.0, 0.0, -tool()->length})};
    const RelativeLeg way = relative_leg(setup.machine, setup.stock_mount, {.mount = tip}, leg);
    const auto contact = follow(state.centre, tool()->description, way, state.stock);
    if (!contact) return;
    PairClearance& flutes = entry(result.pairs, {PartKind::flutes}, setup);
    if (flutes.verdict == Verdict::collision) return;
    pushes_centre = true;
    flutes.lower = flutes.upper = 0.0;
    flutes.verdict = Verdict::collision;
    flutes.on_tool = flutes.on_body = contact->place;
    flutes.time = result.duration + leg.begin + contact->share * (leg.end - leg.begin);
}

Finding BlockRun::finding_about(const PairClearance& pair) const {
    Finding finding =
        finding_of(setup, pair, {result.motion, turns, result.duration, only_dog_leg}, state);
    if (!pushes_centre || pair.pair != Pair{PartKind::flutes}) return finding;
    const ToolDescription& described = tool()->description;
    finding.message = fmt::format(
        "Tool {} does not cut within {:g} mm of its axis, and its centre is pushed into the stock.",
        value_of(described.number), described.centre_radius);
    finding.cure = fmt::format(
        "Ramp or wind in by at most {:.1f} degrees, in circles of more than {:g} mm radius; drill "
        "first; or use a tool that cuts at its centre.",
        std::atan(centre_recess(described) / (2.0 * described.centre_radius)) * 180.0
            / std::numbers::pi,
        described.centre_radius);
    return finding;
}

void BlockRun::check_path(const Motion& motion, const Path& path) {
    const bool rapid = motion.kind == MotionKind::rapid;
    const bool dog_leg = rapid && (path.legs.size() > 1 || !path.legs[0].straight);
    const bool links = rapid && tool() && state.watch.has_fed && goes_across(path.legs[0]);
    std::optional<CutModel> before;
    if (dog_leg || links) before = state.stock;
    LegCheck check = leg_check(use(motion));
    double removed = 0.0;
    for (const Leg& leg : path.legs) {
        watch_centre(motion, leg);
        removed += check.run(leg, result.duration, state.stock, result.pairs);
        legs.push_back({leg, result.duration});
        if (use(motion) == FluteUse::cutting)
            note_reach(state.watch.reaches,
                       {setup, *tool(), block.block, leg, state.fixtures_there, state.stock},
                       result.pairs);
    }
    result.removed += removed;
    if (before) look_at_rapid(motion, path, *before);
    if (!rapid) look_at_feed(motion, path, removed);
}

void BlockRun::look_at_rapid(const Motion& motion, const Path& path, const CutModel& before) {
    const bool straight = path.legs.size() == 1 && path.legs[0].straight;
    if (straight && tool())
        return tell(
            low_retract({setup, *tool(), block.block, path.legs[0], state.fixtures_there, before},
                        result.pairs));
    const PairClearance* worst = deciding_pair(result.pairs);
    if (!worst || worst->verdict == Verdict::clear) return;
    Machine machine = setup.machine;
    machine.rapid = RapidStyle::straight;
    CutModel stock = before;
    CheckMemory memory; // bounds of the run hold along its own path only
    std::vector<PairClearance> along_the_line;
    for (const Leg& leg : path_of(motion, machine, chord_error(setup.mesh_size)).legs)
        leg_check(FluteUse::not_cutting, memory).run(leg, 0.0, stock, along_the_line);
    worst = deciding_pair(along_the_line);
    only_dog_leg = only_dog_leg || !worst || worst->verdict == Verdict::clear;
}

void BlockRun::look_at_feed(const Motion& motion, const Path& path, double removed) {
    state.watch.has_fed = true;
    if (!tool() || use(motion) != FluteUse::cutting) return;
    LegCheck check = leg_check(FluteUse::cutting);
    bool in_air = removed <= 0.0;
    for (const Leg& leg : path.legs)
        in_air = in_air && check.room_of_flutes(leg, state.stock, air_gap) >= air_gap;
    if (in_air)
        add_air(state.watch.air, block.block, path.duration * motion.feed / 60.0);
    else
        tell(end_air(state.watch.air, tool()->description.diameter));
    if (in_air) return;
    auto found = singular_orientation(setup.machine, motion, tool()->length);
    const bool swings = found && !motion.tip && removed <= 0.0;
    if (!found || swings || std::exchange(state.watch.told_swing, true)) return;
    tell(std::move(found));
}

void BlockRun::forget_bounds() {
    state.memory.bounds.clear();
    for (PairClearance& pair : result.pairs) pair.at_end = -infinity;
}

void BlockRun::move_without_tool(const Motion& motion) {
    if (!state.tool && (state.tool_known || motion.kind == MotionKind::rapid)) {
        if (!state.tool_known)
            state.assumptions.insert("the spindle is empty until the first tool change");
        return;
    }
    result.checked = false;
    if (std::exchange(state.told_unchecked_tool, true)) return;
    if (state.tool)
        find(
            "undecided",
            fmt::format("Tool {} moves, but nothing is known about it: none of its motions can be "
                        "checked.",
                        value_of(*state.tool)),
            fmt::format("Describe it in the set-up: [[tool]] number = {}.", value_of(*state.tool)));
    else
        find("undecided", "The program feeds before it calls a tool: nobody knows what moves.",
             "Call the tool (T and M6), or describe a single tool in the set-up.");
}

void BlockRun::carry_out(const ToolChange& change) {
    if (tool()) tell(end_air(state.watch.air, tool()->description.diameter));
    state.watch.air = {};
    state.watch.has_fed = state.watch.told_swing = false;
    forget_bounds();
    state.tool = change.tool;
    state.tool_known = true;
    state.told_unchecked_tool = false;
    result.tool = change.tool;
    if (tool()) return check_tool_change();
    if (change.tool)
        find("tool-not-in-table",
             fmt::format("Tool {} is called, but the set-up does not describe it.",
                         value_of(*change.tool)),
             fmt::format("Add [[tool]] number = {} to the set-up.", value_of(*change.tool)));
}

void BlockRun::carry_out(const FixtureChange& change) {
    forget_bounds();
    state.fixtures_there[change.fixture] = change.is_there;
    const Path path = path_of({.from = state.position, .to = state.position}, setup.machine, 0.0);
    if (!change.is_there || path.legs.empty() || !path.legs[0].start_known) return;
    leg_check(FluteUse::not_cutting).rest(path.legs[0].places[0], state.stock, result.pairs);
}

void BlockRun::check_tool_change() {
    const Motion stay{.from = state.position, .to = state.position};
    const Path path = path_of(stay, setup.machine, 0.0);
    if (path.legs.empty() || !path.legs[0].start_known) return;
    std::vector<PairClearance> pairs;
    leg_check(FluteUse::not_cutting).rest(path.legs[0].places[0], state.stock, pairs);
    const PairClearance* worst = deciding_pair(pairs);
    if (!worst || worst->verdict == Verdict::clear) return;
    find("tool-change-unsafe",
         fmt::format("Tool {} is changed in where its {} {} only {:.3f} mm from {}; {:.3f} mm must "
                     "be kept.",
                     value_of(*state.tool), part_name(setup, worst->pair),
                     worst->pair.part == PartKind::flutes ? "are" : "is",
                     worst->found() ? worst->upper : worst->lower, body_name(setup, worst->pair),
                     worst->allowance.distance),
         "Move to a safe place, as with G28 or G53 Z0, before the tool change.");
}

/// The place of the witness in time, at its earliest, where several moments are equally near.
void settle_time(BlockRun& run, PairClearance& pair) {
    if (!pair.found() || (!pair.pair.fixture && run.result.removed > 0.0)) return;
    for (const TimedLeg& timed : run.legs) {
        const double begin = timed.start + timed.leg.begin, end = timed.start + timed.leg.end;
        if (pair.time < begin || pair.time > end) continue;
        LegCheck check = run.leg_check(FluteUse::not_cutting);
        const double seen = end > begin ? (pair.time - begin) / (end - begin) : 0.0;
        const double share =
            check.earliest(timed.leg, pair.pair, pair.upper, run.state.stock, seen);
        pair.time = std::min(pair.time, begin + share * (end - begin));
        return;
    }
}

void BlockRun::conclude() {
    std::sort(result.pairs.begin(), result.pairs.end(),
              [](const PairClearance& a, const PairClearance& b) {
                  return std::tuple(a.pair.fixture, a.pair.part, a.pair.carried)
                         < std::tuple(b.pair.fixture, b.pair.part, b.pair.carried);
              });
    if (const PairClearance* worst = deciding_pair(result.pairs)) {
        result.deciding = static_cast<size_t>(worst - result.pairs.data());
        settle_time(*this, result.pairs[*result.deciding]);
        result.verdict = worst->verdict;
    }
    if (result.motion != BlockMotion::none) {
        CheckMemory& memory = state.memory;
        memory.bounds.clear();
        for (const PairClearance& pair : result.pairs)
            memory.bounds.push_back({pair.pair, pair.at_end, pair.drift});
        memory.deciding.reset();
        if (result.deciding) {
            memory.deciding = result.pairs[*result.deciding].pair;
            memory.margin = result.pairs[*result.deciding].margin();
        }
    }
    for (const PairClearance& pair : result.pairs)
        if (pair.verdict != Verdict::clear) add(finding_about(pair));
    if (result.checked) return;
    result.verdict = std::max(result.verdict, Verdict::undecided);
    result.deciding.reset();
}

} // namespace

const char* name_of(BlockMotion motion) {
    switch (motion) {
    case BlockMotion::none:
        return "none";
    case BlockMotion::rapid:
        return "rapid";
    case BlockMotion::feed:
        return "feed";
    case BlockMotion::arc:
        return "arc";
    default:
        return "cycle";
    }
}

Result<SimulatorState> start_of_run(const Setup& setup, const AxisPosition& position) {
    FEELER_TRY(CutModel stock, make_cut_model(setup.stock, setup.mesh_size, setup.memory_limit));
    if (setup.earlier_cuts) cut(stock, *setup.earlier_cuts, std::thread::hardware_concurrency());
    SimulatorState state{.stock = std::move(stock)};
    state.tool = setup.tool_at_start;
    state.tool_known = setup.tool_at_start.has_value();
    state.position = position;
    for (const Fixture& fixture : setup.fixtures) state.fixtures_there.push_back(fixture.is_there);
    state.pieces = watch_of(state.stock);
    return state;
}

BlockResult run_block(const Setup& setup, const BlockEvents& block, SimulatorState& state) {
    BlockRun run{setup, block, state};
    const size_t cuts_before = state.stock.log.size();
    run.result.time = state.time;
    run.result.tool = state.tool;
    for (const Event& event : block.events)
        std::visit([&](const auto& e) { run.carry_out(e); }, event);
    if (block.is_cycle && run.result.motion != BlockMotion::none)
        run.result.motion = BlockMotion::cycle;
    for (Finding& finding :
         watch_pieces(setup, state.fixtures_there, state.stock, cuts_before, state.pieces))
        run.add(std::move(finding));
    run.conclude();
    state.time += run.result.duration;
    return std::move(run.result);
}

std::vector<Finding> end_of_run(const Setup& setup, SimulatorState& state) {
    std::vector<Finding> findings = findings_of(state.watch.reaches, setup);
    const auto tool = state.tool ? setup.tools.find(*state.tool) : setup.tools.end();
    if (tool != setup.tools.end())
        if (auto air = end_air(state.watch.air, tool->second.description.diameter))
            findings.push_back(*std::move(air));
    for (Finding& finding : findings) settle_severity(setup, finding);
    std::erase_if(findings,
                  [](const Finding& finding) { return finding.severity == Severity::off; });
    return findings;
}

} // namespace core
