#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/batch/program_change.h"

namespace app {

/// A block of a checked program, and how near it comes. mm.
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
    double nearer = 0.0; // by how much its margin is less, mm; negative: more
};

/// What became other from one version of a program or of its set-up to the next.
struct ProgramDiff {
    ProgramResult before, after;
    ProgramChange change;
    size_t same = 0;                   // blocks of both that keep the same margin and verdict
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

} // namespace app
