#include "core/sim/run/cure_trial.h"

#include <algorithm>
#include <cmath>

#include "core/dbm/earlier_model.h"
#include "core/motion/kinematics.h"
#include "core/motion/path.h"
#include "core/sim/moving_body.h"
#include "core/sim/run/simulator.h"
#include "core/sim/setup.h"

namespace core {
namespace {

constexpr double largest_shift = 100.0;     // mm
constexpr size_t most_replayed = 2'000'000; // moves that are cut again at a time
constexpr size_t few_moves = 1000;          // so many are cut again in all tiles
constexpr double memory_fraction = 0.25;    // of the limit, that a second stock may take

Motion shifted(Motion motion, size_t axis, double by) {
    for (AxisPosition* position : {&motion.from, &motion.to})
        if ((*position)[axis]) *(*position)[axis] += by;
    if (motion.arc) motion.arc->centre[static_cast<int>(axis)] += by;
    return motion;
}

/// The set-up for trials that must keep a pair clear.
Setup trial_setup(Setup setup, const Pair& pair) {
    setup.detail = Detail::every_pair;
    // Nothing more is measured once a trial has failed. Bounds from the stock are as sharp as ever:
    // only blocks in which nothing turns are tried.
    setup.needs_only_verdict = !pair.fixture;
    return setup;
}

/// Runs a block again and again with its path shifted.
class ShiftSearch {
public:
    ShiftSearch(const BlockTrial& trial, const Pair& pair, double room, size_t& work)
        : trial_(trial),
          pair_(pair),
          room_(room),
          work_(work),
          setup_(trial_setup(trial.setup, pair)),
          bodies_(moving_bodies(trial.setup, trial.setup.tools.at(*trial.state.tool))) {}

    std::optional<TriedShift> run(const std::vector<ShiftStart>& starts) {
        if (starts.empty()) return std::nullopt;
        double amount = in_thousandths(starts[0].first);
        if (const auto done = attempt(starts[0], amount))
            return smaller(starts[0], 0.95 * amount, *done);
        double before = amount;
        amount = std::max(amount, 0.5);
        for (; amount <= largest_shift; before = amount, amount *= 2.0)
            for (const ShiftStart& start : starts)
                if (const auto done = attempt(start, in_hundredths(amount)))
                    return smaller(start, before, *done);
        return std::nullopt;
    }

private:
    static double in_thousandths(double amount) { return std::ceil(1e3 * amount - 1e-6) / 1e3; }
    static double in_hundredths(double amount) { return std::ceil(1e2 * amount - 1e-6) / 1e2; }

    /// The smallest amount between one that is not enough and one that is.
    TriedShift smaller(const ShiftStart& start, double low, TriedShift enough) {
        while (std::abs(enough.by) - low > 0.011) {
            const double middle = in_hundredths(0.5 * (low + std::abs(enough.by)));
            if (middle >= std::abs(enough.by)) break;
            if (const auto done = attempt(start, middle))
                enough = *done;
            else
                low = middle;
        }
        return enough;
    }

    std::optional<TriedShift> attempt(const ShiftStart& start, double amount) {
        const double by = start.sign * amount;
        std::vector<Event> events;
        for (const Event& event : trial_.block.events) {
            const auto* motion = std::get_if<Motion>(&event);
            events.push_back(motion ? Event(shifted(*motion, start.axis, by)) : event);
        }
        if (is_too_near(events)) return std::nullopt;
        SimulatorState state{.stock = trial_.stock};
        state.tool = trial_.state.tool;
        state.tool_known = trial_.state.tool_known;
        state.mounted_fixtures = trial_.state.mounted_fixtures;
        state.spindle = trial_.state.spindle;
        state.length_offset = trial_.state.length_offset;
        state.corners = trial_.corners;
        if (const auto* motion = std::get_if<Motion>(&events.front()))
            state.position = motion->from;
        BlockEvents block = trial_.block;
        block.events = events;
        block.is_trial = true;
        block.replay = nullptr;
        const BlockResult result = run_block(setup_, block, state);
        work_ += state.statistics.box_tests + state.statistics.shape_tests
                 + 100 * state.statistics.refined;
        const bool has_error =
            std::any_of(result.findings.begin(), result.findings.end(),
                        [](const Finding& each) { return each.severity == Severity::error; });
        if (!result.checked || result.verdict != Verdict::clear || has_error) return std::nullopt;
        if (trial_.must_cut && result.removed <= 0.0) return std::nullopt;
        for (const PairClearance& pair : result.pairs)
            if (pair.pair == pair_ && pair.lower >= room_ - resolution)
                return TriedShift{start.axis, by, pair.lower};
        return std::nullopt;
    }

