#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/support/scoped_folder.h"
#include "tests/support/setup_writer.h"
#include "tests/support/shell.h"

namespace app_test {

/// One pair of bodies over a block, as the report has it.
struct PairLine {
    std::string name; // "holder clamp-1"; empty when nothing came near
    double lower = 0.0;
    std::optional<double> upper, allowance, at;
    std::string verdict;
};

struct BlockLine {
    int block = 0, line = 0;
    std::string text, motion, verdict;
    double time = 0.0, duration = 0.0, removed = 0.0;
    std::optional<int> tool;
    PairLine deciding;           // of a block that moves
    std::vector<PairLine> pairs; // all of them

    /// Fails the test and gives an empty one when the block has no such pair.
    PairLine pair(const std::string& name) const;
};

struct FindingLine {
    std::string rule, severity, message, cure;
    std::optional<int> line;
};

/// What `feeler check --format json --pairs` said and how it ended.
struct Checked {
    int status = -1;
    std::string err, verdict;
    std::vector<BlockLine> blocks;
    std::vector<FindingLine> findings;
    std::vector<std::string> assumptions;

    /// The block of a line; fails the test and gives an empty one when there is none.
    BlockLine at_line(int line) const;

    /// The first finding of a rule; fails the test and gives an empty one when there is none.
    FindingLine finding(const std::string& rule) const;

    /// "near-miss 7, over-travel 9": every error with its line, in order.
    std::string errors() const;
    std::string of_severity(const std::string& severity) const;
};

/// The program under test with these words behind its name.
test_support::Ran feeler(std::vector<std::string> words, const std::string& before = "");

Checked check_files(const std::string& program, const std::string& setup,
                    const std::vector<std::string>& more = {});

/// Writes both files and checks them.
Checked check(const test_support::SetupWriter& setup, const std::string& program,
              const std::vector<std::string>& more = {});

/// lower <= truth <= upper, and both ends within `within` of it.
void expect_encloses(const PairLine& pair, double truth, double within);

} // namespace app_test
