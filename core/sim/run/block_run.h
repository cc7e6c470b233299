#pragma once

#include <span>
#include <vector>

#include "core/motion/corner.h"
#include "core/sim/leg/leg_check.h"
#include "core/sim/run/cure_trial.h"
#include "core/sim/run/finding_text.h"
#include "core/sim/run/overlap.h"
#include "core/sim/run/simulator.h"
#include "core/sim/setup.h"

namespace core {

/// A pair below its allowance, and the kind of motion in which it is worst.
struct WorstMotion {
    Pair pair;
    Verdict verdict = Verdict::clear;
    double upper = infinity;
    MotionKind kind = MotionKind::rapid;
    bool only_dog_leg = false; // this rapid would be clear if it were straight
};

/// When the clearances found in a region count: in any case; if all bodies keep clear; if, besides,
/// none comes nearer than it is known to do in this block.
enum class RegionUse { always, if_clear, if_precise };

/// A block during its execution.
struct BlockRun {
    const Setup& setup;
    const BlockEvents& block;
    SimulatorState& state;
    BlockResult result = {};
    TrackedPairs pairs = {};
    std::vector<TimedLeg> legs = {};
    std::vector<WorstMotion> worst_motions = {};
    Verdict at_change = Verdict::clear; // of the new tool at the tool change
    bool turns = false;                 // whether rotary axes move
    bool pushes_centre = false;         // the non-cutting centre is pushed down into the stock
    bool drills_sideways = false;
    bool leaves_contact = false;  // a probing move that ends when its contact is lost
    bool is_uncertain = false;    // a motion is a probing move, or starts where one ended
    double off_path = 0.0;        // deviation of its feeds by rounded corners, mm
    double off_path_rapids = 0.0; // likewise of its rapids
    double off_by_axes = 0.0;     // of all its motions by the tolerances of axes of rotation, mm
    size_t moves_before = state.stock.log.size(); // that cut the stock before the block
    RoundedCorners corners_before = state.corners;

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

    /// Adds the finding of a rule, with its severity in this set-up; without a block, it gets this
    /// one.
    void tell(std::optional<Finding> finding) {
        if (!finding) return;
        settle_severity(setup, *finding);
        if (!finding->block) finding->block = block.block;
        if (finding->severity != Severity::off) result.findings.push_back(*std::move(finding));
    }

    /// Whether nobody knows how high the spindle is: its tool is not described, and Z rests on a
    /// length that nobody states.
    bool spindle_is_lost() const {
        return state.tool && !tool() && (state.length_offset.is_assumed || state.height_is_assumed);
    }

    /// Whether Z in machine coordinates rests on a length of the tool that nobody states.
    bool has_guessed_height() const {
        return !block.in_machine && tool() && tool()->description.length_is_guess
               && state.length_offset.number;
    }

    /// The check for the legs of a motion, with the current tool, if any.
    LegCheck leg_check(FluteUse use, CheckMemory& memory) {
        static const ToolAssembly nothing;
        const ToolAssembly* held = tool();
        if (held && is_oriented(*held)) held = held->oriented.get();
        return {setup,  held ? *held : nothing, use,          block.block,  state.mounted_fixtures,
                memory, state.statistics,       block.replay, block.threads};
    }
    /// Whether a cycle has stopped the spindle of a boring bar, to move its edge off the wall.
    bool is_oriented(const ToolAssembly& held) const {
        return held.oriented && block.is_cycle
               && state.spindle.direction == SpindleDirection::stopped;
    }
    LegCheck leg_check(FluteUse use) { return leg_check(use, state.memory); }

    FluteUse use(const Motion& motion) const {
        const bool feeds = motion.kind != MotionKind::rapid;
        const bool cuts =
            tool() && turns_to_cut(state.spindle, *tool()) && cuts_along(*tool(), motion);
        return feeds && cuts ? FluteUse::cutting : FluteUse::not_cutting;
    }

    void execute_motion(const Motion& motion);
    void execute_motion(const ToolChange& change);
    void execute_motion(const SpindleChange& change) { state.spindle = change; }
    void execute_motion(const Dwell& dwell) {
        result.duration += dwell.seconds;
        state.corners.last = {};
    }
    void execute_motion(const LengthOffsetChange& change) { state.length_offset = change; }
    void execute_motion(const PathModeChange& change);
    void execute_motion(const FixtureChange& change);

