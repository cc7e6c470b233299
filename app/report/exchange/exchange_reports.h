#pragma once

#include <string>

#include "app/library/result/batch_result.h"
#include "app/report/json/json_report.h"

namespace app {

struct CheckRun;

/// Writes the blocks of a check as comma-separated values (RFC 4180), one row per block, under a
/// row of column names. The columns are the JSON fields of a block; a cell is empty where JSON has
/// null. `rules` lists the rules of the block's findings, worst first, separated by blanks.
void csv_report(const CheckRun& run, const TextSink& out);

/// The same as a text.
std::string csv_report(const CheckRun& run);

/// A batch in JUnit's XML format: a test case for each program, with its errors as a failure. A
/// program that stopped early or was not checked has an error. Warnings and notes are in the output
/// of the case.
std::string junit_report(const BatchResult& batch);

/// A batch as SARIF 2.1.0, for code hosts: the rules with their help; a result for each finding, at
/// its line; a result and a notification for each program that stopped early or was not checked.
/// Code hosts refuse more than 25,000 results; if there are more, the worst are kept: errors first,
/// and within a program the worst first. A notification gives the number omitted. `folder`:
/// absolute path to which relative paths refer.
///
/// Fingerprints consist of the rule, the bodies, the block's text without its number, and the
/// number of equal findings before it. They do not change if blocks are renumbered or inserted.
std::string sarif_report(const BatchResult& batch, const std::string& folder);

/// A path as a URI reference: special characters are escaped, absolute paths become file:///...
std::string uri_of(const std::string& path);

/// Identifies a finding within its program. `before`: number of equal findings before it.
std::string fingerprint_of(const StoredFinding& finding, size_t before);

} // namespace app
