#include "app/batch/kept_json.h"

#include <cmath>

namespace app {
namespace {

constexpr size_t most_nested = 16; // a share's results need 7

} // namespace

bool is_nested_too_deep(std::string_view text) {
    size_t depth = 0;
    bool in_string = false;
    for (size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string && c == '\\')
            ++i;
        else if (c == '"')
            in_string = !in_string;
        else if (!in_string && (c == '[' || c == '{') && ++depth > most_nested)
            return true;
        else if (!in_string && (c == ']' || c == '}') && depth > 0)
            --depth;
    }
    return false;
}

KeptJson kept_json(const std::string& text) {
    if (is_nested_too_deep(text)) throw std::invalid_argument("its lists are nested too deep");
    return KeptJson::parse(text);
}

double number_from(const KeptJson& json, double least) {
    // What is no number has a value too: true is 1.
    const double number = json.is_number() ? json.get<double>() : std::nan("");
    if (!std::isfinite(number) || number < least)
        throw std::invalid_argument("a number is none, or out of its range");
    return number;
}

const KeptJson& list_from(const KeptJson& json, std::optional<size_t> count) {
    if (!json.is_array() || (count && json.size() != *count))
        throw std::invalid_argument("a list is none, or of another length");
    return json;
}

std::array<std::string, 2> pair_from(const KeptJson& json) {
    list_from(json, 2);
    return {json[0].get<std::string>(), json[1].get<std::string>()};
}

} // namespace app
