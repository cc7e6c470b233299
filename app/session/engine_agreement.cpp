#include "app/session/engine_agreement.h"

#include <algorithm>

namespace app {

void add(EngineAgreement& agreement, const BlockPermit& permit, const core::BlockResult& exact) {
    const bool violates =
        std::any_of(exact.pairs.begin(), exact.pairs.end(), [](const core::PairClearance& pair) {
            return pair.verdict >= core::Verdict::violation;
        });
    ++agreement.blocks;
    agreement.violations += violates;
    agreement.refused += !permit.permitted;
    agreement.not_asked += !permit.not_asked.empty();
    agreement.missed += violates && permit.permitted;
    if (violates || permit.permitted || !permit.not_asked.empty()) return;
    agreement.undecided += exact.verdict == core::Verdict::undecided;
    agreement.false_alarms += exact.verdict == core::Verdict::clear;
}

} // namespace app
