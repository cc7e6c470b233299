#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace app {

/// A text of any bytes as it may stand in HTML, between tags and in quoted attributes: UTF-8, no
/// control characters, nothing that a browser would read as more than text.
std::string html_text(std::string_view text);

/// A string of JSON of any bytes, quotes included, that nothing ends early in a `script` element.
std::string script_string(std::string_view text);

/// Bytes by 64 characters, as data URIs have them.
std::string base64(std::string_view bytes);

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

} // namespace app