    /// `is_spread`: the legs are hulls because the start or the end of the motion is uncertain.
    void check_path(const Motion& motion, const Path& path, bool is_spread);
    /// Whether the body of a pair with the stock moves where its tool has cut. That both deviate
    /// alike there is a premise. `rises`: all legs of the block go upwards.
    bool follows_own_cut(const PairClearance& pair, bool rises);
    /// Whether it does not matter for a pair what rounded corners have left of the stock: on all
    /// legs of the block it at most touches the raw stock, cuts, or leaves what it has just cut.
    bool touches_no_doubtful_stock(const PairClearance& pair);
    /// Cuts the stock along a path without measuring, for a block with a `Judgement`.
    void follow_path(const Motion& motion, const Path& path);
    /// Runs the check of a leg. A pair that becomes worse on it only because of stock that an
    /// undecided block may have removed is undecided.
    double check_leg(LegCheck& check, const Leg& leg, bool cuts);
    void doubt_clearances(LegCheck& check, const Leg& leg, const TrackedPairs& before);
    /// Makes the cuts of the stock from this number of its log on in the certain stock, too.
    void repeat_cuts(size_t first);
    /// If it is undecided whether the flutes met the stock in a motion: the stock on their way is
    /// no longer certain.
    void note_doubt(LegCheck& check, const Motion& motion, const Path& path);
    void check_rapid(const Motion& motion, const Path& path, const CutModel& before,
                     std::span<const size_t> worsened);
    void check_feed(const Motion& motion, const Path& path, double removed);
    void move_without_tool(const Motion& motion, const Path& path);
    /// Reports, once, a motion that is not clear with some tool of the set-up, while nobody states
    /// which tool is in the spindle.
    void doubt_empty_spindle(const Path& path);
    /// A motion of which it is unknown where it brings the bodies: nothing is measured or cut.
    void move_unmeasured(const Motion& motion, const Path& path);
    void track_centre(const Motion& motion, const Leg& leg);
    std::vector<size_t> note_worst(MotionKind kind);
    /// The motion to name in a finding about the pair.
    BlockMove move_of(const PairClearance& pair) const;
    Finding finding_about(const PairClearance& pair, const PairStudy& study = {}) const;
    /// Measures the overlap of a pair that is not clear, and tries shifts of the block, unless the
    /// run has already done so too often.
    PairStudy study(const PairClearance& pair);
    /// Whether a pair is to be studied; counts it.
    bool may_study(const PairClearance& pair);
    /// Whether the pair overlaps where the block begins; `before` is the stock before the block.
    bool overlaps_at_start(const Pair& pair, const CutModel& before);
    std::vector<ShiftStart> shifts_to_try(const PairClearance& pair, const PairStudy& study,
                                          bool rapid_in_stock) const;
    void check_tool_change();
    void forget_bounds();
    /// `before`: how far the machine may be from the start of the motion.
    void check_limits(const Motion& motion, const AxisSpread& before);
    /// How far the bodies may be from where they are measured on a path, because axes of rotation
    /// are only known with tolerances.
    void note_axis_tolerances(const Path& path);
    void round_corners(const Motion& motion, const Path& path);
    /// The legs of a motion from everywhere where the machine may be; advances `state.spread`.
    Path take_path(const Motion& motion);
    /// Follows a probing move until its flutes make contact, which is its purpose, and checks the
    /// other bodies up to there. The machine may then be anywhere on this way. One that leaves the
    /// contact must come out of the stock. `before`: where the machine may be at its start.
    void check_probing(const Motion& motion, const Path& path, const AxisSpread& before);
    void check_leaving(const Path& path, const AxisSpread& before, TrackedPairs& found);
    /// Measures all bodies at rest wherever the machine may be.
    void check_rest(const Path& path);
    void check_corner(const Motion& motion, const Path& path);
    /// Checks legs that the machine makes while it ends the motion of which `last.rest` is left.
    void check_beside_rest(const std::vector<Leg>& legs, bool may_cut);
    /// Whether the flutes may meet the stock at the corner where a motion begins, because they cut
    /// in it or in the feed before.
    bool flutes_may_cut(const Motion& motion) const;
    /// Checks that bodies keep clear on legs `anywhere` in a region, or within `deviation` of the
    /// path `along` it, if that is stated. `may_cut`: the flutes may meet the stock.
    ///
    /// Result: whether the clearances found count, as `when` says. If not, nothing has changed.
    bool check_region(const std::vector<Leg>& anywhere, const std::vector<Leg>& along,
                      double deviation, bool may_cut, RegionUse when = RegionUse::always);
    void check_from_unknown(const Motion& motion, const Path& path);
    /// Whether a motion with an unknown start is proven clear from every possible start.
    bool is_clear_from_anywhere(const Motion& motion);
    /// Reports, once, a motion that is checked only from the assumed start position.
    void doubt_assumed_start(const Motion& motion);
    void conclude();
    void conclude(const Judgement& judgement);
};

} // namespace core