    /// Whether the pair, if one with a fixture, certainly stays below its allowance: much cheaper
    /// than a run of the block.
    bool is_too_near(const std::vector<Event>& events) const {
        const Setup& setup = trial_.setup;
        if (!pair_.fixture || setup.fixtures[*pair_.fixture].expendable) return false;
        const Fixture& fixture = setup.fixtures[*pair_.fixture];
        const double allowance = allowance_of(setup, pair_).distance;
        for (const Event& event : events) {
            const auto* motion = std::get_if<Motion>(&event);
            if (!motion) continue;
            for (const Leg& leg :
                 path_of(*motion, setup.machine, chord_error(setup.mesh_size)).legs)
                if (leg.straight && upper_bound(leg, fixture, allowance) < allowance - resolution)
                    return true;
        }
        return false;
    }

    /// An upper bound of the pair's clearance over a leg.
    double upper_bound(const Leg& leg, const Fixture& fixture, double limit) const {
        for (const MovingBody& body : bodies_) {
            if (body.kind != pair_.part || body.carried != pair_.carried) continue;
            const RelativeLeg relative = leg_against(trial_.setup, pair_.fixture, body, leg);
            if (relative.error == infinity) break;
            size_t tests = 0;
            return distance_over(relative, body, fixture.body, limit + relative.error, tests).upper
                   + relative.error;
        }
        return infinity;
    }

    const BlockTrial& trial_;
    const Pair& pair_;
    double room_;
    size_t& work_;
    Setup setup_;
    std::vector<MovingBody> bodies_;
};

} // namespace

std::shared_ptr<const CutModel> stock_after(const Setup& setup, SimulatorState& state,
                                            size_t moves) {
    if (state.stock.log.size() == moves) return std::make_shared<CutModel>(state.stock);
    TrialMemory& trials = state.trials;
    const bool is_near = trials.stock && trials.stock->log.size() <= moves
                         && moves - trials.stock->log.size() <= few_moves;
    if (is_near) {
        auto replayed = std::make_shared<CutModel>(*trials.stock);
        for (size_t i = replayed->log.size(); i < moves; ++i)
            cut(*replayed, state.stock.log[i].sweep);
        trials.stock = std::move(replayed);
    } else {
        if (!trials.raw) {
            const double limit = memory_fraction * setup.memory_limit;
            auto raw = make_cut_model(state.stock.solid, state.stock.lines.grid.spacing, limit);
            if (!raw) return nullptr;
            trials.raw = std::make_shared<const CutModel>(*std::move(raw));
        }
        auto earlier = earlier_model(state.stock, *trials.raw, moves, most_replayed);
        if (!earlier) return nullptr;
        trials.stock = std::make_shared<const CutModel>(*std::move(earlier));
    }
    return trials.stock->log.size() == moves ? trials.stock : nullptr;
}

bool can_shift(const BlockEvents& block) {
    if (block.judgement || block.is_trial || block.goes_home || block.events.empty()) return false;
    return std::holds_alternative<Motion>(block.events.front())
           && std::all_of(block.events.begin(), block.events.end(), [](const Event& event) {
                  const auto* motion = std::get_if<Motion>(&event);
                  return motion ? !motion->tip : std::holds_alternative<Dwell>(event);
              });
}

std::optional<TriedShift> find_shift(const BlockTrial& trial, const Pair& pair,
                                     const std::vector<ShiftStart>& starts, double room,
                                     size_t& work) {
    return ShiftSearch(trial, pair, room, work).run(starts);
}

} // namespace core
