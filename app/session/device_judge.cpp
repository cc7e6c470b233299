#include "app/session/device_judge.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/sim/bound_text.h"

namespace app {
namespace {

using core::Verdict;

Verdict verdict_of(const AskedPair& asked) {
    if (!asked.refused) return Verdict::clear;
    return asked.may_overlap || asked.allowance.distance <= core::resolution ? Verdict::collision
                                                                             : Verdict::violation;
}

core::PairClearance clearance_of(const AskedPair& asked, double search_limit) {
    core::PairClearance pair{.pair = asked.pair, .allowance = asked.allowance};
    pair.lower = std::min(asked.lower, search_limit);
    pair.verdict = verdict_of(asked);
    return pair;
}

std::string nearness(const AskedPair& asked) {
    if (asked.allowance.distance <= core::resolution) return "run into each other";
    if (asked.may_overlap)
        return fmt::format("meet; {} mm must be kept", core::at_most(asked.allowance.distance));
    return fmt::format("may be as near as {} mm; {} mm must be kept",
                       core::clearance_at_least(asked.lower),
                       core::at_most(asked.allowance.distance));
}

/// The worst pair that was refused; null if none was.
const AskedPair* worst_of(const BlockPermit& permit) {
    const AskedPair* worst = nullptr;
    const auto margin = [](const AskedPair& pair) { return pair.lower - pair.allowance.distance; };
    for (const AskedPair& pair : permit.pairs) {
        if (!pair.refused) continue;
        const bool is_worse =
            !worst || verdict_of(pair) > verdict_of(*worst)
            || (verdict_of(pair) == verdict_of(*worst) && margin(pair) < margin(*worst));
        if (is_worse) worst = &pair;
    }
    return worst;
}

core::Finding refusal(const core::Setup& setup, const BlockPermit& permit) {
    core::Finding finding;
    finding.rule = "refused";
    if (const AskedPair* worst = worst_of(permit)) {
        finding.pair = {core::part_name(setup, worst->pair), core::body_name(setup, worst->pair)};
        finding.shortfall = std::max(0.0, worst->allowance.distance - worst->lower);
    }
    if (!permit.not_asked.empty() && permit.stop == hwsim::Stop::none) {
        finding.message = fmt::format("The coprocessor cannot be asked about this block, so it "
                                      "gives no permit: {}.",
                                      permit.not_asked);
        finding.cure = "Check the block with the exact engine.";
    } else if (permit.stop == hwsim::Stop::violation && worst_of(permit)) {
        const bool is_stock = !worst_of(permit)->pair.fixture;
        finding.message = fmt::format(
            "The coprocessor refuses this block: its models of the {} and of {} {}.",
            finding.pair[0], is_stock ? "the stock" : finding.pair[1], nearness(*worst_of(permit)));
        finding.cure = "The exact engine tells how near they really come, when, and where.";
    } else {
        finding.message = fmt::format("The coprocessor refuses this block, because of a fault: {}.",
                                      hwsim::name_of(permit.stop));
        finding.cure = "Check the block with the exact engine.";
    }
    return finding;
}

} // namespace

core::Result<DeviceJudge> DeviceJudge::with(const core::Setup& setup, const core::CutModel& stock) {
    DeviceJudge judge(setup);
    FEELER_TRY(hwsim::FunctionalDevice device, hwsim::functional_device({}));
    judge.device_ = std::make_unique<hwsim::FunctionalDevice>(std::move(device));
    FEELER_TRY(judge.check_, CoprocessorCheck::with(hwsim::port_of(*judge.device_), setup, stock,
                                                    Asking::everything));
    return judge;
}

core::Result<core::Judgement> DeviceJudge::judge(std::span<const core::Event> block,
                                                 const core::SimulatorState& before) {
    FEELER_TRY(const BlockPermit permit, check_->ask(block, before));
    core::Judgement judgement;
    for (const AskedPair& asked : permit.pairs) {
        judgement.pairs.push_back(clearance_of(asked, setup_->search_limit));
        judgement.runs_into_stock =
            judgement.runs_into_stock
            || (asked.refused && asked.pair == core::Pair{core::PartKind::flutes});
    }
    if (permit.permitted) return judgement;
    judgement.verdict = Verdict::undecided;
    judgement.checked = permit.not_asked.empty() || worst_of(permit);
    if (!permit.is_told || permit.stop != hwsim::Stop::none)
        judgement.finding = refusal(*setup_, permit);
    return judgement;
}

} // namespace app
