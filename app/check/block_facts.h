#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/ids.h"
#include "core/sim/finding.h"
#include "core/sim/verdict.h"

namespace app {

struct CheckRun;

/// The facts about a block that conditions can test, from a record or a row of a list.
struct BlockFacts {
    size_t block = 0;
    uint32_t line = 0;
    size_t depth = 0;            // of calls
    std::string_view text, file; // must outlive this
    core::BlockMotion motion = core::BlockMotion::none;
    std::optional<core::ToolNumber> tool;
    std::optional<core::Verdict> verdict; // empty: not checked yet
    // mm; infinite beyond the search limit, empty if unknown
    std::optional<double> clearance, upper, allowance, margin;
    double removed = 0.0, duration = 0.0, time = 0.0;
    std::vector<std::string> bodies;            // of its pairs; only if wanted
    std::vector<const core::Finding*> findings; // about it; only if wanted
};

/// Facts that take time to collect and are left out unless wanted.
struct WantedFacts {
    bool bodies = false;
    bool findings = false;
};

/// Cost: reads all findings of the record if they are wanted.
BlockFacts facts_of(const CheckRun& record, size_t block, const WantedFacts& wanted);

} // namespace app
