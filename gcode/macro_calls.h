#pragma once

#include "core/base/result.h"
#include "gcode/interpreter.h"
#include "gcode/statement.h"

namespace gcode {

/// The number of the local variable that a letter of a macro call sets, 1 to 26: A is #1, Z #26.
/// 0 for what is no letter.
size_t argument_number(char letter);

/// The local variables of a macro call. I, J and K may come again, up to ten times: the second I is
/// #7. What stands later wins.
///
/// Errors: syntax for a word that cannot be an argument; invalid_value for an eleventh I, J or K.
core::Result<LocalParameters> arguments_of(const std::vector<const Word*>& words);

/// Which of the modal macros is called by the blocks that run now, counted from 1; 0 for none. In
/// one of them it is the one that was said before it.
size_t modal_macro_in_effect(const InterpreterState& state);

/// Whether blocks are nothing but arguments now (G66.1).
bool blocks_are_arguments(const InterpreterState& state);

} // namespace gcode
