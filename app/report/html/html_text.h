#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace app {

/// A text of any bytes as it may stand in HTML, between tags and in quoted attributes: UTF-8, no
/// control characters, nothing that a browser would read as more than text.
std::string html_text(std::string_view text);

/// A string of JSON of any bytes, quotes included, that nothing ends early in a `script` element.
std::string script_string(std::string_view text);

/// Bytes by 64 characters, as data URIs have them.
std::string base64(std::string_view bytes);

/// The bounds of a clearance as "1.999 to 2.003 mm", as "1.999 mm" where they are a um apart at
/// most, or "1.999 mm or more" where no upper one is known. An upper one that is less than what
/// must be kept is never shown as that.
std::string bounds_text(double lower, std::optional<double> upper, double keep);

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
