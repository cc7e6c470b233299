#pragma once

#include <vector>

#include "core/sim/finding.h"

namespace gcode {
struct BlockCommands;
struct Environment;
struct Offsets;
} // namespace gcode

namespace app {

struct CheckRecord;
struct CheckReport;

/// Combines the findings about one limit of an axis into the first of them, which then names the
/// blocks and the largest excess: a program that goes too far mostly does so in many blocks.
/// `report.combined_findings` holds the others. Findings must be in the order of their blocks.
void combine_over_travels(CheckRecord& record, CheckReport& report);

/// Gives findings about limits in a block that moves in machine coordinates a cure for that:
/// neither the position of the work nor its offset changes where such a block goes. `offsets` are
/// those with which it moved.
void cure_machine_moves(std::vector<core::Finding>& findings, const gcode::BlockCommands& block,
                        const gcode::Environment& environment, const gcode::Offsets& offsets);

} // namespace app
