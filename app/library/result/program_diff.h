#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/check/check_run.h"
#include "app/library/result/program_result.h"

namespace app {

/// What changed from one result to a later one.
struct ProgramChange {
    bool verdict_differs = false;
    std::optional<double> nearer; // decrease of the least margin, mm; empty: unknown
    double longer = 0.0;          // seconds
    std::vector<StoredFinding> new_findings, gone_findings;
};

/// Compares two results. Findings are equal if rule, severity, bodies and the text of the block
/// are, regardless of the line.
ProgramChange change_between(const ProgramResult& before, const ProgramResult& after);

/// Returns a key for the place of a finding, equal for the same place in both versions.
using FindingKey = std::function<std::string(const StoredFinding&)>;

/// Compares two results. Findings are equal if rule, severity, bodies and place are.
ProgramChange change_between(const ProgramResult& before, const ProgramResult& after,
                             const FindingKey& key_before, const FindingKey& key_after);

/// A block of a checked program and its clearance, mm.
struct BlockMeasure {
    uint32_t block = 0, line = 0;
    std::string file; // of a subprogram; empty for the main program
    std::string text;
    core::Verdict verdict = core::Verdict::clear;
    std::array<std::string, 2> pair{}; // the deciding pair; empty if there is none
    double lower = 0.0;
    std::optional<double> upper; // empty: nothing was found closer than `lower`
    double allowance = 0.0;
    std::optional<double> margin; // empty if the clearance is unknown
};

/// A block that is in both versions.
struct ChangedBlock {
    BlockMeasure before, after;
    double nearer = 0.0; // decrease of the margin, mm; negative: increase
};

/// What changed from one version of a program or its set-up to the next.
struct ProgramDiff {
    ProgramResult before, after;
    ProgramChange change;
    size_t same = 0;                   // blocks in both with the same margin and verdict
    std::vector<ChangedBlock> nearer;  // margin or verdict got worse; the worst first
    std::vector<ChangedBlock> farther; // margin or verdict got better; the best first
    std::vector<BlockMeasure> added;   // moving blocks only in the later version
    std::vector<BlockMeasure> removed; // moving blocks only in the earlier version

    /// Whether the later version has a new warning or error, a worse verdict as a whole or of a
    /// block, a block whose clearance has decreased and is now less than twice its allowance, or
    /// could no longer be run to its end.
    bool is_worse() const;
};

/// Compares two versions. Blocks with equal text are matched, regardless of their numbers. Between
/// matches, if as many blocks were written as were removed, they are matched one by one. Margins
/// within 0.001 mm count as equal.
ProgramDiff diff_of(const CheckRun& before, const CheckRun& after, const std::string& setup_before,
                    const std::string& setup_after);

/// Matches two lists: pairs of indices with equal items, increasing in both. As many as possible,
/// or nearly so if the lists have little in common.
///
/// Cost:   the length times the number of differences, up to a bound; memory grows with the length.
/// Source: Myers, An O(ND) difference algorithm and its variations, 1986: the linear-space form.
std::vector<std::pair<size_t, size_t>> aligned(std::span<const uint32_t> a,
                                               std::span<const uint32_t> b);

/// The text of a block in capitals, without its number and blanks, which have no meaning.
std::string without_number(std::string_view block);

/// As without_number, also without a comment after a semicolon.
std::string numberless(std::string_view block);

} // namespace app
