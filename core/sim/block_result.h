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

/// What a block did, and its clearances.
struct BlockResult {
    BlockMotion motion = BlockMotion::none;
    std::optional<ToolNumber> tool;
    double time = 0.0;     // of its start, s; without accelerations until settle_time
    double duration = 0.0; // seconds; without accelerations until settle_time
    double removed = 0.0;  // mm3
    bool checked = true;   // false: it moves, but its clearance is unknown
    Verdict verdict = Verdict::clear;
    std::vector<PairClearance> pairs;
    std::optional<size_t> deciding; // index of the pair in the report; empty: none within the limit
    std::vector<Finding> findings;
};

/// Verdict on a block from a source other than the distance core, such as the coprocessor.
struct Judgement {
    Verdict verdict = Verdict::clear;
    std::vector<PairClearance> pairs = {}; // that were measured
    std::optional<Finding> finding = {};   // its severity is set later
    bool checked = true;                   // false: its clearance is unknown
    bool runs_into_stock = false;          // with flutes that do not cut
};

/// Work that a check has done so far.
struct Statistics {
    size_t box_tests = 0;   // pairs of boxes compared
    size_t shape_tests = 0; // exact distances of convex shapes or of a shape and a mesh
    size_t refined = 0;     // columns of the stock recomputed at a finer mesh size
    size_t sweeps = 0;      // sweeps subtracted from the stock
};

} // namespace core
