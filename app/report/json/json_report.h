#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/base/ids.h"

namespace app {

struct BatchResult;
struct CheckRun;

/// The report of a check as JSON, schema 1. `pairs` adds every pair of every block.
std::string json_report(const CheckRun& run, bool pairs);

/// The JSON report with one object per line, so that a reader need not hold all of it: the program,
/// then its blocks, its findings, and part and statistics. `record` gives the kind of a line:
/// program, block, finding, end.
std::string json_lines_report(const CheckRun& run, bool pairs);

/// The rules of the findings about each block, worst first, each once; includes findings that are
/// summarised in another finding.
std::map<core::BlockIndex, std::vector<std::string>> rules_of_blocks(const CheckRun& run);

/// A batch as one JSON object, schema 1: its programs as written by json_of, skipped files, and
/// programs that were not checked.
std::string batch_json_report(const BatchResult& batch);

/// One JSON object per line for each program; `{"program": ..., "checked": false}` for one that was
/// not checked.
std::string batch_lines_report(const BatchResult& batch);

/// Comma-separated values with a row for each program; `verdict` is "not checked" for one that was
/// not checked.
std::string batch_csv_report(const BatchResult& batch);

} // namespace app
