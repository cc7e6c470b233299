#pragma once

#include <string>

#include "core/base/result.h"
#include "gcode/exec/frame.h"
#include "gcode/exec/interpreter.h"
#include "gcode/exec/statement.h"

namespace gcode {

/// The first line of the program with a number: the line after its O word. Searches the calling
/// program, the main program, then files of the search path named for the number; or the files
/// first. Empty when there is none.
///
/// Errors: as ProgramLibrary::find.
core::Result<std::optional<ProgramLine>> find_program(ProgramLibrary& library, uint32_t source,
                                                      int number, bool files_first = false);

/// The message for a missing program: where it was searched, and which programs exist.
std::string missing_program(ProgramLibrary& library, uint32_t source, int number);

/// The local variable that a letter of a macro call sets, 1 to 26: A is #1, Z #26. 0 if it is not a
/// letter.
size_t argument_number(char letter);

/// The local variables of a macro call. I, J and K may be repeated up to ten times: the second I is
/// #7. Later words override earlier ones.
///
/// Errors: syntax for a word that cannot be an argument; invalid_value for an eleventh I, J or K.
core::Result<LocalParameters> arguments_of(const std::vector<const Word*>& words);

/// The modal macro called by the blocks that run now, counted from 1; 0 for none. Inside a modal
/// macro it is the one programmed before it.
size_t modal_macro_in_effect(const InterpreterState& state);

/// Whether blocks are only arguments at present (G66.1).
bool blocks_are_arguments(const InterpreterState& state);

} // namespace gcode
