#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/support/scoped_folder.h"
#include "tests/support/setup_writer.h"
#include "tests/support/shell.h"

namespace app_test {

/// A pair of bodies during a block, as in the report.
struct PairLine {
    std::string name; // "holder clamp-1"; empty if nothing came near
    double lower = 0.0;
    std::optional<double> upper, allowance, at;
    std::string verdict;
};

struct BlockLine {
    int block = 0, line = 0;
    std::string text, motion, verdict;
    double time = 0.0, duration = 0.0, removed = 0.0;
    std::optional<int> tool;
    PairLine deciding;           // of a moving block
    std::vector<PairLine> pairs; // all of them

    /// The pair with this name; if there is none, fails the test and returns an empty one.
    PairLine pair(const std::string& name) const;
};

struct FindingLine {
    std::string rule, severity, message, cure;
    std::optional<int> line;
};

/// The output and exit status of `feeler check --format json --pairs`.
struct Checked {
    int status = -1;
    std::string err, verdict;
    std::vector<BlockLine> blocks;
    std::vector<FindingLine> findings;
    std::vector<std::string> assumptions;

    /// The block of a line; if there is none, fails the test and returns an empty one.
    BlockLine at_line(int line) const;

    /// The first finding of a rule; if there is none, fails the test and returns an empty one.
    FindingLine finding(const std::string& rule) const;

    /// "near-miss 7, over-travel 9": all errors with their lines, in order.
    std::string errors() const;
    std::string of_severity(const std::string& severity) const;
};

/// Runs the program under test with these arguments.
test_support::Ran feeler(std::vector<std::string> words, const std::string& before = "");

/// `setup` may be empty: the set-up is then inferred.
Checked check_files(const std::string& program, const std::string& setup,
                    const std::vector<std::string>& more = {});

/// Writes the set-up and the program to files and checks them.
Checked check(const test_support::SetupWriter& setup, const std::string& program,
              const std::vector<std::string>& more = {});

/// Expects lower <= truth <= upper, with both bounds within `within` of the truth.
void expect_encloses(const PairLine& pair, double truth, double within);

} // namespace app_test
