#include <fmt/format.h>

#include "core/distance/stock_distance.h"
#include "core/sim/clearance.h"
#include "tests/support/machining_tally.h"
#include "tests/support/random_machining.h"
#include "tests/support/true_clearance.h"

namespace test_support {
namespace {

/// A run of random blocks, each compared with the true geometry.
class JudgedMachining {
public:
    JudgedMachining(unsigned seed, bool turning, KnownBodies bodies, MachiningTally& tally)
        : dice_{std::mt19937(seed)},
          turning_(turning),
          bodies_(bodies),
          known_(setup_of(dice_, turning_, bodies)),
          machinist_(dice_, known_),
          seed_(seed),
          tally_(tally) {
        auto begun = core::start_of_run(known_.setup, start());
        if (!begun) return; // thinner than the mesh size: no scan line meets it
        state_ = std::move(*begun);
        take({core::ToolChange{core::ToolNumber{1}},
              core::SpindleChange{core::SpindleDirection::clockwise, 1e4}},
             false);
        for (int i = 0; i < 150; ++i) keep(dice_.within(known_.box));
        for (unsigned i = 0; i < 8; ++i)
            keep({i & 1U ? known_.box.max.x : known_.box.min.x,
                  i & 2U ? known_.box.max.y : known_.box.min.y,
                  i & 4U ? known_.box.max.z : known_.box.min.z});
    }

    void execute_motion(int blocks) {
        for (int i = 0; state_ && i < blocks; ++i) {
            const KnownBlock block = machinist_.next();
            const core::BlockResult result = take(block.events, block.is_cycle);
            note_cut_fixtures(block.passages);
            judge(block.passages, result);
            remember(block.passages, result);
        }
    }

private:
    static KnownSetup setup_of(Dice& dice, bool turning, KnownBodies bodies) {
        KnownSetup known = random_setup(dice, turning);
        if (bodies == KnownBodies::deviating) deviate(dice, known);
        return known;
    }

    core::AxisPosition start() const {
        core::AxisPosition position;
        for (size_t i = 0; i < core::axis_count; ++i)
            if (known_.setup.machine.axes[i].present) position[i] = machinist_.current()[i];
        return position;
    }

    core::BlockResult take(const std::vector<core::Event>& events, bool is_cycle) {
        return core::run_block(known_.setup, {core::BlockIndex{block_++}, is_cycle, events},
                               *state_);
    }

    void keep(const core::Vec3& p) {
        if (!known_.world.is_spared(p)) return;
        constexpr size_t most = 220;
        if (cloud_.size() < most)
            cloud_.push_back(p);
        else
            cloud_[dice_.index(most)] = p;
    }

    /// Whether the flutes ran into the stock, so that it is gone on their way. If an earlier motion
    /// may have removed it before, the verdict is only undecided, but it is gone in any case.
    static bool has_crashed(const core::BlockResult& result) {
        for (const core::PairClearance& pair : result.pairs)
            if (pair.pair == core::Pair{core::PartKind::flutes}
                && (pair.verdict == core::Verdict::collision
                    || (pair.unless_removed && result.removed > 0.0)))
                return true;
        return false;
    }

    void judge(const std::vector<TruePassage>& block, const core::BlockResult& result) {
        ++tally_.blocks;
        ++tally_.verdicts[size_t(result.verdict)];
        const bool crashed = has_crashed(result);
        std::vector<Removal> removals;
        for (const core::Vec3& p : cloud_)
            removals.push_back(known_.world.removal(block, crashed, p));
        core::Verdict worst = core::Verdict::clear;
        for (const core::PairClearance& pair : result.pairs) worst = std::max(worst, pair.verdict);
        const auto is_change = [](const core::Finding& finding) {
            return finding.rule == "tool-change-unsafe";
        };
        const bool changed = std::any_of(result.findings.begin(), result.findings.end(), is_change);
        if (result.checked && (changed ? result.verdict < worst : result.verdict != worst))
            fail("the block's verdict is its pairs' worst", "");
        for (const core::PartKind part : {core::PartKind::flutes, core::PartKind::shank,
                                          core::PartKind::holder, core::PartKind::nose}) {
            judge(block, result, {part, {}}, crashed, removals);
            for (size_t i = 0; i < known_.world.fixtures.size(); ++i)
                judge(block, result, {part, i}, crashed, removals);
        }
    }

