#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/ids.h"

namespace app {

struct BatchResult;
struct CheckRun;

/// Where a text is written piece by piece, so that it need not be in memory as a whole.
using TextSink = std::function<void(std::string_view piece)>;

/// All that `write` writes to the sink that it is called with.
template <typename Write>
std::string text_of(const Write& write) {
    std::string text;
    write([&](std::string_view piece) { text += piece; });
    return text;
}

/// Writes the report of a check as JSON, schema 1. `pairs` adds every pair of every block.
void json_report(const CheckRun& run, bool pairs, const TextSink& out);

/// The same as a text.
std::string json_report(const CheckRun& run, bool pairs);

/// Writes the JSON report with one object per line, so that a reader need not hold all of it: the
/// program, then its blocks, its findings, and part and statistics. `record` gives the kind of a
/// line: program, block, finding, end.
void json_lines_report(const CheckRun& run, bool pairs, const TextSink& out);

/// The same as a text.
std::string json_lines_report(const CheckRun& run, bool pairs);

/// The names of rules for each block that has any.
using RulesByBlock = std::map<core::BlockIndex, std::vector<std::string>>;

/// The rules of the findings about each block, worst first, each once; includes findings that are
/// summarised in another finding.
RulesByBlock rules_of_blocks(const CheckRun& run);

/// Those of one block; none if it has none.
const std::vector<std::string>& rules_of(core::BlockIndex block, const RulesByBlock& rules);

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
