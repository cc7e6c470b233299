#pragma once

#include <string>

#include <toml++/toml.h>

#include "core/base/vec.h"

namespace gcode {
enum class LengthUnit : uint8_t;
}

namespace app {

/// The unit of the lengths in a set-up, as its text states it: mm unless it says inches. Text that
/// is not TOML has none, and counts as mm.
gcode::LengthUnit unit_of_setup(const std::string& text);
gcode::LengthUnit unit_of_setup(const toml::table& root);

/// Whether the text of a set-up states nothing, at most the unit of its lengths.
bool states_nothing(const std::string& text);

/// A text without any statement, begun in a unit; any other text as it is.
std::string begun_in(const std::string& text, gcode::LengthUnit unit);

/// An angle in degrees, or a length that is in the unit of the file already, as a person would
/// write it: rounded to 1e-6.
std::string setup_number(double value);
/// Three of them as a list: "[0, 0, 12.5]".
std::string setup_vector(const core::Vec3& v);

/// A length in mm as a number in the unit of a set-up: rounded to 1e-6 mm or 1e-8 inch, that is
/// 2.5e-7 mm. What was entered with fewer decimals comes back: 31.75 mm is "1.25" inch.
std::string setup_length(double mm, gcode::LengthUnit unit);
/// What is read of it, mm.
double rounded_length(double mm, gcode::LengthUnit unit);
/// Three of them as a list.
std::string setup_point(const core::Vec3& mm, gcode::LengthUnit unit);

/// The same for a length that is only assumed: rounded to 1e-6 of the unit, 2.5e-5 mm for inches.
std::string assumed_length(double mm, gcode::LengthUnit unit);

/// A number in TOML, exact to the last bit; whole numbers are written without a fraction.
std::string toml_number(double value);

/// A length in mm as a number that is this length when read, to 1e-11 mm. With no more decimals
/// than setup_length() if that is enough.
std::string exact_length(double mm, gcode::LengthUnit unit);

} // namespace app