    void judge(const std::vector<TruePassage>& block, const core::BlockResult& result,
               const TruePair& pair, bool crashed, const std::vector<Removal>& removals) {
        bool counts = false;
        for (const TruePassage& by : block) counts = counts || pair.counts_in(known_.world, by);
        if (!counts) return;
        ++tally_.pairs;
        core::PairClearance claim{.pair = {pair.part, pair.fixture}, .lower = 0.0};
        claim.allowance = core::allowance_of(known_.setup, claim.pair);
        bool shown_assumptions = false;
        for (const core::PairClearance& known : result.pairs)
            if (known.pair == claim.pair) claim = known, shown_assumptions = true;
        if (pair.cuts_fixture(known_.world) && cut_fixtures_[*pair.fixture])
            return judge_cut_fixture(block, claim, pair, crashed);
        if (!shown_assumptions && known_.setup.detail == core::Detail::every_pair)
            fail("every pair is reported", describe(claim, {}));
        ClearanceSearch search(known_.world, block, pair, crashed, dice_.random);
        if (claim.found()) {
            const core::Vec3 p = in_body(claim.on_body, pair);
            search.offer(pair.fixture ? nearest_of(pair.solid(known_.world), p).nearest : p);
        }
        if (!pair.fixture)
            for (size_t i = 0; i < cloud_.size(); ++i) search.offer_known(cloud_[i], removals[i]);
        if (pair.fixture) search.offer_foremost();
        const double contact = claim.allowance.distance > core::resolution
                                   ? 0.0
                                   : core::contact_depth(claim.allowance);
        search.improve(pair.fixture ? 40 : 14, 1.5,
                       std::min(claim.lower, known_.setup.search_limit) - contact - 1e-5);
        judge_truth(claim, search.best());
        if (claim.found()) judge_witness(block, claim, pair);
        take_widths(claim, pair);
    }

    /// The material of a fixture that flutes have cut is neither an obstacle nor reported; the
    /// remaining material is still an obstacle.
    void judge_cut_fixture(const std::vector<TruePassage>& block, const core::PairClearance& claim,
                           const TruePair& pair, bool crashed) {
        if (claim.verdict != core::Verdict::clear) return;
        ClearanceSearch search(known_.world, block, pair, crashed, dice_.random);
        search.offer_foremost();
        search.improve(40, 1.5, -core::infinity);
        ++tally_.cut_fixtures;
        if (search.best().near.distance < -core::contact_depth(claim.allowance) - 1e-6)
            fail("the remaining fixture is not overlapped", describe(claim, search.best()));
    }

    /// Stores which expendable fixtures the flutes may have cut.
    void note_cut_fixtures(const std::vector<TruePassage>& block) {
        cut_fixtures_.resize(known_.world.fixtures.size());
        for (const TruePassage& by : block) {
            if (!by.chips) continue;
            const core::ProfileElement& hull = by.tool->part(core::PartKind::flutes)->hull;
            for (size_t i = 0; i < cut_fixtures_.size(); ++i) {
                const TrueFixture& fixture = known_.world.fixtures[i];
                if (!fixture.expendable || !by.mounted_fixtures[i]) continue;
                const core::Vec3 middle(0, 0, 0.5 * (hull.z0 + hull.z1));
                constexpr int steps = 16;
                for (int step = 0; step <= steps && !cut_fixtures_[i]; ++step) {
                    const core::AxisValues at = by.path.at(double(step) / steps);
                    const core::Vec3 tip(at[0], at[1], at[2] - by.tool->length);
                    const core::Vec3 p =
                        mounted_place(known_.world.machine, fixture.mount, at, middle + tip);
                    const double reach = std::hypot(hull.r0, 0.5 * (hull.z1 - hull.z0)) + 5.0;
                    cut_fixtures_[i] = nearest_of(fixture.solid, p).distance <= reach;
                }
            }
        }
    }

