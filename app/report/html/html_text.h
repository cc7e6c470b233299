#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace app {

/// A text of any bytes, escaped for HTML between tags and in quoted attributes: valid UTF-8, no
/// control characters, no markup.
std::string html_text(std::string_view text);

/// A text of any bytes as a quoted JSON string that is safe inside a `script` element.
std::string script_string(std::string_view text);

/// Base64, as in data URIs.
std::string base64(std::string_view bytes);

/// Run-length encoded numbers, as JSON: "[value,count,value,count,...]".
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

/// Run-length encoded differences between consecutive numbers; the first is relative to 0.
class DeltaRuns {
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

/// Stores each different text once and gives its index.
class TextTable {
public:
    int64_t index_of(const std::string& text);
    std::string json() const { return string_array(texts_); }

private:
    std::unordered_map<std::string, int64_t> known_;
    std::vector<std::string> texts_;
};

// The following numbers end at 2^53, beyond which a page would change them.

/// A length in whole um, rounded down as by core::units_below.
int64_t um_below(double mm);

/// As um_below for a clearance, but at least 0, the clearance of overlapping bodies.
int64_t clearance_um(double lower);

/// A length in whole um, rounded up as by core::units_above.
int64_t um_above(double mm);

/// The number of steps in a value, rounded to the nearest.
int64_t steps_of(double value, double step);

} // namespace app
