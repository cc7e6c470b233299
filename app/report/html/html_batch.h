#pragma once

#include <string>

#include "app/library/result/batch_result.h"
#include "app/library/result/program_result.h"
#include "app/report/html/html_text.h"

namespace app {

/// A batch as one HTML file that needs nothing else: no network, no other file.
///
/// Result: what became of it, what is missing said first; a table of all programs, each of which
///         opens; rules over all programs; skipped files. Under 20 MB for 10,000 programs.
std::string batch_html_report(const BatchResult& batch);

/// All programs of a batch as columns, for the script of its page: a JSON object. Programs that
/// were not checked stand behind the others.
///
/// Units:  um, ms and mm3, as integers; a lower bound is rounded down and an upper one up.
/// Result: at most some 18 MB, however much was found: of a program that found very much, only
///         some of its worst findings are there; `tally` counts all.
/// Cost:   linear; each different text once.
std::string batch_columns_json(const BatchResult& batch);

/// The folder that the paths of all programs begin with, with its slash; empty if there is none.
std::string common_folder(const BatchResult& batch);

/// "125 programs in parts/".
std::string batch_title(const BatchResult& batch);

/// What became of a batch, in some words: "3 of 125 programs were not checked to their end".
std::string batch_outcome_text(const BatchResult& batch);

/// The class by which the page colours that.
const char* batch_outcome_class(const BatchResult& batch);

/// What is missing, before anything else is said: programs that were not checked, or not to their
/// end. As HTML; empty when all is there.
std::string html_missing(const BatchResult& batch);

/// A button for each outcome that some program has, with their number, as HTML.
std::string html_outcomes(const BatchResult& batch);

/// What is said of a batch as a whole, as rows of an HTML table.
std::string html_batch_summary(const BatchResult& batch);

/// The rules that were found, as rows of an HTML table, each with a button.
std::string html_rules(const BatchResult& batch);

/// The files that were skipped, by the reason, as HTML.
std::string html_skipped(const BatchResult& batch);

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
    void add(const StoredFinding& finding);

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
