#pragma once

#include <map>
#include <string>
#include <vector>

namespace test_support {

/// Where we differ from the reference on purpose.
struct ReferenceDifferences {
    std::vector<std::string> refusals;           // parts of its messages that are warnings with us
    std::map<std::string, std::string> programs; // file name to reason: not compared
};

/// What tests/gcode/reference_differences.md lists.
const ReferenceDifferences& reference_differences();

} // namespace test_support
