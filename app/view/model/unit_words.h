#pragma once

#include <string>

namespace app::viewer {

struct ViewModel;

/// A text with its lengths in the unit of the window: "2.000 mm" becomes "0.07874 in", "800 mm/min"
/// becomes "31.50 in/min". In a list such as "3 to 4 mm" every number counts. Areas and volumes
/// stay in mm. With two more decimals than the mm have; rounded to the nearest.
std::string words_in_unit(const ViewModel& model, const std::string& words);

/// The same for positions with the letter of a linear axis and no unit: "X12.5 Y0 Z-3".
std::string positions_in_unit(const ViewModel& model, const std::string& words);

} // namespace app::viewer
