#include "app/report/html_columns.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "app/report/html_text.h"
#include "core/sim/bound_text.h"

namespace app {

void NumberRuns::add(int64_t value) {
    if (runs_.empty() || runs_.back().value != value) runs_.push_back({value, 0});
    ++runs_.back().count;
}

std::string NumberRuns::json() const {
    std::string text = "[";
    for (const Run& run : runs_)
        fmt::format_to(std::back_inserter(text), "{}{},{}", text.size() > 1 ? "," : "", run.value,
                       run.count);
    return text += ']';
}

std::string number_array(std::span<const int64_t> numbers) {
    std::string text = "[";
    for (const int64_t number : numbers)
        fmt::format_to(std::back_inserter(text), "{}{}", text.size() > 1 ? "," : "", number);
    return text += ']';
}

std::string string_array(std::span<const std::string> texts) {
    std::string json = "[";
    for (const std::string& text : texts)
        (json += json.size() > 1 ? "," : "") += script_string(text);
    return json += ']';
}

int64_t TextTable::index_of(const std::string& text) {
    const auto [at, is_new] = known_.try_emplace(text, static_cast<int64_t>(texts_.size()));
    if (is_new) texts_.push_back(text);
    return at->second;
}

int64_t um_below(double mm) { return static_cast<int64_t>(core::units_below(mm, 3)); }

int64_t clearance_um(double lower) { return std::max<int64_t>(um_below(lower), 0); }

int64_t um_above(double mm) { return static_cast<int64_t>(core::units_above(mm, 3)); }

int64_t steps_of(double value, double step) { return std::llround(value / step); }

} // namespace app
