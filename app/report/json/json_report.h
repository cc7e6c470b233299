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

/// The same, an object to a line, so that a reader need not hold all of it: what is said of the
/// program, then its blocks, then its findings, then part and statistics. `record` tells them
/// apart: program, block, finding, end.
std::string json_lines_report(const CheckRun& run, bool pairs);

/// The rules of the findings about each block, the worst first, each once; also of those that
/// another finding tells of.
std::map<core::BlockIndex, std::vector<std::string>> rules_of_blocks(const CheckRun& run);

/// A batch as one JSON object, schema 1: its programs as json_of has them, the files that were
/// skipped, and the programs that were not checked.
std::string batch_json_report(const BatchResult& batch);

/// A JSON object to a line for each program; `{"program": ..., "checked": false}` for one that was
/// not checked.
std::string batch_lines_report(const BatchResult& batch);

/// A row for each program as comma-separated values; `verdict` is "not checked" for one that was
/// not.
std::string batch_csv_report(const BatchResult& batch);

} // namespace app
