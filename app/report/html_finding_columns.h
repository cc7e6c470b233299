#pragma once

#include <string>

#include "app/batch/program_result.h"
#include "app/report/html_columns.h"

namespace app {

/// The findings of many programs as columns, one program behind the other.
class FindingColumns {
public:
    /// Texts go into a table that others use as well. At most so many findings of each program are
    /// kept, the worst severities before others.
    FindingColumns(TextTable& texts, size_t most) : texts_(texts), most_(most) {}

    void add(const ProgramResult& program);

    /// A JSON object. `count` says how many of each program there are; `tally` has rule, severity
    /// and number for each kind of finding of each program, `kinds` how many of these it has: they
    /// count all findings.
    std::string json() const;

private:
    void add(const KeptFinding& finding);

    TextTable& texts_;
    TextTable rules_;
    size_t most_;
    NumberRuns count_, severity_, rule_, file_, pair_, message_, cure_, shortfall_, kinds_;
    StepRuns line_, block_, text_;
    std::vector<int64_t> tally_;
};

/// The names of two bodies as a page shows them; empty if there are none.
std::string pair_name(const std::array<std::string, 2>& pair);

/// The number of a text of any bytes and any length in a table, as a page shows it.
int64_t shown_text(TextTable& texts, const std::string& text);

} // namespace app
