#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace test_support {

/// Number of occurrences of `part` in a text.
inline size_t count_of(const std::string& text, const std::string& part) {
    size_t count = 0;
    for (size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++count;
    return count;
}

/// Expands a column of an HTML report from its runs of equal values.
inline std::vector<int64_t> unpacked(const nlohmann::json& runs) {
    std::vector<int64_t> values;
    for (size_t i = 0; i < runs.size(); i += 2)
        values.insert(values.end(), runs[i + 1].get<size_t>(), runs[i].get<int64_t>());
    return values;
}

/// The running sums of differences.
inline std::vector<int64_t> summed(std::vector<int64_t> steps) {
    for (size_t i = 1; i < steps.size(); ++i) steps[i] += steps[i - 1];
    return steps;
}

} // namespace test_support
