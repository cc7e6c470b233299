#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/report/json/json_report.h"

namespace app {

struct BatchResult;
struct BatchStyle;
struct CheckRun;
struct ReportViews;

/// A check of one program and the contents of its report.
struct ProgramReport {
    const CheckRun& run;
    const std::string& setup; // path; empty: inferred
    const ReportViews& views;
    bool blocks = false; // text: add the table of all blocks that move
    bool pairs = false;  // JSON: list every pair of bodies in every block
    std::vector<std::string> shown_assumptions = {}; // assumptions already shown on the terminal
    size_t width = 80;                               // text: columns of a line
    bool colour = false;                             // text
};

/// When a report of an incomplete check may replace a file.
enum class UnfinishedReport : uint8_t {
    never,
    when_watching, // the file describes an earlier version of the program
    always         // even if the check could not start
};

/// A report format. To add one: a writer, a row in report_formats.cpp, a row in
/// docs/manual/json-and-other-formats.md, and tests.
struct ReportFormat {
    const char* name;
    const char* help; // in the list of formats that `check --help` shows; may be empty
    // Null: the caller writes this format itself.
    void (*of_program)(const ProgramReport& report, const TextSink& out);
    std::string (*of_batch)(const BatchResult& batch, const BatchStyle& style);
    UnfinishedReport unfinished = UnfinishedReport::when_watching;
};

/// The format with this name, which must exist.
const ReportFormat& report_format(const std::string& name);

/// The names of all formats in the order of the help, without "shard" if `with_shard` is false.
std::vector<std::string> format_names(bool with_shard);

/// The list for help: "text, json, jsonl (one object per line), ... or junit".
std::string format_help(bool with_shard);

} // namespace app
