#pragma once

#include <optional>
#include <vector>

#include "core/motion/kinematics.h"

namespace app::viewer {

struct ViewModel;

/// A row of the axis display. Lengths are mm, angles degrees.
struct AxisRow {
    size_t axis = 0;               // as in core::axis_letters
    double machine = 0.0;          // machine coordinate
    std::optional<double> program; // in the coordinates of the program, as the control shows it
    std::optional<double> below, above; // travel that is left to the limits; negative: beyond
    bool moves = false;                 // in the block, or by hand
};

/// The axes of the machine at the cursor, while a block is played as well; empty if one is unknown.
std::vector<AxisRow> axis_rows(const ViewModel& model);

/// The positions of the axes in the picture: moved by hand, or at the cursor.
std::optional<core::AxisValues> shown_axes(const ViewModel& model);

/// Moves one axis by hand to a machine coordinate, or as far as its limits allow. This changes the
/// picture and the display only, until the cursor moves. A rotary axis without limits may go
/// anywhere.
void jog(ViewModel& model, size_t axis, double machine);
/// Puts all axes back to where the program has them.
void end_jog(ViewModel& model);
/// Whether axes have been moved by hand at the cursor. What is shown then was not checked.
bool is_jogged(const ViewModel& model);

} // namespace app::viewer
