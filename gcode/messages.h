#pragma once

#include <optional>
#include <string_view>

namespace gcode {

/// A comment that the control acts on.
struct ActiveComment {
    std::string_view text; // behind its keyword
    bool has_parameters;   // whether they are written out
};

/// (MSG, ...), (DEBUG, ...), (PRINT, ...) and (LOG, ...); empty for any other comment.
std::optional<ActiveComment> active_comment(std::string_view text);

} // namespace gcode
