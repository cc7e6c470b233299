#pragma once

#include <optional>
#include <string>

namespace app {

/// A lower bound of a clearance as "1.999": never more than it is, and never below 0.
std::string mm_at_least(double lower);

/// An upper bound, or what must be kept, as "2.001": never less than it is.
std::string mm_at_most(double upper);

/// The bounds of a clearance as "1.999 to 2.003 mm", as "1.999 mm" where they are a um apart at
/// most, or "1.999 mm or more" where no upper one is known.
std::string bounds_text(double lower, std::optional<double> upper);

} // namespace app
