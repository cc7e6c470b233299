#pragma once

#include <optional>
#include <string>

#include "app/session/inspected_value.h"

namespace app {

/// At most four decimals, without zeros behind the last one that counts; never "-0".
std::string number_text(double value);

/// "12.5 mm"; "unknown" where nobody knows.
InspectedValue quantity(std::optional<double> value, std::string_view unit = {});

/// Degrees along rotary axes, else mm.
InspectedValue axis_quantity(size_t axis, std::optional<double> value);

/// In small letters.
std::string lowered(std::string_view text);

} // namespace app