    core::Vec3 in_body(const core::Vec3& p_stock, const TruePair& pair) const {
        if (!pair.fixture) return p_stock;
        return known_.world.fixtures[*pair.fixture].mount.link_from_body.inverse()
               * (known_.world.stock_mount.link_from_body * p_stock);
    }

    void judge_truth(const core::PairClearance& claim, const NearPoint& best) {
        const double distance = best.near.distance, allowance = claim.allowance.distance;
        tally_.near += distance > 0.0 && distance < 1.0;
        tally_.overlaps += distance < 0.0;
        const bool clear = claim.verdict == core::Verdict::clear;
        if (std::min(claim.lower, known_.setup.search_limit) > std::max(0.0, distance) + 1e-8)
            fail("lower <= truth", describe(claim, best));
        if (clear && allowance > core::resolution && distance < allowance - 2e-6)
            fail("what is clear keeps its allowance", describe(claim, best));
        if (!clear || allowance > core::resolution) return;
        tally_.contacts += distance < 0.0;
        if (distance < -core::contact_depth(claim.allowance) - 1e-6)
            fail("what may touch and is clear does not overlap", describe(claim, best));
    }

    void judge_witness(const std::vector<TruePassage>& block, const core::PairClearance& claim,
                       const TruePair& pair) {
        const bool on_base = !pair.mount(known_.world).on_table;
        if (on_base && turning_) return; // it moves relative to the stock
        ++tally_.witnesses;
        const double deviation = pair.fixture ? known_.setup.fixtures[*pair.fixture].deviation
                                              : known_.setup.stock.deviation;
        const double slack = 1e-4 + deviation;
        const core::Vec3 p = in_body(claim.on_body, pair);
        Removal until{block.size(), 0.0};
        if (pair.fixture) {
            if (nearest_of(pair.solid(known_.world), p).distance > 1e-6 + deviation)
                fail("the witness is on the fixture", describe(claim, {p, {}}));
        } else {
            if (!known_.world.may_be_there(p, slack))
                fail("the witness is on the stock", describe(claim, {p, {}}));
            until = known_.world.certain_removal(block, slack, p);
        }
        const Nearness near = nearness(known_.world, block, pair, p, until, core::infinity);
        constexpr double rounding = 1e-6;
        if (near.distance > claim.upper + rounding)
            fail("the witness is as near as upper says", describe(claim, {p, near}));
        if (bodies_ == KnownBodies::deviating) return; // the bodies as they are known overlap
        if (claim.verdict == core::Verdict::collision && near.distance > 1e-6)
            fail("what collides overlaps", describe(claim, {p, near}));
    }

    void take_widths(const core::PairClearance& claim, const TruePair& pair) {
        if (!claim.found() || known_.setup.detail != core::Detail::every_pair) return;
        const double width = claim.upper - claim.lower;
        if (!pair.fixture) {
            tally_.stock_widths.push_back(width / known_.setup.mesh_size);
            tally_.settled += claim.verdict != core::Verdict::undecided || width < 0.05;
        } else if (!turning_ && known_.setup.machine.rapid == core::RapidStyle::straight) {
            ++tally_.fixture_pairs;
            tally_.sharp += width <= 1e-3;
            tally_.widest = std::max(tally_.widest, width);
        }
    }

    void remember(const std::vector<TruePassage>& block, const core::BlockResult& result) {
        const bool crashed = has_crashed(result);
        const std::vector<core::Vec3> before = std::move(cloud_);
        cloud_.clear();
        for (const core::Vec3& p : before)
            if (known_.world.removal(block, crashed, p).passage == block.size())
                cloud_.push_back(p);
        for (const TruePassage& by : block) {
            if (!by.chips && !crashed) continue;
            known_.world.history.push_back(by);
            known_.world.history.back().is_certain = by.chips;
        }
        const size_t kept = cloud_.size();
        for (const TruePassage& by : block)
            if (by.chips)
                for (int i = 0; i < 8; ++i) keep_beside(by);
        for (size_t i = kept; i < cloud_.size(); ++i) judge_columns(cloud_[i]);
    }

