#include "app/setup/setup_length.h"

#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "app/setup/table_reader.h"
#include "app/setup/toml_file.h"
#include "core/base/math.h"
#include "gcode/language/modal_state.h"

namespace app {
namespace {

using gcode::LengthUnit;

constexpr double fine_steps = 1e6, finest_steps = 1e8; // per unit

/// The nearest number with so many steps per unit; very large ones stay.
double rounded_to(double value, double steps) {
    constexpr double largest = 1e15; // steps, which a double counts exactly
    const double count = value * steps;
    return std::abs(count) < largest ? core::round(count) / steps + 0.0 : value;
}

/// A length as a number in a unit, rounded as far as a set-up needs it.
double rounded_in(double mm, LengthUnit unit) {
    return rounded_to(gcode::from_mm(mm, unit),
                      unit == LengthUnit::inch ? finest_steps : fine_steps);
}

/// A number in a unit that gives these mm exactly, if there is one; else the nearest.
double exact_in(double mm, LengthUnit unit) {
    const double near = gcode::from_mm(mm, unit);
    constexpr double far = std::numeric_limits<double>::infinity();
    for (const double value : {near, std::nextafter(near, -far), std::nextafter(near, far)})
        if (gcode::to_mm(value, unit) == mm) return value;
    return near;
}

} // namespace

LengthUnit unit_of_setup(const toml::table& root) {
    const bool is_inch = root[length_unit_key].value<std::string>() == "inch";
    return is_inch ? LengthUnit::inch : LengthUnit::mm;
}

LengthUnit unit_of_setup(const std::string& text) {
    const auto root = parsed_toml(text);
    return root ? unit_of_setup(*root) : LengthUnit::mm;
}

bool states_nothing(const std::string& text) {
    const auto root = parsed_toml(text);
    return root && (root->empty() || (root->size() == 1 && root->contains(length_unit_key)));
}

std::string begun_in(const std::string& text, LengthUnit unit) {
    const auto root = parsed_toml(text);
    if (unit != LengthUnit::inch || !root || !root->empty()) return text;
    return fmt::format("{}{}{} = \"inch\"\n", text, text.empty() || text.back() == '\n' ? "" : "\n",
                       length_unit_key);
}

std::string toml_number(double value) { return fmt::format("{}", value); }

std::string setup_number(double value) { return toml_number(rounded_to(value, fine_steps)); }

std::string setup_vector(const core::Vec3& v) {
    return fmt::format("[{}, {}, {}]", setup_number(v.x), setup_number(v.y), setup_number(v.z));
}

std::string setup_length(double mm, LengthUnit unit) { return toml_number(rounded_in(mm, unit)); }

double rounded_length(double mm, LengthUnit unit) {
    return gcode::to_mm(rounded_in(mm, unit), unit);
}

std::string setup_point(const core::Vec3& mm, LengthUnit unit) {
    return fmt::format("[{}, {}, {}]", setup_length(mm.x, unit), setup_length(mm.y, unit),
                       setup_length(mm.z, unit));
}

std::string assumed_length(double mm, LengthUnit unit) {
    return toml_number(rounded_to(gcode::from_mm(mm, unit), fine_steps));
}

std::string exact_length(double mm, LengthUnit unit) {
    constexpr double rounding = 1e-11; // mm, of conversions between units
    const double round = rounded_in(mm, unit);
    if (std::abs(gcode::to_mm(round, unit) - mm) < rounding) return toml_number(round);
    return toml_number(exact_in(mm, unit));
}

} // namespace app
