#pragma once

#include <string>

#include "gcode/frame.h"
#include "gcode/program_library.h"

namespace gcode {

/// Where the program of a number begins: the line behind its O word. It is looked for in the
/// program that asks, in the main program, then in the files of the search path that are named for
/// the number; or in the files first. Empty when there is none.
///
/// Errors: as ProgramLibrary::find.
core::Result<std::optional<Place>> find_program(ProgramLibrary& library, uint32_t source,
                                                int number, bool files_first = false);

/// What to tell somebody whose program is not there: where it was looked for, and what there is.
std::string missing_program(ProgramLibrary& library, uint32_t source, int number);

} // namespace gcode
