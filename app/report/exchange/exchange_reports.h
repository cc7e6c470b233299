#pragma once

#include <string>

#include "app/library/result/batch_result.h"

namespace app {

struct CheckRun;

/// The blocks of a check as comma-separated values (RFC 4180), a row to each, under a row of names.
/// Columns are those of a block in JSON; a cell is empty where JSON says null. `rules` names the
/// findings of the block, the worst first, with blanks between.
std::string csv_report(const CheckRun& run);

/// A batch as JUnit has it, in XML: a test case for each program, with its errors as a failure; one
/// that could not be run to its end has an error, one that was not checked was skipped. Warnings
/// and notes stand in the case's output.
std::string junit_report(const BatchResult& batch);

/// A batch as SARIF 2.1.0, for code hosts: a result for each finding, at its line; the rules with
/// their help; a result and a notification for each program that could not be run to its end, or
/// was not checked. Of more than 25,000 results, which code hosts refuse, the worst: errors first,
/// and the worst of each program before its others; a notification says how many are left out.
/// `folder` is the one that relative paths count from, as an absolute path.
///
/// Fingerprints are made of rule, bodies, the block's text without its number, and how often the
/// same came before: they do not change when blocks are renumbered or inserted.
std::string sarif_report(const BatchResult& batch, const std::string& folder);

/// A path as a URI reference: special characters are escaped, absolute paths become file:///...
std::string uri_of(const std::string& path);

/// Identifies a finding within its program. `before`: number of equal findings before it.
std::string fingerprint_of(const StoredFinding& finding, size_t before);

} // namespace app
