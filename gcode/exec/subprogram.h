#pragma once

#include <string>

#include "core/base/result.h"
#include "gcode/exec/frame.h"
#include "gcode/exec/interpreter.h"
#include "gcode/exec/statement.h"

namespace gcode {

/// Where the program of a number begins: the line after its O word. It is searched in the
/// program that asks, in the main program, then in the files of the search path that are named for
/// the number; or in the files first. Empty when there is none.
///
/// Errors: as ProgramLibrary::find.
core::Result<std::optional<Place>> find_program(ProgramLibrary& library, uint32_t source,
                                                int number, bool files_first = false);

/// The message for a missing program: where it was searched, and what is there.
std::string missing_program(ProgramLibrary& library, uint32_t source, int number);

/// The number of the local variable that a letter of a macro call sets, 1 to 26: A is #1, Z #26.
/// 0 for what is no letter.
size_t argument_number(char letter);

/// The local variables of a macro call. I, J and K may come again, up to ten times: the second I is
/// #7. Later words win.
///
/// Errors: syntax for a word that cannot be an argument; invalid_value for an eleventh I, J or K.
core::Result<LocalParameters> arguments_of(const std::vector<const Word*>& words);

/// Which of the modal macros is called by the blocks that run now, counted from 1; 0 for none. In
/// one of them it is the one that was said before it.
size_t modal_macro_in_effect(const InterpreterState& state);

/// Whether blocks are nothing but arguments now (G66.1).
bool blocks_are_arguments(const InterpreterState& state);

} // namespace gcode
