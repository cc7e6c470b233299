#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace app {

struct BatchResult;
struct BatchStyle;
struct CheckRun;
struct ReportViews;

/// A check of one program and what its report is to contain.
struct ProgramReport {
    const CheckRun& run;
    const std::string& setup; // its path; empty: inferred
    const ReportViews& views;
    bool blocks = false;                // the text report has the table of all blocks that move
    bool pairs = false;                 // every pair of bodies of every block
    std::vector<std::string> told = {}; // assumptions that the terminal already shows
};

/// When a report of a check that did not run to its end may replace a file.
enum class UnfinishedReport : uint8_t {
    never,
    when_watching, // the file is from an earlier version of the program
    always         // also of a check that could not begin
};

/// A format of reports. A new format is a writer, a row in report_formats.cpp, a row in
/// docs/manual/json-and-other-formats.md, and its tests.
struct ReportFormat {
    const char* name;
    const char* help; // in the list of formats that `check --help` shows; may be empty
    // Null: the caller writes this format itself.
    std::string (*of_program)(const ProgramReport& report);
    std::string (*of_batch)(const BatchResult& batch, const BatchStyle& style);
    UnfinishedReport unfinished = UnfinishedReport::when_watching;
};

/// All formats in the order in which help lists them.
std::span<const ReportFormat> report_formats();

/// The format with this name, which must exist.
const ReportFormat& report_format(const std::string& name);

/// The names of formats, those of report_formats or only those that a whole batch can have.
std::vector<std::string> format_names(bool with_shard);

/// The same for help: "text, json, jsonl (one object per line), ... or junit".
std::string format_help(bool with_shard);

} // namespace app
