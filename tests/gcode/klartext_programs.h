#pragma once

#include <string>
#include <string_view>

#include "gcode/language/dialect.h"
#include "tests/gcode/programs.h"

namespace gcode {

/// The lines as a program in mm whose first line is BEGIN PGM; the given lines start on line 2.
inline std::string klartext_program(std::string_view lines) {
    return "BEGIN PGM TEST MM\n" + std::string(lines) + "END PGM TEST MM\n";
}

inline std::string klartext(std::string_view lines) {
    return trace(klartext_program(lines), DialectId::heidenhain);
}

inline std::string klartext_error(std::string_view lines) {
    return error_of(klartext_program(lines), DialectId::heidenhain);
}

} // namespace gcode
