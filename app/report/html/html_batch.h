#pragma once

#include <string>

#include "app/library/result/batch_result.h"
#include "app/library/result/program_result.h"
#include "app/report/html/html_text.h"

namespace app {

/// A batch as one self-contained HTML file that needs no network and no other file.
///
/// Result: the outcome, with missing programs first; a table of all programs, each of which can be
///         opened; rules over all programs; skipped files. Under 20 MB for 10,000 programs.
std::string batch_html_report(const BatchResult& batch);

/// All programs of a batch as columns, for the script of its page: a JSON object. Programs that
/// were not checked come last.
///
/// Units:  um, ms and mm3, as integers; lower bounds are rounded down and upper bounds up.
/// Result: at most about 18 MB, however many findings there are: of a program with very many, only
///         some of the worst are included; `tally` counts all.
/// Cost:   linear; each different text is stored once.
std::string batch_columns_json(const BatchResult& batch);

/// The folder common to the paths of all programs, with its slash; empty if there is none.
std::string common_folder(const BatchResult& batch);

/// "125 programs in parts/".
std::string batch_title(const BatchResult& batch);

/// The outcome of a batch in a few words: "3 of 125 programs were not checked to their end".
std::string batch_outcome_text(const BatchResult& batch);

/// CSS class that colours the outcome.
const char* batch_outcome_class(const BatchResult& batch);

/// HTML that lists programs that were not checked, or not to their end, for the top of the page;
/// empty if all were checked.
std::string html_missing(const BatchResult& batch);

/// HTML with a button for each outcome that occurs and its number of programs.
std::string html_outcomes(const BatchResult& batch);

/// Facts about the batch as a whole, as rows of an HTML table.
std::string html_batch_summary(const BatchResult& batch);

/// The rules with findings, as rows of an HTML table, each with a button.
std::string html_rules(const BatchResult& batch);

/// The skipped files as HTML, grouped by reason.
std::string html_skipped(const BatchResult& batch);

/// The findings of many programs as columns, one program after the other.
class FindingColumns {
public:
    /// Stores texts in `texts`, which others may share. Keeps at most `most` findings of each
    /// program, highest severity first.
    FindingColumns(TextTable& texts, size_t most) : texts_(texts), most_(most) {}

    void add(const ProgramResult& program);

    /// A JSON object. `count`: number of findings kept for each program. `tally`: rule, severity
    /// and number for each kind of finding of each program, counting all findings; `kinds`: number
    /// of kinds for each program.
    std::string json() const;

private:
    void add(const StoredFinding& finding);

    TextTable& texts_;
    TextTable rules_;
    size_t most_;
    NumberRuns count_, severity_, rule_, file_, pair_, message_, cure_, shortfall_, kinds_;
    DeltaRuns line_, block_, text_;
    std::vector<int64_t> tally_;
};

/// The names of two bodies as the page shows them; empty if there are none.
std::string pair_name(const std::array<std::string, 2>& pair);

/// The index in the table of a text as the page shows it. Accepts any bytes and any length.
int64_t shown_text(TextTable& texts, const std::string& text);

} // namespace app
