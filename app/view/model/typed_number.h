#pragma once

#include <string>

#include "core/base/result.h"

namespace app::viewer {

/// The number that a user means: "12.5", "12,5", "-3/8", "2 1/2", "210/2 - 12", "3*(4+5)".
///
/// Errors: invalid_value with the reason, for anything else: a number that is only nearly
///         understood may be ten times too large. "1,234" is refused, because it can be meant in
///         two ways. Numbers above 1e6 are refused, too.
core::Result<double> typed_number(const std::string& text);

/// A length, mm. Numbers without a unit are in inches if `is_inch`, else mm; "25.4mm", "1 in" and
/// "1\"" have their own.
///
/// Errors: as typed_number; also if numbers with and without a unit are added, which is either
///         careless or means something else.
core::Result<double> typed_length(const std::string& text, bool is_inch);

/// A length as a field shows it and a user would write it: at most `decimals`, without zeros at the
/// end.
std::string field_text(double value, int decimals);

} // namespace app::viewer
