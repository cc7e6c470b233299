#include "app/commands/number_range.h"

#include <fmt/format.h>

namespace app {

CLI::Validator number_range(double low, double high) {
    const auto check = [low, high](const std::string& text) {
        double number = 0.0;
        // Written so that NaN is refused as well.
        if (CLI::detail::lexical_cast(text, number) && number >= low && number <= high)
            return std::string();
        return fmt::format("{} is no number from {:g} to {:g}", text, low, high);
    };
    return CLI::Validator(check, fmt::format("{:g}..{:g}", low, high));
}

} // namespace app
