#pragma once

#include <map>
#include <string>
#include <vector>

namespace test_support {

/// Deliberate differences from the reference.
struct ReferenceDifferences {
    std::vector<std::string> refusals; // parts of its error messages that are warnings here
    std::map<std::string, std::string> programs; // file name to reason: not compared
};

/// The contents of tests/gcode/reference_differences.md.
const ReferenceDifferences& reference_differences();

} // namespace test_support
