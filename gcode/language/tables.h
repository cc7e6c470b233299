#pragma once

#include <array>
#include <map>
#include <optional>
#include <vector>

#include "core/base/ids.h"
#include "gcode/language/modal_state.h"

namespace gcode {

/// An entry of the tool offset table.
struct LengthOffset {
    double length = 0.0;   // mm along Z
    double wear = 0.0;     // mm, added to the length
    double diameter = 0.0; // mm
    double radius_wear = 0.0;
    AxisValues shift{};                     // mm and degrees along the other axes; Z is not used
    double front_deg = 0.0, back_deg = 0.0; // of a turning tool
    int orientation = 0;                    // of a turning tool, 0 to 9

    bool operator==(const LengthOffset&) const = default;
};

/// The tables of the control that programs can read and write.
struct Tables {
    std::vector<WorkOffset> work{plain_offset_count}; // grows when a higher number is written
    AxisValues external{}; // Fanuc's external offset, added to all others
    std::map<core::OffsetNumber, LengthOffset> lengths;
    std::map<core::ToolNumber, double> tool_lengths, tool_diameters; // for numbers without an entry

    bool operator==(const Tables&) const = default;
};

/// The work offset with an index; zero if it was never written.
WorkOffset work_offset(const Tables& tables, size_t index);
WorkOffset& writable_work_offset(Tables& tables, size_t index);

/// The length for an H number: from the table, else of the tool with that number; empty if neither
/// exists.
std::optional<double> length_under(const Tables& tables, int number);

/// Whether an offset has a number under which nobody states a length.
bool lacks_length(const Tables& tables, std::optional<core::OffsetNumber> number);

/// The diameter for a D number: from the table, else of the tool with that number; empty if neither
/// exists.
std::optional<double> diameter_under(const Tables& tables, int number);

} // namespace gcode
