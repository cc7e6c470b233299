#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/setup/control/control_offsets.h"

namespace app {

/// Collects what one file of a control states.
struct OffsetStore {
    ControlOffsets& offsets;
    const ControlReading& reading;
    std::string path;

    /// A length as the file writes it, converted to mm.
    ControlValue length(double written, gcode::LengthUnit unit, uint32_t line) const;
    ControlValue angle(double degrees, uint32_t line) const;

    /// The value of an axis of an origin: a length or an angle.
    ControlValue coordinate(size_t axis, double written, gcode::LengthUnit unit,
                            uint32_t line) const;

    /// Stores a value. Notes that it replaces another one. `name`: of the entry, such as "G54 X".
    void put(std::optional<ControlValue>& place, ControlValue value, const std::string& name) const;

    void note(const std::string& text) const;
};

/// A line in capitals without its comments.
std::string code_of(std::string_view line);

/// Whether code contains the word G10.
bool has_offset_code(std::string_view code);

/// Reads the lines of a file that contains blocks with G10.
///
/// Source: Fanuc operator's manual B-63944EN, III-8, "Inputting/outputting offset data" and
///         "Workpiece origin offset": G10 L10 to L13 P R, G10 L2 and L20 P with axes; tool offset
///         memory A is written with L11. Haas mill operator's manual 96-8000, G10.
/// Errors: syntax, with line and column.
core::Result<void> read_offset_blocks(const std::vector<std::string>& lines,
                                      const OffsetStore& store);

/// Reads a file of Haas's Next Generation Control with tool offsets.
///
/// Source: github.com/bobvawter/hts-400-report, which shows such a file and the template of it that
///         Haas's tool presetter has. Whether it holds radii is setting 40 of the control.
/// Errors: syntax, with its line, for other XML and for text that is not a number.
core::Result<void> read_haas_offsets(const std::string& text, const OffsetStore& store);

} // namespace app
