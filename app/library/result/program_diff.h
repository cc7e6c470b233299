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

/// Findings are the same if rule, severity, bodies and the text of the block are, regardless of the
/// line.
ProgramChange change_between(const ProgramResult& before, const ProgramResult& after);

/// A key for the place of a finding, equal for the same place in two versions.
using PlaceOfFinding = std::function<std::string(const StoredFinding&)>;

/// Findings are the same if rule, severity, bodies and place are.
ProgramChange change_between(const ProgramResult& before, const ProgramResult& after,
                             const PlaceOfFinding& place_before, const PlaceOfFinding& place_after);

/// A block of a checked program and its clearance, mm.
struct BlockMeasure {
    uint32_t block = 0, line = 0;
    std::string file; // of a subprogram's; empty for the main program
    std::string text;
    core::Verdict verdict = core::Verdict::clear;
    std::array<std::string, 2> pair{}; // the one that decides; empty if none does
    double lower = 0.0;
    std::optional<double> upper; // empty: nothing was found nearer than `lower`
    double allowance = 0.0;
    std::optional<double> margin; // empty if nothing is known of its clearance
};

/// A block of both versions.
struct ChangedBlock {
    BlockMeasure before, after;
    double nearer = 0.0; // decrease of its margin, mm; negative: increase
};

/// What changed from one version of a program or its set-up to the next.
struct ProgramDiff {
    ProgramResult before, after;
    ProgramChange change;
    size_t same = 0;                   // blocks of both with the same margin and verdict
    std::vector<ChangedBlock> nearer;  // or of a worse verdict; the worst first
    std::vector<ChangedBlock> farther; // or of a better one, likewise
    std::vector<BlockMeasure> added;   // moving blocks of the later version alone
    std::vector<BlockMeasure> removed; // of the earlier one alone

    /// Whether the later version has a warning or an error more, a worse verdict on the whole or on
    /// a block, a block that has come nearer and now keeps less than twice its allowance, or could
    /// not be run as far.
    bool is_worse() const;
};

/// Blocks go together that say the same, whatever their numbers; and where as many have been
/// rewritten as there were, one with one. Margins count as the same within 0.001 mm.
ProgramDiff diff_of(const CheckRun& before, const CheckRun& after, const std::string& setup_before,
                    const std::string& setup_after);

/// Which items of one list go with which of another: pairs of places with equal items, rising in
/// both. As many as there can be, or nearly, where the lists have little in common.
///
/// Cost:   the length times the number of differences, up to a bound; memory grows with the length.
/// Source: Myers, An O(ND) difference algorithm and its variations, 1986: the linear-space form.
std::vector<std::pair<size_t, size_t>> aligned(std::span<const uint32_t> a,
                                               std::span<const uint32_t> b);

/// The text of a block without its number and blanks, in capitals: they mean nothing.
std::string without_number(std::string_view block);

/// What a block says, whatever its number: the same without a comment behind a semicolon.
std::string numberless(std::string_view block);

} // namespace app
