#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "gcode/language/dialect.h"

namespace test_support {

/// Runs a program as a control would, within small limits, and asserts what is true of every
/// program, however broken: an error leaves the state as it was before the block and names a line
/// of the program, every command has its place, no coordinate is infinite or not a number, and a
/// copy of a state goes on as the state itself.
///
/// Errors: ends the process with a message where one of these does not hold.
void run_any_program(std::string_view text, gcode::DialectId dialect, bool block_delete);

/// The same for bytes from nowhere: the first says which dialect, the rest is the text.
void run_any_bytes(std::span<const uint8_t> bytes);

/// The same for a program whose every part is chosen by a byte.
void run_chosen_program(std::span<const uint8_t> choices);

} // namespace test_support
