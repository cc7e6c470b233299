#pragma once

#include <optional>
#include <string>

namespace app {

/// The bounds of a clearance as "1.999 to 2.003 mm", as "1.999 mm" where they are a um apart at
/// most, or "1.999 mm or more" where no upper one is known. An upper one that is less than what
/// must be kept is never shown as that.
std::string bounds_text(double lower, std::optional<double> upper, double keep);

} // namespace app