    /// The columns must contain the remaining material, however finely they are divided.
    void judge_columns(const core::Vec3& p) {
        const core::Vec3 half(1e-9);
        const core::ConvexShape point[] = {core::convex(core::Aabb{p - half, p + half})};
        core::StockGoal goal{.limit = 1.0, .bound = core::StockBound::lower};
        goal.threshold = goal.finest = 1e-3;
        const double lower = core::separation(point, state_->stock, goal).separation.lower;
        ++tally_.standing;
        if (lower > known_.setup.stock.deviation + 1e-8)
            fail("all material is in a column",
                 fmt::format("({:.9g}, {:.9g}, {:.9g}): lower {:.3g}", p.x, p.y, p.z, lower));
    }

    /// Stores a point near the wall cut by a passage, because a fin may be all that remains there.
    void keep_beside(const TruePassage& by) {
        const core::RevolvedProfile& flutes = by.tool->part(core::PartKind::flutes)->profile;
        const core::Vec3 p = dice_.within(bounds(flutes).grown(1.0));
        const PieceDistance near = nearest_of(flutes, p);
        if (near.distance <= 0.0) return;
        const double away = dice_.chance(0.5) ? 1e-6 : 0.4 * dice_.fraction();
        const core::Vec3 beside = near.nearest + (p - near.nearest) * (away / near.distance);
        const core::AxisValues at = by.path.at(dice_.fraction());
        keep(mounted_place(known_.world.machine, known_.world.stock_mount, at,
                           beside + core::Vec3(at[0], at[1], at[2] - by.tool->length)));
    }

    std::string describe(const core::PairClearance& claim, const NearPoint& best) const {
        return fmt::format("{}/{}: lower {:.9g}, upper {:.9g}, {}, allowance {:.3g} (contact "
                           "{:.3g}), detail {}, limit {:.3g}, h {:.3g}; truth {:.9g} at ({:.9g}, "
                           "{:.9g}, {:.9g}), passage {} at {:.4f}",
                           core::name_of(claim.pair.part),
                           claim.pair.fixture ? int(*claim.pair.fixture) : -1, claim.lower,
                           claim.upper, core::name_of(claim.verdict), claim.allowance.distance,
                           claim.allowance.contact, int(known_.setup.detail),
                           known_.setup.search_limit, known_.setup.mesh_size, best.near.distance,
                           best.p.x, best.p.y, best.p.z, best.near.passage, best.near.fraction);
    }

    void fail(const std::string& claim, const std::string& what) {
        tally_.failures.push_back(fmt::format("seed {}, block {}{}: {}: {}", seed_, block_ - 1,
                                              turning_ ? " (turning)" : "", claim, what));
    }

    Dice dice_;
    bool turning_;
    KnownBodies bodies_;
    KnownSetup known_;
    RandomMachining machinist_;
    unsigned seed_;
    MachiningTally& tally_;
    std::optional<core::SimulatorState> state_;
    std::vector<core::Vec3> cloud_; // of the stock, certainly existing
    std::vector<bool> cut_fixtures_;
    uint32_t block_ = 0;
};

} // namespace

std::string MachiningTally::report() const {
    size_t narrow = 0;
    for (const double width : stock_widths) narrow += width <= 1.6;
    return fmt::format(
        "{} blocks ({} clear, {} undecided, {} violations, {} collisions), {} pairs: {} within "
        "a millimetre, {} overlap, {} may touch; {} witnesses. Fixtures: {} of {} intervals at "
        "most 1e-3 mm wide, widest {:.2g}. Stock: {} of {} at most 1.6 h, {} decided or below "
        "0.05 mm. {} times clear of a fixture that was cut.\n",
        blocks, verdicts[0], verdicts[1], verdicts[2], verdicts[3], pairs, near, overlaps, contacts,
        witnesses, sharp, fixture_pairs, widest, narrow, stock_widths.size(), settled,
        cut_fixtures);
}

MachiningTally judged_programs(unsigned first_seed, unsigned programs, int blocks, bool turning,
                               KnownBodies bodies) {
    MachiningTally tally;
    for (unsigned i = 0; i < programs; ++i)
        JudgedMachining(first_seed + i, turning, bodies, tally).execute_motion(blocks);
    return tally;
}

} // namespace test_support
