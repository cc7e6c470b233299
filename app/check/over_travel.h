#pragma once

namespace app {

struct CheckRecord;
struct CheckReport;

/// Combines the findings about one limit of an axis into the first of them, which then names the
/// blocks and the largest excess: a program that goes too far mostly does so in many blocks.
/// `report.combined_findings` holds the others. Findings must be in the order of their blocks.
void combine_over_travels(CheckRecord& record, CheckReport& report);

} // namespace app
