#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

namespace app {

/// Numbers of which many follow that are the same, as JSON: "[value,count,value,count,...]".
class NumberRuns {
public:
    void add(int64_t value);
    std::string json() const;

private:
    struct Run {
        int64_t value = 0;
        size_t count = 0;
    };
    std::vector<Run> runs_;
};

/// The same of the steps from each number to the next, the first one from 0.
class StepRuns {
public:
    void add(int64_t value) {
        steps_.add(value - last_);
        last_ = value;
    }
    std::string json() const { return steps_.json(); }

private:
    NumberRuns steps_;
    int64_t last_ = 0;
};

/// "[1,2,3]".
std::string number_array(std::span<const int64_t> numbers);

/// A JSON array of strings, as script_string writes them.
std::string string_array(std::span<const std::string> texts);

/// Each different text once, and where it is in the table.
class TextTable {
public:
    int64_t index_of(const std::string& text);
    std::string json() const { return string_array(texts_); }

private:
    std::unordered_map<std::string, int64_t> known_;
    std::vector<std::string> texts_;
};

/// What is certainly kept, as whole um, where that many mm are known to be.
int64_t um_below(double mm);

/// The same of a clearance, which is never below 0: what overlaps has none.
int64_t clearance_um(double lower);

/// Whole um that are certainly no less than that many mm.
int64_t um_above(double mm);

/// How many steps a number is, rounded.
int64_t steps_of(double value, double step);

} // namespace app
