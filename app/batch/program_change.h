#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/batch/program_result.h"

namespace app {

/// What became other from one result to a later one.
struct ProgramChange {
    bool verdict_differs = false;
    std::optional<double> nearer; // by how much the least margin is less, mm; empty: unknown
    double longer = 0.0;          // seconds
    std::vector<KeptFinding> new_findings, gone_findings;
};

/// Findings are the same when rule, severity, bodies and what their block says are, wherever the
/// block has gone.
ProgramChange change_between(const ProgramResult& before, const ProgramResult& after);

/// A name for the place of a finding, by which those of two versions go together.
using PlaceOfFinding = std::function<std::string(const KeptFinding&)>;

/// Findings are the same when rule, severity, bodies and place are.
ProgramChange change_between(const ProgramResult& before, const ProgramResult& after,
                             const PlaceOfFinding& place_before, const PlaceOfFinding& place_after);

} // namespace app
