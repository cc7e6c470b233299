#pragma once

#include <string>
#include <string_view>

#include "gcode/language/dialect.h"
#include "tests/gcode/programs.h"

namespace gcode {

inline std::string siemens(std::string_view text) { return trace(text, DialectId::siemens); }

inline std::string siemens_error(std::string_view text) {
    return error_of(text, DialectId::siemens);
}

} // namespace gcode
