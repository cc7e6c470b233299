#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/ids.h"
#include "core/sim/clearance.h"
#include "core/sim/finding.h"
#include "core/sim/verdict.h"

namespace core {

/// What a block did and how near it came.
struct BlockResult {
    BlockMotion motion = BlockMotion::none;
    std::optional<ToolNumber> tool;
    double time = 0.0;     // of its start, seconds, at full speed unless settle_time was called
    double duration = 0.0; // seconds, likewise
    double removed = 0.0;  // mm3
    bool checked = true;   // false: it moves, but nothing can be said about its clearance
    Verdict verdict = Verdict::clear;
    std::vector<PairClearance> pairs;
    std::optional<size_t> deciding; // the pair that the report shows; empty beyond the limit
    std::vector<Finding> findings;
};

/// What somebody other than the distance core says of a block.
struct Judgement {
    Verdict verdict = Verdict::clear;
    std::vector<PairClearance> pairs = {}; // that were looked at
    std::optional<Finding> finding = {};   // its severity is left open
    bool checked = true;                   // false: nothing can be said about its clearance
    bool runs_into_stock = false;          // with flutes that do not cut
};

/// What a check has cost so far.
struct Statistics {
    size_t box_tests = 0;   // pairs of boxes compared
    size_t shape_tests = 0; // exact distances of convex shapes or of a shape and a mesh
    size_t refined = 0;     // squares of the stock worked out afresh at a finer mesh size
    size_t sweeps = 0;      // cuts carried out
};

} // namespace core
